"""What was run: settings, versions, sources, times, and metrics beside the baseline."""

from __future__ import annotations

import csv
import json
import math
import os
import platform
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

import h5py
import yaml

import miburi
from miburi.evaluate.metrics import compare, read_metrics
from miburi.report.page import Table

_PACKAGES = ("numpy", "scipy", "numba", "h5py", "snakemake", "pyrender", "matplotlib", "pydantic")
File = str | os.PathLike[str]


def versions() -> list[tuple[str, str]]:
    """Names and versions of what computed the results."""
    found = [("miburi", miburi.__version__), ("Python", platform.python_version())]
    for name in _PACKAGES:
        try:
            found.append((name, metadata.version(name)))
        except metadata.PackageNotFoundError:
            continue
    return found


def settings(config: Mapping[str, Any]) -> str:
    """The config that was run, with its defaults, as YAML."""
    return yaml.safe_dump(dict(config), sort_keys=False, allow_unicode=True, width=100)


def recordings(motions: Sequence[File]) -> Table:
    """Recordings that motion artefacts were made from, and their digests."""
    found: dict[str, str] = {}
    for path in motions:
        with h5py.File(path, "r", locking=False) as file:
            found |= json.loads(file.attrs["sources"])
    rows = tuple((name, digest[:16]) for name, digest in sorted(found.items()))
    return Table(("recording", "sha256 (first 16 digits)"), rows)


def benchmarks(folder: File) -> Table:
    """Seconds and memory of the jobs of each rule, from Snakemake's benchmark files; empty where there are none."""
    jobs: dict[str, list[tuple[float, float]]] = {}
    for path in sorted(Path(folder).rglob("*.tsv")):
        with open(path, encoding="utf-8", newline="") as file:
            for row in csv.DictReader(file, delimiter="\t"):
                rule = path.relative_to(folder).parts[0]
                jobs.setdefault(rule, []).append((_number(row.get("s")), _number(row.get("max_rss"))))
    rows = []
    for rule, found in jobs.items():
        seconds, memory = [s for s, _ in found], [m for _, m in found if not math.isnan(m)]
        rows.append(
            (
                rule,
                str(len(found)),
                f"{sum(seconds):.1f}",
                f"{max(seconds):.1f}",
                f"{max(memory):.0f}" if memory else "",
            )
        )
    rows.sort(key=lambda r: -float(r[2]))
    return Table(("stage", "jobs", "seconds_in_all", "longest_s", "memory_MB"), tuple(rows))


def _number(text: str | None) -> float:
    try:
        return float(text or "nan")
    except ValueError:
        return math.nan


def changes(metrics: File, baseline: File | None) -> Table:
    """Metrics of the run beside the baseline's; those that moved come first."""
    now = read_metrics(metrics)
    was = read_metrics(baseline) if baseline and Path(baseline).exists() else {}
    found = sorted(compare(now, was), key=lambda c: (c.verdict == "same", c.name))
    rows = tuple(
        (
            c.name,
            _shown(c.now),
            _shown(c.was),
            str((now.get(c.name) or was[c.name])["unit"]),
            f"{c.tolerance:.3g}" if c.was is not None else "",
            c.verdict if was else "",
        )
        for c in found
    )
    head = tuple(r for r in rows if r[5] not in ("same", ""))
    return Table(("metric", "now", "baseline", "unit", "tolerance", "verdict"), rows, head)


def _shown(value: float | None) -> str:
    return "" if value is None else f"{value:.4g}"
