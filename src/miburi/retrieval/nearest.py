"""The first k segments, exactly, without looking at every frame of every segment.

A maximum over frames is at least its value at any one frame, and Err (eq. 1) is convex, so it is also at
least its value at the frames' mean. So each segment's DSPM is bounded from below twice: by the segments' means and
the query's subspace, which is one small product of matrices in float32 for all of them; and, where that leaves a
doubt, by a few telling points of each side and the other's subspace. Segments are visited from the lowest bound up,
until the k-th distance found is below all bounds that are left. What is visited is computed as for a whole ranking,
so the first k are the same bits.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import SUMS, njit
from miburi.motion import Floats
from miburi.retrieval.jvh import overlap
from miburi.retrieval.subspace import reduced, residuals, shared

POINTS = 3
# What rounding in float32 may add to a square, as a share of the largest squared norm (sums of 42 products),
# and in float64; there also to a coefficient of histograms.
_ROUNDING = 2e-5
_ROUNDING_64 = 1e-12
# Of this many times k segments, those of the lowest first bounds, the second bounds are looked at first.
_OPENING = 4

Singles = NDArray[np.float32]


class Coarse(NamedTuple):
    """What bounds need: means and subspaces of the segments, in float32, segments on the last axis.

    Means are of the frames that are compared: the mean of all need not lie in their hull.
    """

    centre: Floats
    """(D,): subtracted from all frames, so that float32 spends its digits on differences"""
    size: float
    """largest squared norm of a mean"""
    mean: Singles
    """(D, S)"""
    mean_square: Singles
    """(S,)"""
    basis: Singles
    """(D, dims · S)"""
    points: Floats
    """(S, POINTS, D): `telling` of each segment's frames, in float64, nothing subtracted"""


def telling(frames: Floats) -> Floats:
    """Points (POINTS, D) in the hull of frames (n, D) that are likely to be far from a foreign subspace.

    The mean, the frame that is farthest from it, and the frame that is farthest from that one.
    """
    mean = frames.mean(axis=0)
    one = frames[np.square(frames - mean).sum(axis=1).argmax()]
    other = frames[np.square(frames - one).sum(axis=1).argmax()]
    return np.stack([mean, one, other])


def coarse(basis: Floats, frames: NDArray[np.float32], offsets: NDArray[np.int64]) -> Coarse:
    """Prepare the bounds of an index's segments (arguments as in `Index`)."""
    points = np.stack([telling(frames[a:b].astype(np.float64)) for a, b in pairwise(offsets)])
    centre = points[:, 0].mean(axis=0)
    near = points[:, 0] - centre
    squares = np.square(near).sum(axis=1)

    def single(x: Floats) -> Singles:
        return np.ascontiguousarray(x, dtype=np.float32)

    return Coarse(
        centre,
        float(squares.max()),
        single(near.T),
        single(squares),
        single(np.moveaxis(basis, 1, 0).reshape(-1, near.shape[1]).T),
        points,
    )


def dspm_below(known: Coarse, mean: Floats, basis: Floats) -> Floats:
    """Lower bounds of DSPM, (S,), of a query with mean (D,) and basis (dims, D): Err of the segments' means."""
    q = (mean - known.centre).astype(np.float32)
    basis32 = basis.astype(np.float32)
    along = basis32 @ known.mean - (basis32 @ q)[:, None]
    size = float(q @ q)
    square = known.mean_square - 2 * (q @ known.mean) + size - np.square(along).sum(axis=0)
    least: Floats = np.sqrt(np.maximum(square - _ROUNDING * max(known.size, size), 0.0), dtype=np.float64)
    return least


def msm_below(known: Coarse, basis: Floats) -> Floats:
    """Lower bounds of 1 − Σ cos² / M, (S,), of the query's basis (dims, D)."""
    dots = (basis.astype(np.float32) @ known.basis).reshape(len(basis), -1, known.mean.shape[1])
    added = np.einsum("bas,bas->s", dots, dots).astype(np.float64)
    least: Floats = np.maximum(1.0 - added / basis.any(axis=1).sum() - _ROUNDING, 0.0)
    return least


def factor_below(roots: Floats, root: Floats) -> Floats:
    """Lower bounds of √(1 − B), (S,), of roots (S, D) of histograms and the query's (D,), not all zeros; 1 without."""
    if not len(root):
        return np.ones(len(roots))
    return np.sqrt(np.maximum(1.0 - roots @ root - _ROUNDING_64, 0.0))


def msm_first(least: Floats, roots: Floats, root: Floats, k: int, bases: Floats, basis: Floats) -> Floats:
    """MSM (times √(1 − B), unless root is empty) of what may be among the first k; infinity elsewhere."""
    rank = basis.any(axis=1).sum()
    out = np.full(len(least), np.inf)

    def add(some: NDArray[np.intp]) -> None:
        distance = np.maximum(
            1.0 - shared(np.ascontiguousarray(np.moveaxis(bases[some], 0, -1)), basis) / rank, 0.0
        )
        out[some] = distance * np.sqrt(1.0 - overlap(roots[some], root)) if len(root) else distance

    add(np.argpartition(least, k - 1)[:k])
    reach = np.partition(out, k - 1)[k - 1]
    add(np.flatnonzero((least <= reach) & np.isinf(out)))
    return out


class Segments(NamedTuple):
    """What DSPM needs of the segments, in float64: see `subspace`; points as in `Coarse`."""

    roots: Floats
    mean: Floats
    basis: Floats
    points: Floats
    blocks: Floats
    offsets: NDArray[np.int64]


class Query(NamedTuple):
    """What DSPM needs of the query: frames (D, n), points (POINTS, D), mean (D,), basis (dims, D), and the root of its
    Jvh (D,), empty where that is not asked for."""

    frames: Floats
    points: Floats
    mean: Floats
    basis: Floats
    root: Floats


def dspm_first(least: Floats, factor: Floats, k: int, segments: Segments, query: Query) -> Floats:
    """DSPM (times √(1 − B), unless the query's root is empty) of what may be among the first k; infinity elsewhere.

    least, factor (S,): lower bounds of the whole, which become closer where they are looked at, and of √(1 − B).
    """
    out, best = np.full(len(least), np.inf), np.full(k, np.inf)
    some = min(_OPENING * k, len(least) - 1)

    def visit(todo: NDArray[np.intp]) -> None:
        _closer(todo, best[-1], factor, *segments[1:4], *query[1:4], least)
        _visit(todo[np.argsort(least[todo])], least, *segments, *query, out, best)

    opening = np.argpartition(least, some)[:some]
    rest = np.ones(len(least), dtype=bool)
    rest[opening] = False
    visit(opening)
    visit(np.flatnonzero(rest & (least <= best[-1])))
    return out


@njit(fastmath=SUMS, error_model="numpy")
def _err(x, mean, basis, gap):  # type: ignore[no-untyped-def]
    """Err² (eq. 1) of a frame (D,), less what rounding may have added; gap (D,) is scratch."""
    total = 0.0
    for d in range(len(gap)):
        gap[d] = x[d] - mean[d]
        total += gap[d] * gap[d]
    left = (1.0 - _ROUNDING_64) * total
    for m in range(len(basis)):
        along = 0.0
        for d in range(len(gap)):
            along += basis[m, d] * gap[d]
        left -= along * along
    return left


@njit
def _closer(todo, limit, factor, means, bases, points, others, mean, basis, least):  # type: ignore[no-untyped-def]
    """Raise least[i], i in `todo`, to what the points of segment and query (`others`) say of DSPM, or beyond the limit.

    The segments' first points, the means, are in `least` already.
    """
    gap = np.empty(len(mean))
    for i in todo:
        square, enough = 0.0, (limit / factor[i]) ** 2 if factor[i] > 0.0 else np.inf
        for p in range(1, POINTS):
            square = max(square, _err(points[i, p], mean, basis, gap))
        for p in range(POINTS):
            if square <= enough:
                square = max(square, _err(others[p], means[i], bases[i], gap))
        least[i] = max(least[i], np.sqrt(square) * factor[i])


@njit
def _visit(  # type: ignore[no-untyped-def]
    todo, least, roots, means, bases, _points, blocks, offsets, frames, _others, mean, basis, root, out, best
):
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
        factor = np.sqrt(1.0 - overlap(roots[i : i + 1], root)[0]) if len(root) else 1.0
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
