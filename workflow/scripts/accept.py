"""Metrics of this run → the baseline that later runs are compared with."""

from miburi import job
from miburi.errors import InputError
from miburi.evaluate.metrics import read_metrics, write_metrics


def main(snakemake):
    path = snakemake.params.baseline
    if not path:
        raise InputError("config: baseline names no file to write")
    write_metrics(path, read_metrics(snakemake.input[0]))


job.run(main, snakemake)  # noqa: F821
