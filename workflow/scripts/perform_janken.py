"""The config's seed → logs, labels and calibration of a simulated glove wearer."""

from pathlib import Path

from miburi import job
from miburi.perform import janken


def main(snakemake):
    p = snakemake.params
    janken.write(Path(snakemake.output[0]).parent, p.seed, small=p.small)


job.run(main, snakemake)  # noqa: F821
