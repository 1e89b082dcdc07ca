"""Hits and ranks as dots with intervals, beside the papers' figures and chance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

Row = Mapping[str, str]
_Marks = tuple[str, float | None, float | None, float | None, float | None, float | None]
"""A measure's name; ours, its interval, the paper's, chance."""
_TOP, _STEP, _FOOT = 8.0, 26.0, 40.0
"""Pixels above the first measure, of each, and below the last, where the scale stands."""


@dataclass(frozen=True)
class Dot:
    """A measure in a plot: how far across its marks lie in percent (None: there is none), and the same in words.

    Only heights are in pixels, so that a plot has the width of its place and its words keep their size.
    """

    name: str
    y: float
    ours: float | None
    low: float | None
    high: float | None
    paper: float | None
    chance: float | None
    words: str


@dataclass(frozen=True)
class Plot:
    """Measures below each other on one scale."""

    title: str
    scale: str
    height: float
    dots: tuple[Dot, ...]
    ticks: tuple[tuple[float, str], ...]
    top: float = _TOP
    step: float = _STEP


def hits(rows: Sequence[Row]) -> list[Plot]:
    """Shares of users that found the motion among the first ten, a plot for each protocol of table 1 or 3."""
    means = [r for r in rows if r["keyword"] == "mean"]
    plots = []
    for protocol in dict.fromkeys(r["protocol"] for r in means):
        here = [r for r in means if r["protocol"] == protocol]
        values = [
            (
                r["measure"],
                _share(r, "hit10", "users"),
                _share(r, "hit10_low", "users"),
                _share(r, "hit10_high", "users"),
                _share(r, "hit10_paper", "users_paper"),
                _share(r, "chance10", "users"),
            )
            for r in here
        ]
        title = f"Protocol {protocol}: share of users that found the motion among the first 10"
        plots.append(_plot(title, "share of users", values, 0.0, 1.0, [0, 0.25, 0.5, 0.75, 1], False))
    return [p for p in plots if p.dots]


def ranks(rows: Sequence[Row]) -> list[Plot]:
    """Mean ranks of the clip that was shown, of table 2."""
    here = [r for r in rows if r["keyword"] == "mean"]
    names = ("mean_rank", "mean_rank_low", "mean_rank_high", "mean_rank_paper", "chance_rank")
    values: list[_Marks] = [
        (r["measure"], *(_value(r, n) for n in names))  # type: ignore[misc]
        for r in here
    ]
    most = max((v for row in values for v in row[1:] if isinstance(v, float)), default=1.0)
    ticks = [t for t in (1, 3, 10, 30, 100, 300, 1000, 3000) if t <= most * 1.1]
    title = "Mean rank of the clip that the user saw and imitated (1 is best)"
    plot = _plot(title, "mean rank (logarithmic)", values, 1.0, max(most * 1.1, 2.0), ticks, True)
    return [plot] if plot.dots else []


def _value(row: Row, name: str) -> float | None:
    try:
        found = float(row.get(name, ""))
    except ValueError:
        return None
    return found if math.isfinite(found) else None


def _share(row: Row, name: str, whole: str) -> float | None:
    part, all_of = _value(row, name), _value(row, whole)
    return None if part is None or not all_of else part / all_of


def _plot(
    title: str,
    scale: str,
    values: Sequence[_Marks],
    least: float,
    most: float,
    ticks: Sequence[float],
    log: bool,
) -> Plot:
    def place(value: float | None) -> float | None:
        if value is None:
            return None
        at, a, b = (max(value, least), least, most)
        share = math.log(at / a) / math.log(b / a) if log else (at - a) / (b - a)
        return round(100 * share, 2)

    dots: list[Dot] = []
    for name, ours, low, high, paper, chance in values:
        if ours is None and paper is None:
            continue
        words = [
            f"{kind} {value:.3g}"
            for kind, value in (("ours", ours), ("paper", paper), ("chance", chance))
            if value is not None
        ]
        if low is not None and high is not None:
            words[0] += f" ({low:.3g} to {high:.3g})"
        y = _TOP + (len(dots) + 0.5) * _STEP
        marks = (place(ours), place(low), place(high), place(paper), place(chance))
        dots.append(Dot(name, y, *marks, f"{name}: {', '.join(words)}"))
    at = tuple((float(place(t) or 0.0), f"{t:g}") for t in ticks)
    return Plot(title, scale, _TOP + len(dots) * _STEP + _FOOT, tuple(dots), at)
