"""The config's seed → BVH of one performer's takes, or annotations of all takes of the simulated bodies."""

from pathlib import Path

from miburi import job
from miburi.formats.annotations import write_annotations
from miburi.perform import bodies


def main(snakemake):
    p = snakemake.params
    first = Path(snakemake.output[0])
    if p.takes:
        bodies.write(first.parent, p.seed, p.takes, small=p.small)
    else:
        write_annotations(first, bodies.annotate(bodies.plan(p.seed, small=p.small), p.seed))


job.run(main, snakemake)  # noqa: F821
