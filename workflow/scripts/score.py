"""Ranks of all measures → one row for each query and measure."""

import csv

from miburi import job
from miburi.evaluate.protocols import score, write_scores
from miburi.evaluate.queries import keywords_of, read_queries, spans
from miburi.evaluate.ranks import read_ranks
from miburi.formats.annotations import read_annotations
from miburi.retrieval.index import Index


def main(snakemake):
    with open(snakemake.input.takes, encoding="utf-8", newline="") as file:
        fps = {row["take"]: float(row["fps"]) for row in csv.DictReader(file)}
    index = Index.open(snakemake.input.index)
    segments = list(zip(index.take, index.start.tolist(), index.end.tolist(), strict=True))
    keywords = keywords_of(segments, spans(read_annotations(snakemake.input.annotations), fps))
    queries = read_queries(snakemake.input.table)
    scores = [
        row
        for path in snakemake.input.ranks
        for row in score(read_ranks(path), queries, segments, keywords, str(path))
    ]
    write_scores(snakemake.output[0], scores)


job.run(main, snakemake)  # noqa: F821
