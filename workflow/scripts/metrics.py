"""Scores, strings and corpora of a run → its metrics."""

import csv
from pathlib import Path

from miburi import job
from miburi.evaluate import metrics
from miburi.evaluate.protocols import read_scores
from miburi.formats.annotations import read_annotations
from miburi.retrieval.index import Index


def rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def main(snakemake):
    found = {}
    for path in snakemake.input.scores:
        found |= metrics.of_scores(read_scores(path))
    for path in snakemake.input.lengths:
        found |= metrics.of_lengths(Path(path).stem, rows(path))
    segments = {Path(path).parent.name: len(Index.open(path)) for path in snakemake.input.indices}
    for path, annotated in zip(snakemake.input.takes, snakemake.input.annotations, strict=True):
        corpus, takes = Path(path).parent.name, rows(path)
        seconds = sum(float(t["seconds"]) for t in takes)
        intervals = len(read_annotations(annotated))
        found |= metrics.of_corpus(corpus, len(takes), seconds, segments.get(corpus), intervals)
    for path in snakemake.input.agreements:
        found |= metrics.of_segmentation(Path(path).parent.name, rows(path))
    metrics.write_metrics(snakemake.output[0], found)


job.run(main, snakemake)  # noqa: F821
