"""Pieces of takes and the bounds that a person set → precision and recall, beside chance."""

import csv

from miburi import artefacts, job
from miburi.evaluate import segmentation
from miburi.formats.annotations import read_annotations


def main(snakemake):
    p = snakemake.params
    with open(snakemake.input.takes, encoding="utf-8", newline="") as file:
        takes = {row["take"]: (float(row["fps"]), float(row["seconds"])) for row in csv.DictReader(file)}
    cuts = {}
    for path in snakemake.input.segments:
        for take, start, _ in artefacts.read_segments(path):
            cuts.setdefault(take, []).append(start)
    intervals = {}
    for row in read_annotations(snakemake.input.annotations):
        intervals.setdefault(row.take, []).append(row)
    counts = {}
    for take, how in sorted(p.bounded.items()):
        if take not in cuts:
            continue  # it was set aside
        fps, seconds = takes[take]
        if how["cut_points"]:
            human = segmentation.read_cut_points(how["cut_points"], fps)
        else:
            human = segmentation.bounds(intervals.get(take, []), seconds)
        inner = [start / fps for start in cuts[take] if start]
        counts[take, how["method"]] = segmentation.agreement(inner, human, seconds, p.seed)
    segmentation.write_scores(snakemake.output[0], counts, p.people)


job.run(main, snakemake)  # noqa: F821
