"""Every number worth watching, and the comparison with a committed baseline."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from miburi import store
from miburi.errors import InputError
from miburi.evaluate.protocols import Score

Metric = dict[str, Any]
"""value, unit, better ("lower", "higher" or "equal") and tolerance: how much worse is still the same."""

_RELATIVE = 0.02  # kernels may sum in another order on another machine, which moves ranks a little


def _metric(
    value: float | np.floating[Any], unit: str, better: str, tolerance: float | None = None
) -> Metric:
    if tolerance is None:
        tolerance = 0.0 if better == "equal" else round(_RELATIVE * abs(float(value)), 6)
    return {"value": round(float(value), 6), "unit": unit, "better": better, "tolerance": tolerance}


def of_scores(scores: Sequence[Score]) -> dict[str, Metric]:
    """Hits, ranks and average precision of each measure and protocol of an experiment. Times are not metrics."""
    found = {}
    for key in sorted({(s.experiment, s.protocol, s.measure) for s in scores}):
        mine = [s for s in scores if (s.experiment, s.protocol, s.measure) == key]
        name = f"{key[0]}/protocol {key[1]}/{key[2]}"
        one = 1 / len(mine)  # one query more or less
        found[f"{name}/hit10"] = _metric(
            np.mean([s.hit10 for s in mine]), "share of queries", "higher", round(one, 6)
        )
        found[f"{name}/hit5"] = _metric(
            np.mean([s.hit5 for s in mine]), "share of queries", "higher", round(one, 6)
        )
        found[f"{name}/average precision"] = _metric(
            np.mean([s.average_precision for s in mine]), "", "higher"
        )
        if key[1] == 1:
            found[f"{name}/rank of target"] = _metric(np.mean([s.rank for s in mine]), "mean rank", "lower")
    return found


def of_lengths(string: str, rows: Sequence[Mapping[str, str]]) -> dict[str, Metric]:
    """Length and jumps of a synthesised string."""
    found = {}
    for row in rows:
        length = row["unit"] == "frames"
        better = "equal" if length or "spliced" in row["quantity"] else "lower"
        tolerance = (
            1.0 if length else None if better == "lower" else round(_RELATIVE * float(row["value"]), 6)
        )
        found[f"{string}/{row['quantity']}"] = _metric(float(row["value"]), row["unit"], better, tolerance)
    return found


def of_corpus(
    corpus: str, takes: int, seconds: float, segments: int | None, intervals: int
) -> dict[str, Metric]:
    """How much a corpus holds."""
    found = {
        f"{corpus}/takes": _metric(takes, "takes", "equal"),
        f"{corpus}/seconds": _metric(seconds, "s", "equal", 0.01),
        f"{corpus}/intervals": _metric(intervals, "intervals", "equal"),
    }
    if segments is not None:
        found[f"{corpus}/segments"] = _metric(segments, "segments", "equal", round(_RELATIVE * segments, 2))
    return found


def of_segmentation(corpus: str, rows: Sequence[Mapping[str, str]]) -> dict[str, Metric]:
    """How well all cuts of a corpus agree with its bounds, by each method; rows as `segmentation.write_scores`."""
    return {
        f"{corpus}/segmentation/{row['method']}/{measure}": _metric(float(row[measure]), "", "higher")
        for row in rows
        if row["take"] == "all" and row["bounds"] != "0" and row["cuts"] != "0"
        for measure in ("precision", "recall")
    }


def write_metrics(path: str | os.PathLike[str], metrics: Mapping[str, Metric]) -> None:
    """Write metrics as JSON, sorted by name."""
    text = json.dumps({"metrics": dict(sorted(metrics.items()))}, indent=1, ensure_ascii=False)
    store.write_text(path, text + "\n")


def read_metrics(path: str | os.PathLike[str]) -> dict[str, Metric]:
    """Read metrics or a baseline.

    Raises
    ------
    InputError
        There is no such file, or it is no JSON of metrics.
    """
    try:
        with open(path, encoding="utf-8") as file:
            metrics: dict[str, Metric] = json.load(file)["metrics"]
        for name, metric in metrics.items():
            if (
                metric["better"] not in ("lower", "higher", "equal")
                or not np.isfinite([metric["value"], metric["tolerance"]]).all()
            ):
                raise InputError(f"{path}: metric {name!r} cannot be compared")
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file") from None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path}: is no file of metrics ({error})") from None
    return metrics


class Change(NamedTuple):
    """A metric now and in the baseline; the verdict is same, better, worse, changed, new or gone."""

    name: str
    was: float | None
    now: float | None
    tolerance: float
    verdict: str

    @property
    def bad(self) -> bool:
        """Fails the check."""
        return self.verdict in ("worse", "changed", "gone")


def compare(metrics: Mapping[str, Metric], baseline: Mapping[str, Metric]) -> list[Change]:
    """Metrics against a baseline, whose tolerances and directions count; by name."""
    found = []
    for name in sorted({*metrics, *baseline}):
        if name not in baseline:
            found.append(Change(name, None, metrics[name]["value"], 0.0, "new"))
        elif name not in metrics:
            found.append(Change(name, baseline[name]["value"], None, 0.0, "gone"))
        else:
            was, now = float(baseline[name]["value"]), float(metrics[name]["value"])
            tolerance, better = float(baseline[name]["tolerance"]), baseline[name]["better"]
            found.append(Change(name, was, now, tolerance, _verdict(now - was, tolerance, better)))
    return found


def _verdict(change: float, tolerance: float, better: str) -> str:
    if abs(change) <= tolerance + 1e-9:
        return "same"
    if better == "equal":
        return "changed"
    return "better" if (change < 0) == (better == "lower") else "worse"
