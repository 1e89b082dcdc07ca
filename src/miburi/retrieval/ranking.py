"""Rankings: segments by their distance from a query."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.motion import Floats


@dataclass(frozen=True, eq=False)
class Ranking:
    """Segments by their distance from a query.

    Parameters
    ----------
    order : (k,) int64
        Indices of segments, nearest first; equal distances by index.
    score : (k,) float64
        Distance of segment `order[i]`; smaller is nearer.
    """

    order: NDArray[np.int64]
    score: Floats

    def __len__(self) -> int:
        return len(self.order)


def ranking(score: ArrayLike, k: int | None = None, segments: ArrayLike | None = None) -> Ranking:
    """The k smallest of the segments' distances (all, if k is None), equal ones by index.

    Parameters
    ----------
    score
        Distances.
    k
        How many to keep.
    segments
        Index of the segment of each distance; None: they are those of all segments, in order.

    Raises
    ------
    InputError
        k is less than 1.
    """
    values = np.asarray(score, dtype=np.float64)
    if k is not None and k < 1:
        raise InputError(f"the first {k} segments are wanted, expected at least 1")
    if segments is not None:
        places = np.asarray(segments, dtype=np.int64)
        order = np.lexsort((places, values))[:k]
        return Ranking(places[order], values[order])
    if k is None or k >= len(values):
        order = np.argsort(values, kind="stable")
    else:
        # all that are no worse than the k-th, so that ties at the limit are decided by index too
        near = np.flatnonzero(values <= np.partition(values, k - 1)[k - 1])
        order = near[np.argsort(values[near], kind="stable")][:k]
    return Ranking(order.astype(np.int64), values[order])


@njit
def insert(value, values):  # type: ignore[no-untyped-def]
    """Insert into sorted values what is smaller than the last, which falls out; where it stands."""
    j = len(values) - 1
    while j > 0 and values[j - 1] > value:
        values[j] = values[j - 1]
        j -= 1
    values[j] = value
    return j


@njit
def longest(offsets):  # type: ignore[no-untyped-def]
    """Frames of the longest of segments that lie end to end, offsets (S + 1,)."""
    most = 0
    for i in range(len(offsets) - 1):
        most = max(most, offsets[i + 1] - offsets[i])
    return most


def merge(rankings: Sequence[Ranking], sizes: Sequence[int], k: int | None = None) -> Ranking:
    """One ranking of several indices that lie one after the other (shards).

    Parameters
    ----------
    rankings
        One per shard, each of at least its first k.
    sizes
        Number of segments of each shard.
    k
        How many to keep; None: all that are there.

    Raises
    ------
    InputError
        k is less than 1.
    """
    shift = np.concatenate([[0], np.cumsum(sizes)])[:-1]
    order = np.concatenate([r.order + s for r, s in zip(rankings, shift, strict=True)])
    score = np.concatenate([r.score for r in rankings])
    return ranking(score, k, order)
