"""The artefact "miburi/ranks": what a measure ranks first for each query of an experiment."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi import store
from miburi.errors import InputError

Path = str | os.PathLike[str]


@dataclass(frozen=True, eq=False)
class Ranks:
    """Rankings of Q queries over S segments.

    Parameters
    ----------
    query
        Q names.
    order : (Q, S) int64
        Segments, nearest first.
    score : (Q, S) float64
        Distance of segment `order[q, i]`; infinite where a segment is left out of the ranking.
    seconds : (Q,)
        Time that ranking took, without reading the index and the query.
    measure, experiment
        Names.
    queries
        "simulated" or "recorded".
    """

    query: tuple[str, ...]
    order: NDArray[np.int64]
    score: NDArray[np.float64]
    seconds: NDArray[np.float64]
    measure: str
    experiment: str
    queries: str


def write_ranks(
    path: Path,
    query: Sequence[str],
    order: ArrayLike,
    score: ArrayLike,
    seconds: ArrayLike,
    *,
    measure: str,
    experiment: str,
    queries: str,
    sources: Mapping[str, str],
) -> None:
    """Write rankings; see `Ranks`."""
    with store.create(path, "ranks", sources) as file:
        store.put(file, "query", list(query))
        store.put(file, "order", np.asarray(order, dtype=np.int64))
        store.put(file, "score", np.asarray(score, dtype=np.float64))
        store.put(file, "seconds", np.asarray(seconds, dtype=np.float64))
        file.attrs["measure"] = measure
        file.attrs["experiment"] = experiment
        file.attrs["queries"] = queries


def read_ranks(path: Path) -> Ranks:
    """Read rankings.

    Raises
    ------
    InputError
        The file is missing or damaged, or its arrays do not fit together.
    """
    with store.open_checked(path, "ranks") as file:
        query = store.get_strings(file, "query")
        order = store.get(file, "order", (len(query), None))
        absent = [a for a in ("measure", "experiment", "queries") if a not in file.attrs]
        if absent:
            raise InputError(f"{path}: the attribute {absent[0]!r} is missing")
        return Ranks(
            tuple(query),
            order,
            store.get(file, "score", order.shape),
            store.get(file, "seconds", (len(query),)),
            *(str(file.attrs[a]) for a in ("measure", "experiment", "queries")),
        )
