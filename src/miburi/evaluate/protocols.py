"""Rankings against what was meant: one row for each query and measure.

[P]'s users judged whether what they wanted was among the first 10 (5). Here a segment that has the query's
keyword is what they wanted.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from miburi import store
from miburi.artefacts import Segment
from miburi.errors import InputError
from miburi.evaluate.queries import Query
from miburi.evaluate.ranks import Ranks
from miburi.evaluate.rows import names, read_rows
from miburi.evaluate.statistics import chance_first, chance_of_hit, chance_rank

Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Score:
    """How a measure did for a query.

    Parameters
    ----------
    segments, relevant
        How many were ranked, and how many of them have the keyword.
    rank
        Of the segment that was played, from 1, ties counted at their middle; 0 where it is not ranked.
    first
        Of the first relevant segment; 0 where there is none.
    hit10, hit5
        1 if a relevant segment is among the first 10 (5).
    average_precision
        Mean precision at the relevant segments' ranks.
    precision10, precision5
        Share of the first 10 (5) that is relevant; of as many as there are, where fewer are ranked.
    chance_rank, chance_first, chance_hit10, chance_hit5
        What a random order would give.
    seconds
        Measured time of the ranking.
    queries
        "simulated" or "recorded".
    ranks
        File of the rankings that this row was computed from.
    """

    experiment: str
    protocol: int
    query: str
    keyword: str
    user: str
    style: str
    skill: float
    measure: str
    segments: int
    relevant: int
    rank: float
    first: int
    hit10: int
    hit5: int
    average_precision: float
    precision10: float
    precision5: float
    chance_rank: float
    chance_first: float
    chance_hit10: float
    chance_hit5: float
    seconds: float
    queries: str
    ranks: str


def score(
    ranks: Ranks,
    queries: Sequence[Query],
    segments: Sequence[Segment],
    keywords: Sequence[frozenset[str]],
    source: str = "",
) -> list[Score]:
    """Score the rankings of a measure.

    Parameters
    ----------
    queries
        Those that were ranked, by name.
    segments
        What was ranked, in the index's order.
    keywords
        Of each segment.
    source
        File of the rankings.

    Raises
    ------
    InputError
        The rankings are of other segments or queries.
    """
    by_name = {q.query: q for q in queries}
    if ranks.order.shape[1] != len(segments):
        raise InputError(f"ranks of {ranks.order.shape[1]} segments, the index has {len(segments)}")
    return [
        _score(ranks, k, _found(by_name, name), segments, keywords, source)
        for k, name in enumerate(ranks.query)
    ]


def _found(by_name: Mapping[str, Query], name: str) -> Query:
    if name not in by_name:
        raise InputError(f"ranks of the query {name!r}, which the experiment does not have")
    return by_name[name]


def _score(
    ranks: Ranks,
    k: int,
    query: Query,
    segments: Sequence[Segment],
    keywords: Sequence[frozenset[str]],
    source: str,
) -> Score:
    ranked = np.isfinite(ranks.score[k])
    order, distance = ranks.order[k][ranked], ranks.score[k][ranked]
    relevant = np.array([query.keyword in keywords[i] for i in order], dtype=np.bool_)
    at = np.flatnonzero(relevant) + 1
    n, r = len(order), len(at)
    rank = 0.0
    for place, i in enumerate(order):
        if segments[i] == (query.take, query.start, query.end):
            ties = np.flatnonzero(distance == distance[place])
            rank = float(ties.mean() + 1)
    return Score(
        experiment=ranks.experiment,
        protocol=query.protocol,
        query=query.query,
        keyword=query.keyword,
        user=query.user,
        style=query.style,
        skill=query.skill,
        measure=ranks.measure,
        segments=n,
        relevant=r,
        rank=rank if query.protocol == 1 else 0.0,
        first=int(at[0]) if r else 0,
        hit10=int(r > 0 and at[0] <= 10),
        hit5=int(r > 0 and at[0] <= 5),
        average_precision=float((np.arange(1, r + 1) / at).mean()) if r else 0.0,
        precision10=float(relevant[:10].mean()) if n else 0.0,
        precision5=float(relevant[:5].mean()) if n else 0.0,
        chance_rank=chance_rank(n),
        chance_first=chance_first(n, r),
        chance_hit10=chance_of_hit(n, r, 10),
        chance_hit5=chance_of_hit(n, r, 5),
        seconds=float(ranks.seconds[k]),
        queries=ranks.queries,
        ranks=source,
    )


def write_scores(path: Path, scores: Sequence[Score]) -> None:
    """Write scores as a CSV, a column for each field of `Score`."""
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(names(Score))
        for row in scores:
            values = [getattr(row, n) for n in names(Score)]
            table.writerow([f"{v:.6g}" if isinstance(v, float) else v for v in values])


def read_scores(path: Path) -> list[Score]:
    """Read scores; InputError names a missing column or a line that cannot be read."""
    return read_rows(path, Score)
