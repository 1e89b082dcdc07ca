"""Scores of an experiment → one of [P]'s tables, ours and the printed figures side by side."""

from miburi import job
from miburi.evaluate.protocols import read_scores
from miburi.evaluate.tables import table, write_table


def main(snakemake):
    p = snakemake.params
    write_table(snakemake.output[0], table(p.table, read_scores(snakemake.input.scores), p.seed))


job.run(main, snakemake)  # noqa: F821
