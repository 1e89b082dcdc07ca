"""Pieces of all takes of a corpus → how many are how long."""

import csv

from miburi import artefacts, job
from miburi.evaluate.segmentation import length_histogram, write_table


def main(snakemake):
    with open(snakemake.input.takes, encoding="utf-8", newline="") as file:
        fps = {row["take"]: float(row["fps"]) for row in csv.DictReader(file)}
    segments = [s for path in snakemake.input.segments for s in artefacts.read_segments(path)]
    rows = length_histogram([(end - start) / fps[take] for take, start, end in segments])
    write_table(snakemake.output[0], ("from_s", "to_s", "segments"), rows)


job.run(main, snakemake)  # noqa: F821
