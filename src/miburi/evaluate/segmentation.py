"""How well cuts agree with the bounds that a person set, beside cutters that look at nothing."""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import astuple, dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from miburi import store
from miburi.errors import InputError
from miburi.evaluate.rows import names
from miburi.formats import text
from miburi.formats.annotations import Annotation
from miburi.motion import Floats

TOLERANCE_S = 0.5
"""Seconds by which a cut may miss a bound."""
_DRAWS = 1000


class Bounds(NamedTuple):
    """Where a person cut a take, seconds: the best place of each cut, and the earliest and latest acceptable
    ones where that was asked (else equal to the best)."""

    best: Floats
    earliest: Floats
    latest: Floats


def read_cut_points(path: text.File, fps: float) -> Bounds:
    """Cut points of one take as they are distributed for CMU subject 86.

    The first line is the number of segments; then, for each, a line with its number and name and one with the
    earliest, best and latest frame of the cut after it; the last one has the end of the take alone.

    Raises
    ------
    InputError
        The file is not built like this; the sentence names the line.
    """
    rows = []
    for number, line in enumerate(text.decode(text.load(path)).split("\n"), 1):
        cells = line.split()
        values = [v for v in map(text.real, cells) if v is not None]
        if len(values) == len(cells) == 3:
            if values[0] < 0:
                raise InputError(f"{path}, line {number}: frame {values[0]:g} is before the take's begin")
            rows.append(values)
        elif len(values) == len(cells) == 2:
            raise InputError(
                f"{path}, line {number}: 2 frames, expected the earliest, best and latest acceptable ones"
            )
    if not rows:
        raise InputError(f"{path}: holds no line with the earliest, best and latest frame of a cut")
    # some earliest frames are after the best ones: slips of the pen
    frames = np.array(rows) / fps
    return Bounds(frames[:, 1], frames.min(axis=1), frames.max(axis=1))


def bounds(intervals: Sequence[Annotation], seconds: float) -> Bounds:
    """Where the intervals of a take change into each other.

    Parameters
    ----------
    intervals
        All of the take's.
    seconds
        Its length.

    Returns
    -------
    Bounds
        One for an end and the next beginning that are at most twice `TOLERANCE_S` apart, in their middle;
        else one for each of the two: what is between them is a motion without a name. None within
        `TOLERANCE_S` of the take's begin and end.
    """
    found: list[float] = []
    last: float | None = None
    for row in sorted(intervals, key=lambda r: (r.start_s, r.end_s)):
        if last is None:
            found.append(row.start_s)
        elif abs(row.start_s - last) <= 2 * TOLERANCE_S:
            found.append((row.start_s + last) / 2)
        else:
            found += [last, row.start_s]
        last = row.end_s if last is None else max(last, row.end_s)
    if last is not None:
        found.append(last)
    inner = np.array(sorted(t for t in found if TOLERANCE_S < t < seconds - TOLERANCE_S))
    return Bounds(inner, inner, inner)


def matches(cuts: ArrayLike, earliest: ArrayLike, latest: ArrayLike) -> int:
    """The largest number of pairs of a cut and a bound whose range from earliest to latest holds the cut.

    Each cut and each bound is in one pair at most. Ranges must not lie inside one another.
    """
    times, low, high = (
        np.sort(np.asarray(v, dtype=np.float64).reshape(-1)) for v in (cuts, earliest, latest)
    )
    i = k = pairs = 0
    # the first cut and the first bound: who can only pair with what has gone by goes
    while i < len(times) and k < len(low):
        if times[i] < low[k] - 1e-9:
            i += 1
        elif times[i] > high[k] + 1e-9:
            k += 1
        else:
            i, k, pairs = i + 1, k + 1, pairs + 1
    return pairs


def uniform_cuts(count: int, seconds: float) -> Floats:
    """So many cuts at equal distances."""
    return seconds * np.arange(1, count + 1) / (count + 1)


@dataclass(frozen=True)
class SegmentationScore:
    """Agreement of a take's cuts with its bounds; `take` "all": of all takes together. A row of
    segmentation.csv.

    `found` counts pairs within half a second of the best place, `accepted` pairs between the earliest and the
    latest acceptable place. Uniform: as many cuts at equal distances. Random: as many at random, on average.
    """

    take: str
    method: str
    seconds: float
    cuts: int
    bounds: int
    found: int
    accepted: int
    precision: float
    recall: float
    uniform_precision: float
    uniform_recall: float
    random_precision: float
    random_recall: float
    people: str


class Agreement(NamedTuple):
    """Counts of one take."""

    seconds: float
    cuts: int
    bounds: int
    found: int
    accepted: int
    uniform: int
    random: float


def agreement(cuts_s: ArrayLike, human: Bounds, seconds: float, seed: int = 0) -> Agreement:
    """Count pairs of cuts and bounds, and those of cutters that look at nothing."""
    cuts = np.asarray(cuts_s, dtype=np.float64).reshape(-1)
    low, high = human.best - TOLERANCE_S, human.best + TOLERANCE_S
    rng = np.random.default_rng(seed)
    draws = rng.uniform(0, seconds, (_DRAWS, len(cuts)))
    return Agreement(
        seconds,
        len(cuts),
        len(human.best),
        matches(cuts, low, high),
        matches(cuts, np.minimum(human.earliest, low), np.maximum(human.latest, high)),
        matches(uniform_cuts(len(cuts), seconds), low, high),
        float(np.mean([matches(draw, low, high) for draw in draws])),
    )


def score(take: str, method: str, counts: Sequence[Agreement], people: str) -> SegmentationScore:
    """Precision and recall of counts that are added up."""
    seconds, cuts, bounds_, found, accepted, uniform, random = (
        sum(column) for column in zip(*counts, strict=True)
    )

    def share(pairs: float, of: float) -> float:
        return round(pairs / of, 4) if of else float("nan")

    return SegmentationScore(
        take, method, round(seconds, 3), int(cuts), int(bounds_), int(found), int(accepted),
        share(found, cuts), share(found, bounds_), share(uniform, cuts), share(uniform, bounds_),
        share(random, cuts), share(random, bounds_), people,
    )  # fmt: skip


def length_histogram(
    seconds: ArrayLike, width: float = 0.5, most: float = 15.0
) -> list[tuple[float, float, int]]:
    """How many segments are how long: rows (from, to, segments), seconds; the last bin is open."""
    lengths = np.asarray(seconds, dtype=np.float64).reshape(-1)
    edges = np.arange(0.0, most + width / 2, width)
    counts = np.histogram(np.minimum(lengths, most), np.append(edges, np.inf))[0]
    return [
        (float(a), float(b), int(n))
        for a, b, n in zip(edges, np.append(edges[1:], np.inf), counts, strict=True)
    ]


def write_scores(
    path: str | os.PathLike[str], counts: Mapping[tuple[str, str], Agreement], people: str
) -> None:
    """Write a row for each take and method and one for all takes of a method.

    Parameters
    ----------
    counts
        (take, method) → counts.
    people
        "simulated" or "recorded".
    """
    rows = [score(take, method, [one], people) for (take, method), one in sorted(counts.items())]
    for method in sorted({method for _, method in counts}):
        rows.append(
            score("all", method, [one for (_, m), one in sorted(counts.items()) if m == method], people)
        )
    write_table(path, names(SegmentationScore), map(astuple, rows))


def write_table(path: str | os.PathLike[str], header: Sequence[str], rows: Iterable[Sequence[Any]]) -> None:
    """Write rows as CSV, whole or not at all."""
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)
