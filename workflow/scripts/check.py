"""Metrics against the committed baseline: a table of what moved; fails where something is worse."""

import os
import sys

from rich.console import Console
from rich.table import Table

from miburi import job
from miburi.errors import InputError
from miburi.evaluate.metrics import compare, read_metrics


def shown(value):
    return "" if value is None else f"{value:.4g}"


def main(snakemake):
    path = snakemake.params.baseline
    if not path:
        raise InputError("config: baseline names no file to compare with")
    if not os.path.exists(path):
        raise InputError(
            f"{path}: there is no baseline yet; `snakemake accept` makes this run's metrics the baseline"
        )
    changes = compare(read_metrics(snakemake.input[0]), read_metrics(path))
    moved = [c for c in changes if c.verdict != "same"]
    table = Table(
        "metric", "was", "now", "tolerance", "verdict", title=f"{len(changes)} metrics, {len(moved)} moved"
    )
    for c in moved:
        table.add_row(c.name, shown(c.was), shown(c.now), shown(c.tolerance), c.verdict)
    Console(file=sys.stderr).print(table)
    worst = [c for c in changes if c.bad]
    if worst:
        first = worst[0]
        raise InputError(
            f"{len(worst)} metrics are worse than in {path}, such as {first.name}: {shown(first.was)} → "
            f"{shown(first.now)} ({first.verdict}); if that is meant, `snakemake accept`"
        )


job.run(main, snakemake)  # noqa: F821
