"""Our simulated users beside puppet logs of another origin that imitate the same clips.

A simulator that is wrong in a way that flatters retrieval does not show in its own results. Logs that somebody else
made, recorded or simulated, are ranked by the same index; where both get about the same ranks, it is not our
puppeteer that makes them. Only development users play here.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from miburi import store
from miburi.errors import InputError
from miburi.evaluate.rows import names
from miburi.evaluate.statistics import chance_rank
from miburi.formats import puppet
from miburi.motion import Motion
from miburi.perform.puppeteer import User, imitate
from miburi.retrieval.body import features, reset_angles
from miburi.retrieval.index import Index
from miburi.retrieval.ranking import ranking

Path = str | os.PathLike[str]


class Target(NamedTuple):
    """A log and the take of the corpus that it imitates; how its player held the puppet, and how well."""

    query: str
    take: str
    style: str
    skill: str


@dataclass(frozen=True)
class Comparison:
    """Ranks of one target, or the mean or median over all, by one measure.

    Parameters
    ----------
    query, take
        The log and its target; "mean" and "median" with an empty take: over all targets.
    style, skill
        Of the log's player, where its table says so.
    rank
        Of the target for the log; from 1, ties at their middle.
    rank_ours, lowest_ours, highest_ours
        Mean and extremes over our users.
    users
        How many of ours.
    segments, chance_rank
        How many are ranked, and what a random order would give.
    queries
        "simulated" or "recorded": the log; ours are simulated.
    """

    query: str
    take: str
    style: str
    skill: str
    measure: str
    rank: float
    rank_ours: float
    lowest_ours: float
    highest_ours: float
    users: int
    segments: int
    chance_rank: float
    queries: str


def read_targets(path: Path, template: str) -> list[Target]:
    """Read what logs imitate: a TSV with the column `query`; `template` makes the take's name of the columns.

    Raises
    ------
    InputError
        A column is missing.
    """
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    found = []
    for row in rows:
        try:
            found.append(
                Target(row["query"], template.format(**row), row.get("style", ""), row.get("skill", ""))
            )
        except KeyError as error:
            raise InputError(
                f"{path}: there is no column {error}, which 'query' and {template!r} need"
            ) from None
    return found


def rank_of(index: Index, x: ArrayLike, take: str, measure: str, reduction: str) -> float:
    """Rank, from 1, of the first segment of a take for a query x (T, 42); ties count at their middle."""
    found = ranking(index.distances(x, measure, reduction=reduction))
    here = [place for place, i in enumerate(found.order) if index.take[i] == take]
    if not here:
        raise InputError(f"the corpus has no segment of the take {take!r}")
    return float(np.flatnonzero(found.score == found.score[here[0]]).mean() + 1)


def compare(
    index: Index,
    targets: Sequence[Target],
    logs: Mapping[str, Path],
    clips: Mapping[str, Motion],
    players: Sequence[User],
    *,
    measures: Sequence[str],
    reduction: str,
    settings: Mapping[str, Any],
    simulated: bool,
    seed: object,
) -> list[Comparison]:
    """Rank each target for the log that imitates it and for each of our users who imitate it.

    Parameters
    ----------
    logs
        Query → puppet log.
    clips
        Take → the person who is imitated.
    players
        Development users.
    settings
        Of the 42 values.
    simulated
        Whether the logs are a simulator's even where they do not say so.

    Raises
    ------
    InputError
        A test user is among the players, or a log or target is missing.
    """
    if wrong := [u.name for u in players if u.split != "development"]:
        raise InputError(f"user {wrong[0]!r} is no development user; test users play the experiments alone")
    found = []
    for target in targets:
        if target.query not in logs or target.take not in clips:
            raise InputError(f"the log {target.query!r} of the take {target.take!r}: one of them is missing")
        log = logs[target.query]
        played = [
            imitate(clips[target.take], u, seed_parts=(seed, "puppeteers", target.query)) for u in players
        ]
        motions = [puppet.read(log), *(puppet.motion(angles, fps) for angles, fps in played)]
        values = [
            reset_angles(features(m, **settings), angle_weight=settings["angle_weight"]) for m in motions
        ]
        said = "simulated" if simulated or puppet.is_simulated(log) else "recorded"
        for measure in measures:
            theirs, *ours = (rank_of(index, x, target.take, measure, reduction) for x in values)
            found.append(_row(*target, measure, theirs, ours, len(index), said))
    return found + _summaries(found)


def _row(
    query: str,
    take: str,
    style: str,
    skill: str,
    measure: str,
    theirs: float,
    ours: Sequence[float],
    segments: int,
    queries: str,
) -> Comparison:
    return Comparison(
        query=query,
        take=take,
        style=style,
        skill=skill,
        measure=measure,
        rank=theirs,
        rank_ours=float(np.mean(ours)),
        lowest_ours=min(ours),
        highest_ours=max(ours),
        users=len(ours),
        segments=segments,
        chance_rank=chance_rank(segments),
        queries=queries,
    )


def _summaries(rows: Sequence[Comparison]) -> list[Comparison]:
    """Mean and median over the targets, of each measure."""
    found = []
    for name, reduce in (("mean", np.mean), ("median", np.median)):
        for measure in dict.fromkeys(r.measure for r in rows):
            mine = [r for r in rows if r.measure == measure]
            value = {
                f: float(reduce([getattr(r, f) for r in mine]))
                for f in ("rank", "rank_ours", "lowest_ours", "highest_ours")
            }
            found.append(
                Comparison(**{**asdict(mine[0]), "query": name, "take": "", "style": "", "skill": ""} | value)
            )
    return found


def write_comparison(path: Path, rows: Sequence[Comparison]) -> None:
    """Write a comparison as a CSV, a column for each field of `Comparison`."""
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(names(Comparison))
        for row in rows:
            table.writerow([f"{v:.4g}" if isinstance(v, float) else v for v in asdict(row).values()])
