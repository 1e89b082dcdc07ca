"""The config's seed → BVH and annotations of simulated bodies."""

from pathlib import Path

from miburi import job
from miburi.perform import bodies


def main(snakemake):
    p = snakemake.params
    bodies.write(Path(snakemake.output[0]).parent, p.seed, small=p.small)


job.run(main, snakemake)  # noqa: F821
