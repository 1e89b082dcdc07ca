"""Labels of a corpus of hands and the length of its string → [H]'s table 2, beside the printed one."""

import csv

from miburi import job
from miburi.evaluate.tables import label_counts, write_table
from miburi.formats.annotations import read_annotations


def main(snakemake):
    rows = read_annotations(snakemake.input.annotations)
    intervals = [(r.keyword, int(r.more["end_frame"]) - int(r.more["start_frame"])) for r in rows]
    with open(snakemake.input.lengths, encoding="utf-8", newline="") as file:
        lengths = list(csv.DictReader(file))
    kind = "simulated" if snakemake.params.simulated else "recorded"
    write_table(snakemake.output[0], label_counts(intervals, lengths, snakemake.params.string, kind))


job.run(main, snakemake)  # noqa: F821
