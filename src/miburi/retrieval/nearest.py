"""The first k segments, exactly, without looking at every frame of every segment.

DSPM: a maximum over frames is at least its value at any one frame, and Err (eq. 1) is convex, so it is also at
least its value at the frames' mean. So each segment's DSPM is bounded from below twice: by the segments' means and
the query's subspace, in float32 and for many segments side by side; and, where that leaves a doubt, by a few telling
points of each side and the other's subspace. MSM: √(Σ cos²) is at most what it is along the principal axes of all
subspaces, in float32, and the product of the norms of what is left beside them.

The segments of the lowest bounds are visited first, then those whose bounds are not above the k-th distance found. What
is visited is computed as for a whole ranking, so the first k are the same bits: bounds leave room for its rounding.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import SUMS, njit
from miburi.motion import Floats
from miburi.retrieval.jvh import overlap_with
from miburi.retrieval.ranking import insert, longest
from miburi.retrieval.subspace import reduced, residuals, shared_with

POINTS = 3
# What rounding in float32 may add to a square, as a share of the largest squared norm (sums of 42 products); rounding
# of the distances themselves, in float64, is far less.
_ROUNDING = 5e-5
# Of this many times k segments, those of the lowest first bounds, the second bounds are looked at first.
_OPENING = 3
_LANES = 128  # segments that are looked at side by side
_MANY = 4  # part of the segments; see `msm_first`
_AXES = 24  # along which subspaces are compared first: on real bodies what is left decides about few

Singles = NDArray[np.float32]


class Segments(NamedTuple):
    """What is compared (see `Index`; blocks: `subspace.samples_to_subspace`), and what bounds need.

    Bounds need points, subspaces and histograms in float32; where all segments are looked at, these are the last axis.
    `means` are of the frames that are compared: the mean of all need not lie in their hull.
    """

    mean: Floats
    basis: Floats
    root: Floats
    """(S, D): square roots of the histograms of movement"""
    blocks: Singles
    offsets: NDArray[np.int64]
    centre: Floats
    """(D,): subtracted from all that follows, so that float32 spends its digits on differences"""
    size: float
    """largest squared norm of what follows"""
    points: Singles
    """(S · POINTS, D): `telling` of each segment's frames"""
    origins: Singles
    """(S, D): means of the subspaces"""
    spans: Singles
    """(S, dims, D): their directions"""
    means: Singles
    """(D, S): means of the frames"""
    squares: Singles
    """(S,): squared norms of these"""
    axes: Floats
    """(D, A): principal axes of all subspaces, `_AXES` of them or D"""
    bases: Singles
    """(dims, A, S): along these axes"""
    spilled: Floats
    """(S,): norm of what is left of a subspace beside the axes"""
    roots: Singles
    """(D, S)"""


class Query(NamedTuple):
    """What is compared of the query.

    Frames (D, n), points (POINTS, D), mean (1, D), basis (1, dims, D), and the root of its histogram (D,), all zeros
    where that is not asked for.
    """

    frames: Floats
    points: Floats
    mean: Floats
    basis: Floats
    root: Floats


@njit
def telling(frames):  # type: ignore[no-untyped-def]
    """Points (POINTS, D) in the hull of frames (n, D) that are likely to be far from a foreign subspace.

    The mean, the frame that is farthest from it, and the frame that is farthest from that one.
    """
    n, width = frames.shape
    points = np.zeros((POINTS, width))
    for i in range(n):
        for d in range(width):
            points[0, d] += frames[i, d]
    for d in range(width):
        points[0, d] /= n
    for p in range(1, POINTS):
        farthest, most = 0, -1.0
        for i in range(n):
            away = 0.0
            for d in range(width):
                gap = frames[i, d] - points[p - 1, d]
                away += gap * gap
            if away > most:
                farthest, most = i, away
        for d in range(width):
            points[p, d] = frames[farthest, d]
    return points


def segments(
    mean: Floats, basis: Floats, root: Floats, blocks: Singles, frames: Singles, offsets: NDArray[np.int64]
) -> Segments:
    """Prepare the segments of an index: arguments as in `Segments` and `Index`."""
    points = np.concatenate([telling(frames[a:b]) for a, b in pairwise(offsets)])
    centre = points[::POINTS].mean(axis=0)
    points, origins = points - centre, mean - centre
    near = points[::POINTS]
    size = max(float(np.square(x).sum(axis=1).max()) for x in (points, origins))
    rows = basis.reshape(-1, basis.shape[-1])
    axes = np.ascontiguousarray(np.linalg.eigh(rows.T @ rows)[1][:, : -_AXES - 1 : -1])
    along = basis @ axes

    def single(x: Floats) -> Singles:
        with np.errstate(over="ignore"):  # `_bounds` sees to it
            return np.ascontiguousarray(x, dtype=np.float32)

    return Segments(
        mean,
        basis,
        root,
        blocks,
        offsets,
        centre,
        size,
        single(points),
        single(origins),
        single(basis),
        single(near.T),
        single(np.square(near).sum(axis=1)),
        axes,
        single(np.moveaxis(along, 0, -1)),
        np.sqrt(np.maximum(np.square(basis).sum(axis=(1, 2)) - np.square(along).sum(axis=(1, 2)), 0.0)),
        single(root.T),
    )


@njit(fastmath=SUMS)
def _products(rows, columns, first, n, out):  # type: ignore[no-untyped-def]
    """out[m, j] = Σ_d rows[m, d] · columns[d, first + j], j < n."""
    width = len(columns)
    for m in range(len(rows)):
        for j in range(n):
            out[m, j] = 0.0
    for d in range(0, width - 2, 3):  # three at a time: sums are read and written a third as often
        x, y, z = columns[d], columns[d + 1], columns[d + 2]
        one, two, three = x[first : first + n], y[first : first + n], z[first : first + n]
        for m in range(len(rows)):
            line, p, q, r = out[m], rows[m, d], rows[m, d + 1], rows[m, d + 2]
            for j in range(n):
                line[j] += p * one[j] + q * two[j] + r * three[j]
    for d in range(width - width % 3, width):
        one = columns[d, first : first + n]
        for m in range(len(rows)):
            line, p = out[m], rows[m, d]
            for j in range(n):
                line[j] += p * one[j]


@njit
def _singles(segments, query):  # type: ignore[no-untyped-def]
    """The query's points (POINTS, D), origin (1, D) and span (1, dims, D) in float32, and what rounding may add."""
    others, span = (
        np.empty(query.points.shape, dtype=np.float32),
        np.empty(query.basis.shape, dtype=np.float32),
    )
    origin, size = np.empty(query.mean.shape, dtype=np.float32), segments.size
    for p in range(POINTS + 1):
        square = 0.0
        for d in range(len(segments.centre)):
            x = (query.points[p, d] if p < POINTS else query.mean[0, d]) - segments.centre[d]
            square += x * x
            if p < POINTS:
                others[p, d] = x
            else:
                origin[0, d] = x
        size = max(size, square)
    for m in range(span.shape[1]):
        for d in range(span.shape[2]):
            span[0, m, d] = query.basis[0, m, d]
    return others, origin, span, np.float32(_ROUNDING * size)


@njit(fastmath=SUMS)
def dspm_below(segments, origin, span, slack):  # type: ignore[no-untyped-def]
    """Lower bounds of DSPM, (S,): Err of the segments' means from the query's subspace (`_singles`)."""
    width, s = segments.means.shape
    dims = span.shape[1]
    # the query's directions, and its mean
    rows, along = np.empty((dims + 1, width), dtype=np.float32), np.zeros(dims, dtype=np.float32)
    less = -slack
    for d in range(width):
        rows[dims, d] = origin[0, d]
        less += origin[0, d] * origin[0, d]
        for m in range(dims):
            rows[m, d] = span[0, m, d]
            along[m] += span[0, m, d] * origin[0, d]
    least, dots = np.empty(s), np.empty((dims + 1, _LANES), dtype=np.float32)
    for first in range(0, s, _LANES):
        n = min(_LANES, s - first)
        _products(rows, segments.means, first, n, dots)
        for j in range(n):
            dots[dims, j] = segments.squares[first + j] - np.float32(2.0) * dots[dims, j] + less
        for m in range(dims):
            for j in range(n):
                dots[dims, j] -= (dots[m, j] - along[m]) * (dots[m, j] - along[m])
        for j in range(n):
            least[first + j] = np.sqrt(max(dots[dims, j], np.float32(0.0)))
    return least


@njit(fastmath=SUMS)
def msm_below(segments, query):  # type: ignore[no-untyped-def]
    """Lower bounds of 1 − Σ cos² / M, (S,).

    √(Σ cos²), the norm of H Qᵀ, is at most its norm along the axes plus the product of the norms of what is left.
    """
    s, axes, basis = len(segments.squares), segments.axes, query.basis
    rows, rest = np.zeros((basis.shape[1], axes.shape[1]), dtype=np.float32), 0.0
    rank = _rank(basis)
    for m in range(len(rows)):
        for a in range(axes.shape[1]):
            along = 0.0
            for d in range(len(axes)):
                along += basis[0, m, d] * axes[d, a]
            rows[m, a] = along
            rest -= along * along
    rest = np.sqrt(max(rest + rank, 0.0))
    least = np.empty(s)
    added, dots = np.empty(_LANES, dtype=np.float32), np.empty((len(rows), _LANES), dtype=np.float32)
    for first in range(0, s, _LANES):
        n = min(_LANES, s - first)
        for j in range(n):
            added[j] = 0.0
        for a in range(len(segments.bases)):
            _products(rows, segments.bases[a], first, n, dots)
            for m in range(len(rows)):
                for j in range(n):
                    added[j] += dots[m, j] * dots[m, j]
        for j in range(n):
            shared = np.sqrt(added[j]) + rest * segments.spilled[first + j] + _ROUNDING
            least[first + j] = max(1.0 - shared * shared / rank, 0.0)
    return least


@njit(fastmath=SUMS)
def factor_below(segments, query):  # type: ignore[no-untyped-def]
    """Lower bounds of √(1 − B), (S,); ones where the query has no histogram."""
    s = len(segments.squares)
    factor = np.ones(s)
    if query.root.sum() > 0.0:
        rows, dots = np.empty((1, len(query.root)), dtype=np.float32), np.empty((1, _LANES), dtype=np.float32)
        for d in range(len(query.root)):
            rows[0, d] = query.root[d]
        for first in range(0, s, _LANES):
            n = min(_LANES, s - first)
            _products(rows, segments.roots, first, n, dots)
            for j in range(n):
                factor[first + j] = np.sqrt(max(1.0 - dots[0, j] - _ROUNDING, 0.0))
    return factor


@njit
def _rank(basis):  # type: ignore[no-untyped-def]
    """How many rows of the query's basis (1, dims, D) are not zero: they come first."""
    rank = 0
    for m in range(basis.shape[1]):
        largest = 0.0
        for d in range(basis.shape[2]):
            largest = max(largest, abs(basis[0, m, d]))
        if largest > 0.0:
            rank += 1
    return rank


@njit
def _lowest(values, k):  # type: ignore[no-untyped-def]
    """Where the k smallest of values are, smallest first."""
    least, where = np.full(k, np.inf), np.zeros(k, dtype=np.int64)
    for i in range(len(values)):
        if values[i] < least[-1]:
            place = insert(values[i], least)
            for j in range(k - 1, place, -1):
                where[j] = where[j - 1]
            where[place] = i
    return where


@njit(fastmath=SUMS, error_model="numpy")
def _err(points, p, origins, spans, i, gap):  # type: ignore[no-untyped-def]
    """Err² (eq. 1) of points[p] from subspace i; gap (D,) is scratch."""
    left = np.float32(0.0)
    for d in range(len(gap)):
        gap[d] = points[p, d] - origins[i, d]
        left += gap[d] * gap[d]
    for m in range(spans.shape[1]):
        along = np.float32(0.0)
        for d in range(len(gap)):
            along += spans[i, m, d] * gap[d]
        left -= along * along
    return left


@njit
def _closer(i, limit, points, origins, spans, others, origin, span, gap):  # type: ignore[no-untyped-def]
    """What points say of DSPM's square at least, but for rounding, or something beyond the limit.

    points (S · POINTS, D), origins (S, D), spans (S, dims, D): of the segments, of which i is looked at (unsigned, so
    that it cannot count from the end); others (POINTS, D), origin (1, D), span (1, dims, D): of the query. What the
    segment's mean says is known.
    """
    square, none = np.float32(0.0), np.uint64(0)
    # the query's farthest points say most
    for p in range(POINTS):
        if square <= limit:
            square = max(square, _err(others, np.uint64(POINTS - 1 - p), origins, spans, i, gap))
    for p in range(1, POINTS):
        if square <= limit:
            square = max(square, _err(points, POINTS * i + np.uint64(p), origin, span, none, gap))
    return square


@njit
def _factor(i, root, query):  # type: ignore[no-untyped-def]
    """√(1 − B) of segment i; 1 where the query has no histogram."""
    return np.sqrt(1.0 - overlap_with(root, i, query)) if query.sum() > 0.0 else 1.0


@njit
def _bounds(least, factor):  # type: ignore[no-untyped-def]
    """Multiply the lower bounds by those of the factor; a number too large for float32 says nothing."""
    for i in range(len(least)):
        least[i] = least[i] * factor[i] if least[i] < np.inf else 0.0


@njit
def dspm_first(segments, query, k):  # type: ignore[no-untyped-def]
    """DSPM (times √(1 − B), if the query has a histogram) of the first k segments and maybe more, and their places."""
    s = len(segments.squares)
    width, n = query.frames.shape
    blocks, offsets = segments.blocks, segments.offsets
    most = max(n, longest(offsets))
    total, scratch = np.empty(most), np.empty((query.basis.shape[1] + 3, most))
    others, origin, span, slack = _singles(segments, query)
    points, origins, spans = segments.points, segments.origins, segments.spans
    gap = np.empty(width, dtype=np.float32)
    least, factor = dspm_below(segments, origin, span, slack), factor_below(segments, query)
    _bounds(least, factor)
    found, distance, count = np.empty(s, dtype=np.int64), np.empty(s), 0
    best = np.full(k, np.inf)
    first = _lowest(least, min(_OPENING * k, s))
    closer, order = np.empty(len(first)), np.arange(0)
    # those of the lowest first bounds in the order of their second bounds, then all that are left
    for j in range(2 * len(first) + s):
        opening = j < len(first)
        if j == len(first):
            order = _lowest(closer, len(first))
        if opening or j >= 2 * len(first):
            i = first[j] if opening else j - 2 * len(first)
            below = least[i]
            if below <= best[-1] and factor[i] > 0.0:
                limit = (best[-1] / factor[i]) ** 2 + slack
                square = _closer(np.uint64(i), limit, points, origins, spans, others, origin, span, gap)
                if 0.0 < square - slack < np.inf:  # else it is too large for float32
                    below = max(below, np.sqrt(square - slack) * factor[i])
            if opening:
                closer[j], least[i] = below, np.inf
                continue
        else:
            i, below = first[order[j - len(first)]], closer[order[j - len(first)]]
        if below > best[-1] or below == np.inf:
            continue
        times = _factor(i, segments.root, query.root)
        residuals(query.frames, segments.mean[i], segments.basis[i], total, scratch)
        there = reduced(total, n, False)
        if there * times > best[-1]:
            continue
        size = offsets[i + 1] - offsets[i]
        block = blocks[width * offsets[i] : width * offsets[i + 1]].reshape(width, size)
        residuals(block, query.mean[0], query.basis[0], total, scratch)
        exact = max(there, reduced(total, size, False)) * times
        found[count], distance[count] = i, exact
        count += 1
        if exact < best[-1]:
            insert(exact, best)
    return found[:count], distance[:count]


@njit
def msm_first(segments, query, k):  # type: ignore[no-untyped-def]
    """MSM (times √(1 − B), if the query has a histogram) of the first k segments and maybe more, and their places.

    Nothing, where the bounds leave so many segments that `subspace.shared` is faster.
    """
    s = len(segments.squares)
    least, factor = msm_below(segments, query), factor_below(segments, query)
    _bounds(least, factor)
    found, distance, count = np.empty(s, dtype=np.int64), np.empty(s), 0
    best = np.full(k, np.inf)
    first, rank = _lowest(least, k), _rank(query.basis)
    for j in range(k + s):
        i = first[j] if j < k else j - k
        if j == k and (least <= best[-1]).sum() * _MANY > s:
            return found[:0], distance[:0]
        if least[i] <= best[-1] and least[i] < np.inf:
            exact = max(1.0 - shared_with(segments.basis[i], query.basis[0]) / rank, 0.0)
            exact *= _factor(i, segments.root, query.root)
            least[i] = np.inf  # it is not looked at again
            found[count], distance[count] = i, exact
            count += 1
            if exact < best[-1]:
                insert(exact, best)
    return found[:count], distance[:count]
