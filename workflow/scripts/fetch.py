"""A subject of the CMU database → its skeleton and takes."""

import sys

from miburi import fetch, job


def main(snakemake):
    fetch.subject(
        snakemake.params.site, snakemake.params.subject, snakemake.output, progress=sys.stderr.isatty()
    )


job.run(main, snakemake)  # noqa: F821
