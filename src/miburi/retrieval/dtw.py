"""Dynamic time warping of feature sequences: all distances, or the first k without computing most of the rest.

The squared distances of frames are one product of matrices, |x|² − 2 x·y + |y|². The path is followed four rows
at a time, each a column behind the row before, so that four additions are under way at once.

Two bounds from below leave few segments to the whole computation. A path meets each frame of the query at least
once, which costs no less than the frame's distance from the box of the segment's frames. And with the frames
turned onto the principal axes of the index, x·y is at most the product along the first few axes plus the product
of what is left of both norms: a path through these smaller costs is shorter than any through the true ones.
Segments are visited in the order of a path through every eighth frame, which is no bound but soon finds the first
k, so that bounds have something to be compared with.
"""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.motion import Floats
from miburi.retrieval.ranking import insert, longest

# Rows of the cost matrix that are computed before it is asked whether the segment can still matter.
_ROWS = 64
# Principal axes of the second bound.
_AXES = 16
# Share of the frames by which segments are put in order.
_SPARSE = 8
# What rounding may add to a squared distance, as a share of the largest squared norm.
_ROUNDING = 1e-13


class Sequences(NamedTuple):
    """Frames of S segments, prepared; y is a frame.

    Nothing but the second bound depends on the other segments, so that shards give the same bits as the whole.
    """

    axes: Floats
    """(_AXES, D): principal axes of all frames"""
    rows: Floats
    """(N, D + 2): y, 1, |y|²"""
    short: Floats
    """(N, _AXES + 3): y along the axes, the norm of the rest of y, 1, |y|²"""
    sparse: Floats
    """(_, _AXES + 3): every eighth row of each segment in `short`"""
    offsets: NDArray[np.int64]
    """(S + 1,)"""
    sparse_offsets: NDArray[np.int64]
    """(S + 1,)"""
    low: Floats
    """(S, D): smallest values in each segment"""
    high: Floats
    """(S, D): largest"""


def prepare(frames: NDArray[np.float32], offsets: NDArray[np.int64]) -> Sequences:
    """Prepare the frames of an index (arguments as in `Index`)."""
    y = frames.astype(np.float64)
    axes = np.ascontiguousarray(np.linalg.eigh(y.T @ y)[1][:, : -_AXES - 1 : -1].T)
    end = np.stack([np.ones(len(y)), np.square(y).sum(axis=1)], axis=1)
    short = np.hstack([_shortened(y, axes), end])
    some = [np.arange(a, b, _SPARSE) for a, b in pairwise(offsets)]
    return Sequences(
        axes,
        np.hstack([y, end]),
        short,
        short[np.concatenate(some)],
        offsets,
        np.cumsum([0, *map(len, some)]),
        np.minimum.reduceat(y, offsets[:-1]),
        np.maximum.reduceat(y, offsets[:-1]),
    )


def _shortened(y: Floats, axes: Floats) -> Floats:
    """Frames along the axes, and the norm of what is left of each."""
    along = y @ axes.T
    rest = np.square(y).sum(axis=1) - np.square(along).sum(axis=1)
    found: Floats = np.hstack([along, np.sqrt(np.maximum(rest, 0.0))[:, None]])
    return found


def _columns(x: Floats, square: Floats) -> Floats:
    """−2 x, |x|², 1: what `rows` and `short` are multiplied by to give squared distances."""
    found: Floats = np.hstack([-2 * x, square[:, None], np.ones((len(x), 1))])
    return found


def distances(known: Sequences, query: Floats) -> Floats:
    """Warped distance of each segment from a query (n, D), (S,).

    The root of the smallest sum of squared Euclidean distances along a path from the first pair of frames to
    the last, in steps of one frame on either side or both (dtaidistance's `dtw_ndim.distance`).
    """
    found: Floats = _all(_columns(query, np.square(query).sum(axis=1)), known.rows, known.offsets)
    return found


def first(known: Sequences, query: Floats, k: int) -> Floats:
    """Distances of the segments that may be among the first k, the same bits as `distances`; infinity elsewhere."""
    square = np.square(query).sum(axis=1)
    rounding = _ROUNDING * max(square.max(), known.rows[:, -1].max())
    rest = _rest(np.ascontiguousarray(query.T), known.low, known.high, rounding)
    # lower costs by what rounding may have added to them
    short = _columns(_shortened(query, known.axes), square - rounding)
    estimate = _all(np.ascontiguousarray(short[::_SPARSE]), known.sparse, known.sparse_offsets)
    found: Floats = _first(
        np.argsort(estimate, kind="stable"),
        rest,
        short,
        known.short,
        _columns(query, square),
        known.rows,
        known.offsets,
        k,
    )
    return found


@njit
def _rest(frames, low, high, rounding):  # type: ignore[no-untyped-def]
    """What frames t, t + 1 … cost at least in each segment, (S, n + 1); frames (D, n)."""
    width, n = frames.shape
    rest, cost = np.zeros((len(low), n + 1)), np.empty(n)
    for s in range(len(low)):
        cost[:] = -rounding
        for d in range(width):
            a, b, row = low[s, d], high[s, d], frames[d]
            for t in range(n):
                gap = max(a - row[t], row[t] - b, 0.0)
                cost[t] += gap * gap
        for t in range(n - 1, -1, -1):
            rest[s, t] = rest[s, t + 1] + max(cost[t], 0.0)
    return rest


@njit
def _all(columns, rows, offsets):  # type: ignore[no-untyped-def]
    out, most = np.empty(len(offsets) - 1), longest(offsets)
    path, cost, nothing = np.empty(most + 1), np.empty(most * _ROWS), np.zeros(len(columns) + 1)
    for i in range(len(out)):
        out[i] = np.sqrt(_square(columns, rows[offsets[i] : offsets[i + 1]], nothing, np.inf, path, cost))
    return out


@njit
def _first(todo, rest, short_columns, short, columns, rows, offsets, k):  # type: ignore[no-untyped-def]
    out, best, most = np.full(len(offsets) - 1, np.inf), np.full(k, np.inf), longest(offsets)
    path, cost = np.empty(most + 1), np.empty(most * _ROWS)
    asked = told = 0
    for i in todo:
        a, b = offsets[i], offsets[i + 1]
        limit = best[k - 1]
        if rest[i, 0] > limit:
            continue
        if (
            limit < np.inf and asked < 2 * k + 3 * told
        ):  # it costs a third of a distance: asked as long as it pays
            asked += 1
            if _square(short_columns, short[a:b], rest[i], limit, path, cost) > limit:
                told += 1
                continue
        square = _square(columns, rows[a:b], rest[i], limit, path, cost)
        out[i] = np.sqrt(square)
        if square < limit:
            insert(square, best)
    return out


@njit
def _square(columns, rows, rest, limit, path, scratch):  # type: ignore[no-untyped-def]
    """Sum of squares along the best path; infinity as soon as it cannot be ≤ limit.

    path (≥ m + 1) and scratch (≥ m · _ROWS): fresh memory for each product would take as long as the product.
    """
    path[:] = np.inf
    path[0] = 0.0
    for t in range(0, len(columns), _ROWS):
        end = min(t + _ROWS, len(columns))
        cost = scratch[: (end - t) * len(rows)].reshape(end - t, len(rows))
        np.dot(columns[t:end], rows.T, cost)
        least = _follow(cost, path)
        if least + rest[end] > limit:
            return np.inf
    return max(path[len(rows)], 0.0)


@njit
def _follow(cost, path):  # type: ignore[no-untyped-def]
    """Go on by the rows of cost (r, m); returns the least sum of any path that ends in the last of them.

    path (≥ m + 1): path[j + 1] is the least sum of a path that ends at column j of the row before; path[0] is
    infinite but for 0 before the first row.
    """
    r, m = cost.shape
    t = 0
    while t + 4 <= r:
        row0, row1, row2, row3 = cost[t], cost[t + 1], cost[t + 2], cost[t + 3]
        left0 = left1 = left2 = left3 = np.inf
        corner0, corner1, corner2, corner3 = path[0], np.inf, np.inf, np.inf
        path[0] = np.inf
        # each row takes the cell above from the row before, which is a column ahead
        for j in range(m + 3):
            if j >= 3:
                cell = row3[j - 3] + min(min(left3, corner3), left2)
                corner3, left3 = left2, cell
                path[j - 2] = cell
            if 2 <= j < m + 2:
                cell = row2[j - 2] + min(min(left2, corner2), left1)
                corner2, left2 = left1, cell
            if 1 <= j < m + 1:
                cell = row1[j - 1] + min(min(left1, corner1), left0)
                corner1, left1 = left0, cell
            if j < m:
                above = path[j + 1]
                cell = row0[j] + min(min(left0, corner0), above)
                corner0, left0 = above, cell
        t += 4
    while t < r:
        left, corner = np.inf, path[0]
        path[0] = np.inf
        for j in range(m):
            above = path[j + 1]
            left = cost[t, j] + min(min(left, corner), above)
            corner = above
            path[j + 1] = left
        t += 1
    least = np.inf
    for j in range(m):
        least = min(least, path[j + 1])
    return least
