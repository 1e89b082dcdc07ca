"""The papers' tables: our figure and the printed one side by side.

Averages are computed from the rows. [P]'s own averages do not all follow from its rows (table 1, DSPM(GP-LVM) in
protocol 1, and table 3, MSM), so the rows `mean` recompute the paper's too.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from miburi import store
from miburi.evaluate import printed
from miburi.evaluate.protocols import Score
from miburi.evaluate.statistics import difference, interval

Row = dict[str, Any]
REFERENCE = "DSPM(PCA)"
"""The measure that [P] proposes: the others are compared with it, query by query."""
NAIVE = "mean pose"
NOT_RUN = "not among this run's measures"


def table(name: str, scores: Sequence[Score], seed: int = 0) -> list[Row]:
    """A table of [P], or one of ours beside them.

    Parameters
    ----------
    name
        "table1" to "table5"; "differences1", "differences2": measures compared in pairs; "other_people": protocol
        3, where the person shown is not ranked.
    scores
        Of the experiment that the table shows.
    seed
        Of the intervals' bootstrap.
    """
    return _TABLES[name](name, scores, seed)


def _means(
    rows: Iterable[Mapping[str, str]], keys: Sequence[str], value: str
) -> dict[tuple[str, ...], float]:
    found: dict[tuple[str, ...], list[float]] = {}
    for row in rows:
        found.setdefault(tuple(row[k] for k in keys), []).append(float(row[value]))
    return {key: float(np.mean(values)) for key, values in found.items()}


def _ordered(names: Iterable[str], first: Iterable[str]) -> list[str]:
    """Names without repeats, those of the paper first."""
    wanted = set(names)
    return [n for n in dict.fromkeys(first) if n in wanted] + [
        n for n in dict.fromkeys(names) if n not in set(first)
    ]


def _round(value: float | None, digits: int = 3) -> float | str:
    return "" if value is None or not np.isfinite(value) else round(value, digits)


def _hits(name: str, scores: Sequence[Score], seed: int) -> list[Row]:
    """Tables 1 and 3: how many users find what they wanted among the first 10 (5)."""
    paper = printed.table(name)
    theirs = {(r["protocol"], r["measure"], r["keyword"]): r for r in paper}
    measures = _ordered(
        [s.measure for s in scores] + [r["measure"] for r in paper], [r["measure"] for r in paper]
    )
    keywords = _ordered([s.keyword for s in scores], [r["keyword"] for r in paper])
    protocols = sorted({s.protocol for s in scores})
    naive = [s for s in scores if s.measure == NAIVE]
    rows = []
    for protocol in protocols:
        for measure in measures:
            mine = [s for s in scores if s.protocol == protocol and s.measure == measure]
            printed_rows = [r for r in paper if r["protocol"] == str(protocol) and r["measure"] == measure]
            if not mine and not printed_rows:
                continue
            for keyword in keywords:
                here = [s for s in mine if s.keyword == keyword]
                there = theirs.get((str(protocol), measure, keyword))
                rows.append(
                    _head(protocol, measure, keyword)
                    | _counted(here)
                    | _naive_hits([s for s in naive if s.protocol == protocol and s.keyword == keyword], 1)
                    | {
                        "hit10_low": "",
                        "hit10_high": "",
                        "hit10_paper": there["users_hit_top10"] if there else "",
                        "hit5_paper": there["users_hit_top5"] if there else "",
                        "users_paper": there["users"] if there else "",
                    }
                    | _tail(mine)
                )
            rows.append(
                _head(protocol, measure, "mean")
                | _mean_hits(mine, seed)
                | _naive_hits([s for s in naive if s.protocol == protocol], len(keywords))
                | _mean_paper(printed_rows)
                | _tail(mine)
            )
    return rows


def _head(protocol: int, measure: str, keyword: str) -> Row:
    return {"protocol": protocol, "measure": measure, "keyword": keyword}


def _tail(mine: Sequence[Score]) -> Row:
    return {
        "queries": ", ".join(sorted({s.queries for s in mine})) or "simulated",
        "ranks": ", ".join(sorted({s.ranks for s in mine})),
        "note": "" if mine else NOT_RUN,
    }


def _naive_hits(naive: Sequence[Score], keywords: int) -> Row:
    """Users per keyword that the naive measure serves."""
    return {
        "hit10_mean_pose": _round(sum(s.hit10 for s in naive) / keywords) if naive else "",
        "hit5_mean_pose": _round(sum(s.hit5 for s in naive) / keywords) if naive else "",
    }


def _counted(here: Sequence[Score]) -> Row:
    if not here:
        return dict.fromkeys(("hit10", "hit5", "users", "chance10", "chance5"), "")
    return {
        "hit10": sum(s.hit10 for s in here),
        "hit5": sum(s.hit5 for s in here),
        "users": len(here),
        "chance10": _round(sum(s.chance_hit10 for s in here)),
        "chance5": _round(sum(s.chance_hit5 for s in here)),
    }


def _mean_hits(mine: Sequence[Score], seed: int) -> Row:
    """Per keyword: users that hit, mean over keywords, with an interval over queries."""
    if not mine:
        return dict.fromkeys(("hit10", "hit5", "users", "chance10", "chance5", "hit10_low", "hit10_high"), "")
    users = len(mine) / len({s.keyword for s in mine})
    low, high = interval([s.hit10 for s in mine], (seed, mine[0].measure, mine[0].protocol))
    return {
        "hit10": _round(users * float(np.mean([s.hit10 for s in mine]))),
        "hit5": _round(users * float(np.mean([s.hit5 for s in mine]))),
        "users": _round(users),
        "chance10": _round(users * float(np.mean([s.chance_hit10 for s in mine]))),
        "chance5": _round(users * float(np.mean([s.chance_hit5 for s in mine]))),
        "hit10_low": _round(users * low),
        "hit10_high": _round(users * high),
    }


def _mean_paper(rows: Sequence[Mapping[str, str]]) -> Row:
    if not rows:
        return {"hit10_paper": "", "hit5_paper": "", "users_paper": ""}
    return {
        "hit10_paper": _round(float(np.mean([float(r["users_hit_top10"]) for r in rows]))),
        "hit5_paper": _round(float(np.mean([float(r["users_hit_top5"]) for r in rows]))),
        "users_paper": rows[0]["users"],
    }


def _target_ranks(name: str, scores: Sequence[Score], seed: int) -> list[Row]:
    """Table 2: mean rank of the clip that was shown, protocol 1.

    Clips of one class by one person are near copies of each other, so beside it stands the mean rank of the first
    clip that has the keyword (`first`).
    """
    paper = printed.table(name)
    theirs = {(r["measure"], r["keyword"]): float(r["mean_rank_of_target"]) for r in paper}
    shown = [s for s in scores if s.protocol == 1]
    naive = [s for s in shown if s.measure == NAIVE]
    measures = _ordered(
        [s.measure for s in shown] + [r["measure"] for r in paper], [r["measure"] for r in paper]
    )
    keywords = _ordered([s.keyword for s in shown], [r["keyword"] for r in paper])
    rows = []
    for measure in measures:
        mine = [s for s in shown if s.measure == measure]
        for keyword in [*keywords, "mean"]:
            here = [s for s in mine if keyword in (s.keyword, "mean")]
            there = [v for (m, k), v in theirs.items() if m == measure and keyword in (k, "mean")]
            low, high = interval([s.rank for s in here], (seed, measure, keyword)) if here else (None, None)
            rows.append(
                {
                    "measure": measure,
                    "keyword": keyword,
                    "mean_rank": _mean(here, "rank"),
                    "mean_rank_low": _round(low),
                    "mean_rank_high": _round(high),
                    "mean_rank_paper": _round(float(np.mean(there))) if there else "",
                    "mean_rank_mean_pose": _mean(naive, "rank", keyword),
                    "chance_rank": _mean(here, "chance_rank"),
                    "mean_first": _mean(here, "first"),
                    "mean_first_mean_pose": _mean(naive, "first", keyword),
                    "chance_first": _mean(here, "chance_first"),
                    "segments": here[0].segments if here else "",
                    "segments_paper": printed.SEGMENTS[name],
                }
                | _tail(mine)
            )
    return rows


def _mean(scores: Sequence[Score], field: str, keyword: str = "mean") -> float | str:
    """Mean of a field over the scores of a keyword, or all."""
    values = [float(getattr(s, field)) for s in scores if keyword in (s.keyword, "mean")]
    return _round(float(np.mean(values))) if values else ""


_COMPARED = ("hit10", "hit5", "rank", "first", "average_precision", "precision10", "precision5")


def _differences(name: str, scores: Sequence[Score], seed: int) -> list[Row]:
    """Each measure minus the reference for the same queries, with a paired bootstrap interval."""
    by_query = {(s.measure, s.query): s for s in scores}
    rows = []
    for protocol in sorted({s.protocol for s in scores}):
        for measure in dict.fromkeys(s.measure for s in scores):
            mine = [s for s in scores if (s.protocol, s.measure) == (protocol, measure)]
            theirs = [by_query[REFERENCE, s.query] for s in mine if (REFERENCE, s.query) in by_query]
            if measure == REFERENCE or len(theirs) < len(mine):
                continue
            for field in _COMPARED:
                if field == "rank" and protocol != 1:
                    continue
                one, other = ([float(getattr(s, field)) for s in side] for side in (mine, theirs))
                found = difference(one, other, (seed, name, protocol, measure, field))
                rows.append(
                    {
                        "protocol": protocol,
                        "measure": measure,
                        "against": REFERENCE,
                        "figure": field,
                        "value": _round(float(np.mean(one))),
                        "value_against": _round(float(np.mean(other))),
                        "difference": _round(found.mean),
                        "difference_low": _round(found.low),
                        "difference_high": _round(found.high),
                        "wilcoxon_p": f"{found.p:.2g}",
                        "paired_queries": len(mine),
                    }
                    | _tail([*mine, *theirs])
                )
    return rows


def _other_people(name: str, scores: Sequence[Score], seed: int) -> list[Row]:
    """Protocol 3: one person's clip is imitated, only other people's clips are ranked."""
    mine_all = [s for s in scores if s.protocol == 3]
    naive = [s for s in mine_all if s.measure == NAIVE]
    rows = []
    for measure in dict.fromkeys(s.measure for s in mine_all):
        mine = [s for s in mine_all if s.measure == measure]
        for keyword in [*dict.fromkeys(s.keyword for s in mine), "mean"]:
            here = [s for s in mine if keyword in (s.keyword, "mean")]
            low, high = interval([s.average_precision for s in here], (seed, name, measure, keyword))
            rows.append(
                {
                    "measure": measure,
                    "keyword": keyword,
                    "precision5": _mean(here, "precision5"),
                    "precision10": _mean(here, "precision10"),
                    "mean_average_precision": _mean(here, "average_precision"),
                    "mean_average_precision_low": _round(low),
                    "mean_average_precision_high": _round(high),
                    "mean_first": _mean(here, "first"),
                    "precision5_mean_pose": _mean(naive, "precision5", keyword),
                    "precision10_mean_pose": _mean(naive, "precision10", keyword),
                    "mean_average_precision_mean_pose": _mean(naive, "average_precision", keyword),
                    "chance_precision": _round(float(np.mean([s.relevant / s.segments for s in here]))),
                    "chance_first": _mean(here, "chance_first"),
                    "segments": max(s.segments for s in here),
                    "users": len({s.user for s in here}),
                }
                | _tail(here)
            )
    return rows


def _seconds(name: str, scores: Sequence[Score], seed: int) -> list[Row]:
    """Tables 4 and 5: seconds per query; ours is the median over all queries, on one core of this machine."""
    paper = printed.table(name)
    measures = _ordered(
        [s.measure for s in scores] + [r["measure"] for r in paper], [r["measure"] for r in paper]
    )
    rows = []
    for measure in measures:
        mine = [s for s in scores if s.measure == measure]
        there = [r for r in paper if r["measure"] == measure] or [{}]
        for r in there:
            rows.append(
                {
                    "measure": measure,
                    "seconds": f"{float(np.median([s.seconds for s in mine])):.3g}" if mine else "",
                    "segments": max(s.segments for s in mine) if mine else "",
                    "seconds_paper": r.get("seconds_per_query", ""),
                    "implementation_paper": r.get("implementation", ""),
                    "segments_paper": printed.SEGMENTS[name] if r else "",
                }
                | _tail(mine)
            )
    return rows


_TABLES: dict[str, Callable[[str, Sequence[Score], int], list[Row]]] = {
    "table1": _hits,
    "table2": _target_ranks,
    "table3": _hits,
    "table4": _seconds,
    "table5": _seconds,
    "differences1": _differences,
    "differences2": _differences,
    "other_people": _other_people,
}


def label_counts(
    intervals: Sequence[tuple[str, int]], lengths: Sequence[Mapping[str, str]], string: str, recordings: str
) -> list[Row]:
    """[H]'s table 2 and the length of its string.

    Parameters
    ----------
    intervals
        Label and frames of each labelled interval.
    lengths
        Rows `quantity`, `value`, `unit` of the string that was synthesised.
    string
        Its labels; the printed length stands beside [H]'s own string only.
    recordings
        "simulated" or "recorded".
    """
    printed_length = printed.LENGTH if string.split() == printed.STRING.split() else ""
    theirs = {r["label"]: r for r in printed.table("label_counts")}
    labels = _ordered([label for label, _ in intervals], list(theirs))
    rows = []
    for quantity in ("frames", "intervals"):
        for label in [*labels, "all"]:
            mine = [n for name, n in intervals if label in (name, "all")]
            there = [int(r[quantity]) for name, r in theirs.items() if label in (name, "all")]
            rows.append(
                {
                    "quantity": quantity,
                    "label": label,
                    "value": sum(mine) if quantity == "frames" else len(mine),
                    "paper": sum(there) if there else "",
                    "unit": quantity,
                }
            )
    for row in lengths:
        if row["quantity"].startswith("length") and not row["quantity"].endswith("spliced"):
            rows.append(
                {
                    "quantity": row["quantity"],
                    "label": "",
                    "value": row["value"],
                    "paper": printed_length,
                    "unit": "frames",
                }
            )
    return [row | {"recordings": recordings} for row in rows]


def write_table(path: str | os.PathLike[str], rows: Sequence[Row]) -> None:
    """Write a table as CSV."""
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.DictWriter(file, list(rows[0]) if rows else [], lineterminator="\n")
        table.writeheader()
        table.writerows(rows)
