"""The first k segments, exactly, without looking at every frame of every segment.

A maximum over frames is at least its value at any one frame, and Err (eq. 1) is convex, so it is also at
least its value at the frames' mean. A few such points per side bound each segment's DSPM from below; a few
matrix products in float32 give all bounds. Segments are visited from the lowest bound up, until the k-th
distance found is below all bounds that are left. What is visited is computed as for a whole ranking, so the
first k are the same bits.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.motion import Floats
from miburi.retrieval.jvh import overlap
from miburi.retrieval.subspace import reduced, residuals, shared

POINTS = 3
# What rounding in float32 may add to a square, as a share of the largest squared norm (sums of 42 products),
# and to a coefficient of histograms in float64.
_ROUNDING = 2e-5
_ROUNDING_B = 1e-12

Singles = NDArray[np.float32]


class Coarse(NamedTuple):
    """What bounds need, in float32, segments on the last axis."""

    centre: Floats
    """(D,): subtracted from all frames, so that float32 spends its digits on differences"""
    size: float
    """largest squared norm of mean and points"""
    mean: Singles
    """(D, S)"""
    mean_square: Singles
    """(S,)"""
    basis: Singles
    """(D, dims · S)"""
    mean_along: Singles
    """(dims, S): each segment's mean along its own basis"""
    points: Singles
    """(D, POINTS · S), of each segment's frames"""
    points_square: Singles
    """(POINTS · S,)"""


def telling(frames: Floats) -> Floats:
    """Points (POINTS, D) in the hull of frames (n, D) that are likely to be far from a foreign subspace.

    The mean, the frame that is farthest from it, and the frame that is farthest from that one.
    """
    mean = frames.mean(axis=0)
    one = frames[np.square(frames - mean).sum(axis=1).argmax()]
    other = frames[np.square(frames - one).sum(axis=1).argmax()]
    return np.stack([mean, one, other])


def coarse(mean: Floats, basis: Floats, frames: NDArray[np.float32], offsets: NDArray[np.int64]) -> Coarse:
    """Prepare the bounds of an index's segments (arguments as in `Index`)."""
    spans = pairwise(offsets)
    centre = mean.mean(axis=0)
    points = np.stack([telling(frames[a:b].astype(np.float64)) for a, b in spans], axis=1) - centre
    near = mean - centre
    squares, point_squares = np.square(near).sum(axis=1), np.square(points).sum(axis=2)

    def single(x: Floats) -> Singles:
        return np.ascontiguousarray(x, dtype=np.float32)

    return Coarse(
        centre,
        float(max(squares.max(), point_squares.max())),
        single(near.T),
        single(squares),
        single(np.moveaxis(basis, 1, 0).reshape(-1, near.shape[1]).T),
        single(np.einsum("smd,sd->ms", basis, near)),
        single(points.reshape(-1, near.shape[1]).T),
        single(point_squares.ravel()),
    )


def dspm_below(known: Coarse, frames: Floats, mean: Floats, basis: Floats) -> Floats:
    """Lower bounds of DSPM, (S,), of frames (n, D) drawn from a query with mean (D,) and basis (dims, D)."""
    dims, s = known.mean_along.shape
    x = telling(frames) - known.centre
    q = mean - known.centre
    size = max(known.size, float(np.square(x).sum(axis=1).max()))
    x_square = np.square(x).sum(axis=1).astype(np.float32)
    x32, q32, basis32 = x.astype(np.float32), q.astype(np.float32), basis.astype(np.float32)
    # the query's points and the segments' subspaces
    along = (x32 @ known.basis).reshape(POINTS, dims, s) - known.mean_along
    there = (
        known.mean_square
        - 2 * (x32 @ known.mean)
        + x_square[:, None]
        - np.einsum("pms,pms->ps", along, along)
    )
    # the segments' points and the query's subspace
    along = basis32 @ known.points - (basis32 @ q32)[:, None]
    back = known.points_square - 2 * (q32 @ known.points) + q32 @ q32 - np.einsum("ms,ms->s", along, along)
    square = np.maximum(there.max(axis=0), back.reshape(POINTS, s).max(axis=0)).astype(np.float64)
    least: Floats = np.sqrt(np.maximum(square - _ROUNDING * size, 0.0))
    return least


def msm_below(known: Coarse, basis: Floats) -> Floats:
    """Lower bounds of 1 − Σ cos² / M, (S,), of the query's basis (dims, D)."""
    dims, s = known.mean_along.shape
    dots = (basis.astype(np.float32) @ known.basis).reshape(-1, dims, s)
    added = np.einsum("bas,bas->s", dots, dots).astype(np.float64)
    least: Floats = np.maximum(1.0 - added / basis.any(axis=1).sum() - _ROUNDING, 0.0)
    return least


def factor_below(roots: Floats, histogram: Floats) -> Floats:
    """Lower bounds of √(1 − B), (S,), of roots (S, D) and the query's histogram (D,), not all zeros."""
    return np.sqrt(np.maximum(1.0 - roots @ np.sqrt(histogram) - _ROUNDING_B, 0.0))


def msm_first(
    least: Floats, roots: Floats | None, histogram: Floats, k: int, bases: Floats, basis: Floats
) -> Floats:
    """MSM (times √(1 − B), if roots are given) of what may be among the first k; infinity elsewhere."""
    rank = basis.any(axis=1).sum()
    out = np.full(len(least), np.inf)

    def add(some: NDArray[np.intp]) -> None:
        distance = np.maximum(
            1.0 - shared(np.ascontiguousarray(np.moveaxis(bases[some], 0, -1)), basis) / rank, 0.0
        )
        out[some] = (
            distance if roots is None else distance * np.sqrt(1.0 - overlap(roots[some], np.sqrt(histogram)))
        )

    add(np.argpartition(least, k - 1)[:k])
    reach = np.partition(out, k - 1)[k - 1]
    add(np.flatnonzero((least <= reach) & np.isinf(out)))
    return out


class Segments(NamedTuple):
    """What DSPM needs of the segments, in float64: see `subspace`."""

    roots: Floats
    mean: Floats
    basis: Floats
    blocks: Floats
    offsets: NDArray[np.int64]


class Query(NamedTuple):
    """What DSPM needs of the query: frames (D, n), mean (D,), basis (dims, D), √ of its Jvh (D,)."""

    frames: Floats
    mean: Floats
    basis: Floats
    root: Floats


def dspm_first(least: Floats, with_jvh: bool, k: int, segments: Segments, query: Query) -> Floats:
    """DSPM (times √(1 − B)) of the segments that may be among the first k, (S,); infinity elsewhere."""
    out, best = np.full(len(least), np.inf), np.full(k, np.inf)
    # the k lowest bounds first: their distances already leave few others to look at
    reach = np.partition(least, k - 1)[k - 1]
    _visit(np.flatnonzero(least <= reach), least, with_jvh, *segments, *query, out, best)
    left = np.flatnonzero((least > reach) & (least <= best[-1]))
    _visit(left[np.argsort(least[left])], least, with_jvh, *segments, *query, out, best)
    return out


@njit
def _visit(todo, least, with_jvh, roots, means, bases, blocks, offsets, frames, mean, basis, root, out, best):  # type: ignore[no-untyped-def]
    """Fill out[i] for i in `todo` that can matter, and best, the k smallest distances so far, sorted."""
    width, n = frames.shape
    last = len(best) - 1
    longest = n
    for i in todo:
        longest = max(longest, offsets[i + 1] - offsets[i])
    total, along = np.empty(longest), np.empty((len(basis), longest))
    for i in todo:
        if least[i] > best[last]:
            continue
        factor = np.sqrt(1.0 - overlap(roots[i : i + 1], root)[0]) if with_jvh else 1.0
        residuals(frames, means[i], bases[i], total, along)
        there = reduced(total, n, False)
        if there * factor > best[last]:
            continue
        size = offsets[i + 1] - offsets[i]
        block = blocks[width * offsets[i] : width * offsets[i + 1]].reshape(width, size)
        residuals(block, mean, basis, total, along)
        distance = max(there, reduced(total, size, False)) * factor
        out[i] = distance
        if distance < best[last]:
            j = last
            while j > 0 and best[j - 1] > distance:
                best[j] = best[j - 1]
                j -= 1
            best[j] = distance
