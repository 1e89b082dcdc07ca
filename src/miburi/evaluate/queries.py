"""Which clip each simulated user plays, and what a ranking leaves out for it ([P], experiments 1 and 2).

Protocol 1: the user sees a segment of the corpus and plays it; all users see the same one of a keyword.
Protocol 2: the user is given the keyword and plays a performance of it that is not ranked. In a simulated corpus
somebody performs who is not in it. In a corpus of real people another interval of the keyword stands in, drawn
anew for each user, and all segments that overlap it are left out; where a keyword has one interval only, the
segment that was played is left out alone.
Protocol 3: as protocol 1, but the segments of the person shown are left out, so that only other people's count.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.artefacts import Segment
from miburi.errors import InputError
from miburi.evaluate.rows import names, read_rows
from miburi.formats.annotations import Annotation

if TYPE_CHECKING:
    from miburi.perform.puppeteer import User

Path = str | os.PathLike[str]


@dataclass(frozen=True)
class Query:
    """A clip that a simulated user plays with the puppet.

    Parameters
    ----------
    query
        Name.
    protocol
        1, 2 or 3.
    keyword
        What the user looks for.
    user, style, skill
        Who plays, how the puppet is held, and how well.
    take, start, end
        Frames of the clip that is played; an empty take: it is imagined.
    without_take, without_start, without_end
        Segments that overlap these frames are left out of the ranking; an empty take: none.
    without_subject
        Segments of this person are left out; empty: none.
    """

    query: str
    protocol: int
    keyword: str
    user: str
    style: str
    skill: float
    take: str = ""
    start: int = 0
    end: int = 0
    without_take: str = ""
    without_start: int = 0
    without_end: int = 0
    without_subject: str = ""


def spans(annotations: Sequence[Annotation], fps: Mapping[str, float]) -> list[tuple[str, int, int, str]]:
    """Annotations as frames: (take, start, end exclusive, keyword)."""
    return [
        (a.take, round(a.start_s * fps[a.take]), round(a.end_s * fps[a.take]), a.keyword)
        for a in annotations
        if a.take in fps
    ]


def keywords_of(
    segments: Sequence[Segment], intervals: Sequence[tuple[str, int, int, str]]
) -> list[frozenset[str]]:
    """Keywords of each segment: those of the intervals that it shares at least half of the shorter one with.

    A long segment that holds a short motion has its keyword, and so has each part of a motion that was cut in two
    or three; a segment that reaches a little into a neighbour does not have the neighbour's.
    """
    by_take: dict[str, list[tuple[int, int, str]]] = {}
    for take, start, end, keyword in intervals:
        by_take.setdefault(take, []).append((start, end, keyword))
    return [
        frozenset(
            keyword
            for a, b, keyword in by_take.get(take, ())
            if 2 * (min(end, b) - max(start, a)) >= min(end - start, b - a)
        )
        for take, start, end in segments
    ]


def plan_queries(
    experiment: str,
    protocols: Sequence[int],
    keywords: Sequence[str],
    users: Sequence[User],
    segments: Sequence[Segment],
    intervals: Sequence[tuple[str, int, int, str]],
    subjects: Mapping[str, str],
    *,
    imagined: bool,
    seed: int,
) -> list[Query]:
    """The queries of an experiment.

    Parameters
    ----------
    segments
        What is ranked.
    intervals
        (take, start, end, keyword), frames.
    subjects
        Take → who performs.
    imagined
        Protocol 2 by performances that are not in the corpus, instead of intervals that are left out.

    Raises
    ------
    InputError
        No segment has one of the keywords, or only one has where protocol 2 needs another.
    """
    found = keywords_of(segments, intervals)
    queries = []
    for protocol in protocols:
        for keyword in keywords:
            mine = [i for i, words in enumerate(found) if keyword in words]
            if not mine:
                known = ", ".join(sorted(frozenset().union(*found))) or "none"
                raise InputError(
                    f"experiments.{experiment}.keywords: no segment is {keyword!r}; there are {known}"
                )
            for user in users:
                name = f"p{protocol}-{keyword.replace(' ', '_').replace('/', '_')}-{user.name}"
                query = Query(name, protocol, keyword, user.name, user.style, round(user.skill, 4))
                if protocol == 2 and imagined:
                    queries.append(query)
                    continue
                shared = (
                    (seed, experiment, keyword) if protocol != 2 else (seed, experiment, keyword, user.name)
                )
                i = mine[int(store.seed("target", *shared).integers(len(mine)))]
                take, start, end = segments[i]
                clip: dict[str, Any] = {"take": take, "start": start, "end": end}
                if protocol == 3:
                    clip["without_subject"] = subjects[take]
                if protocol == 2:
                    if len(mine) == 1:
                        raise InputError(
                            f"experiments.{experiment}.keywords: one segment only is {keyword!r}; "
                            "protocol 2 leaves it out and needs another"
                        )
                    a, b = _interval(segments, i, keyword, intervals, mine)
                    clip |= {"without_take": take, "without_start": a, "without_end": b}
                queries.append(replace(query, **clip))
    return queries


def _interval(
    segments: Sequence[Segment],
    i: int,
    keyword: str,
    intervals: Sequence[tuple[str, int, int, str]],
    mine: Sequence[int],
) -> tuple[int, int]:
    """Frames to leave out with segment i: its interval of the keyword, or itself if nothing else would be left."""
    take, start, end = segments[i]
    a, b = start, end
    for name, first, last, word in intervals:
        if name == take and word == keyword and min(end, last) > max(start, first):
            a, b = min(a, first), max(b, last)
    others = [k for k in mine if segments[k][0] != take or segments[k][2] <= a or segments[k][1] >= b]
    return (a, b) if others else (start, end)


def left_out(query: Query, segments: Sequence[Segment], subjects: Mapping[str, str]) -> NDArray[np.bool_]:
    """Which segments a query's ranking leaves out, (S,)."""
    return np.array(
        [
            (take == query.without_take and start < query.without_end and end > query.without_start)
            or (query.without_subject != "" and subjects[take] == query.without_subject)
            for take, start, end in segments
        ],
        dtype=np.bool_,
    )


def write_queries(path: Path, queries: Sequence[Query]) -> None:
    """Write queries as a TSV, a column for each field of `Query`."""
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, delimiter="\t", lineterminator="\n")
        table.writerow(names(Query))
        table.writerows(astuple(q) for q in queries)


def read_queries(path: Path) -> list[Query]:
    """Read queries.

    Raises
    ------
    InputError
        A column is missing, or a cell is no number; the sentence names the line.
    """
    return read_rows(path, Query, "\t")
