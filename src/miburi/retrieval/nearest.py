"""The first k segments by DSPM, exactly, without looking at every frame of every segment.

A maximum over frames is at least its value at any one frame, and Err (eq. 1) is convex, so it is also at least its
value at the frames' mean. A few such points per side bound each segment's distance from below. Segments are visited
from the lowest bound up, until the k-th distance found is below all bounds that are left.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from miburi.motion import Floats
from miburi.retrieval.subspace import _reduce, _residuals

POINTS = 3
_LANES = 128
# Bounds are computed in float32, whose rounding (6e-8 of the numbers' size) must not lift one above its distance:
# shares of the squared distance to the mean and of the squared size that are taken off.
_NEAR, _SLACK = 2e-5, 1e-6

Singles = NDArray[np.float32]


class Coarse(NamedTuple):
    """What bounds need, segments side by side (last axis) so that one instruction serves several of them."""

    centre: Floats
    """(D,): subtracted from all, so that float32 spends its digits on differences"""
    size: float
    """largest squared norm of what is below"""
    mean: Singles
    """(D, S)"""
    basis: Singles
    """(dims, D, S)"""
    points: Singles
    """(POINTS, D, S): of each segment's frames"""


def telling(frames: Floats) -> Floats:
    """Points (POINTS, D) in the convex hull of frames (n, D) that are likely to be far from a foreign subspace.

    The mean, the frame that is farthest from it, and the frame that is farthest from that one.
    """
    mean = frames.mean(axis=0)
    one = frames[np.square(frames - mean).sum(axis=1).argmax()]
    other = frames[np.square(frames - one).sum(axis=1).argmax()]
    return np.stack([mean, one, other])


def coarse(mean: Floats, basis: Floats, frames: NDArray[np.float32], offsets: NDArray[np.int64]) -> Coarse:
    """Prepare the bounds of an index's segments (arguments as in `Index`)."""
    spans = zip(offsets[:-1], offsets[1:], strict=True)
    centre = mean.mean(axis=0)
    points = np.stack([telling(frames[a:b].astype(np.float64)) for a, b in spans]) - centre
    size = float(max(np.square(points).sum(axis=2).max(), np.square(mean - centre).sum(axis=1).max()))
    means, bases, telltale = (
        np.ascontiguousarray(np.moveaxis(x, 0, -1), dtype=np.float32) for x in (mean - centre, basis, points)
    )
    return Coarse(centre, size, means, bases, telltale)


def below(known: Coarse, frames: Floats, mean: Floats, basis: Floats) -> Floats:
    """Lower bounds of the segments' DSPM, (S,).

    Parameters
    ----------
    known
        The segments.
    frames : (n, D)
        Frames drawn from the query.
    mean : (D,)
    basis : (dims, D)
        The query's subspace.
    """
    points = telling(frames) - known.centre
    size = max(known.size, np.square(points).sum(axis=1).max())
    query = (a.astype(np.float32) for a in (points, mean - known.centre, basis))
    squares = _squares(known.mean, known.basis, known.points, *query, np.float32(_SLACK * size))
    return np.sqrt(squares.astype(np.float64))


@njit(cache=True)  # type: ignore[misc]
def _squares(mean, basis, points, query_points, query_mean, query_basis, slack):  # type: ignore[no-untyped-def]
    """Squares below which DSPM's square cannot be, (S,) float32; float32 arguments, the first three as in `Coarse`."""
    width, s = mean.shape
    dims = len(query_basis)
    out = np.zeros(s, dtype=np.float32)
    gap = np.empty(_LANES, dtype=np.float32)
    total = np.empty(_LANES, dtype=np.float32)
    along = np.empty((dims, _LANES), dtype=np.float32)
    for first in range(0, s, _LANES):
        n = min(_LANES, s - first)
        for p in range(2 * POINTS):
            total[:] = 0.0
            along[:] = 0.0
            for d in range(width):
                if p < POINTS:
                    # the query's points and the segments' subspaces
                    for j in range(n):
                        gap[j] = query_points[p, d] - mean[d, first + j]
                    for m in range(dims):
                        for j in range(n):
                            along[m, j] += basis[m, d, first + j] * gap[j]
                else:
                    for j in range(n):
                        gap[j] = points[p - POINTS, d, first + j] - query_mean[d]
                    for m in range(dims):
                        b = query_basis[m, d]
                        for j in range(n):
                            along[m, j] += b * gap[j]
                for j in range(n):
                    total[j] += gap[j] * gap[j]
            for j in range(n):
                total[j] = total[j] * np.float32(1.0 - _NEAR) - slack
            for m in range(dims):
                for j in range(n):
                    total[j] -= along[m, j] * along[m, j]
            for j in range(n):
                out[first + j] = max(out[first + j], total[j])
    return out


@njit(cache=True)  # type: ignore[misc]
def visit(least, factor, k, frames, means, bases, blocks, offsets, mean, basis):  # type: ignore[no-untyped-def]
    """Distances of the segments that may be among the first k; infinity elsewhere.

    least (S,): lower bounds; factor (S,): what each distance is multiplied by; the rest as in `subspace`.
    """
    s, dims = len(least), len(basis)
    width, n = frames.shape
    longest = n
    for i in range(s):
        longest = max(longest, offsets[i + 1] - offsets[i])
    total, along = np.empty(longest), np.empty((dims, longest))
    out = np.full(s, np.inf)
    best = np.full(k, np.inf)
    # the k lowest bounds first: their distances already leave few others to look at
    reach = np.partition(least, k - 1)[k - 1]
    for turn in range(2):
        if turn == 0:
            todo = np.flatnonzero(least <= reach)
        else:
            todo = np.flatnonzero((least > reach) & (least <= best[k - 1]))
            todo = todo[np.argsort(least[todo])]
        for i in todo:
            if least[i] > best[k - 1]:
                continue
            _residuals(frames, means[i], bases[i], total, along)
            there = _reduce(total, n, False)
            if there * factor[i] > best[k - 1]:
                continue
            size = offsets[i + 1] - offsets[i]
            block = blocks[width * offsets[i] : width * offsets[i + 1]].reshape(width, size)
            _residuals(block, mean, basis, total, along)
            distance = max(there, _reduce(total, size, False)) * factor[i]
            out[i] = distance
            j = k - 1
            if distance < best[j]:
                while j > 0 and best[j - 1] > distance:
                    best[j] = best[j - 1]
                    j -= 1
                best[j] = distance
    return out
