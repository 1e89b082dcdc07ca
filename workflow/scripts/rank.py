"""Index and queries → what one measure ranks first, and how long it took."""

import csv
import time

import numpy as np

from miburi import artefacts, job, store
from miburi.evaluate.queries import left_out, read_queries
from miburi.evaluate.ranks import write_ranks
from miburi.retrieval.index import Index
from miburi.retrieval.ranking import ranking


def main(snakemake):
    index = Index.open(snakemake.input.index, *snakemake.input.models)
    segments = list(zip(index.take, index.start.tolist(), index.end.tolist(), strict=True))
    with open(snakemake.input.takes, encoding="utf-8", newline="") as file:
        subjects = {row["take"]: row["subject"] for row in csv.DictReader(file)}
    queries = read_queries(snakemake.input.table)
    features, _, _ = artefacts.read_features(snakemake.input.queries)
    measure, reduction = snakemake.wildcards.measure, snakemake.params.reduction
    index.distances(
        features[queries[0].query], measure, reduction=reduction
    )  # kernels are compiled and loaded
    orders, scores, seconds = [], [], []
    for query in job.progress(queries, "queries"):
        start = time.perf_counter()
        distance = index.distances(features[query.query], measure, reduction=reduction)
        found = ranking(np.where(left_out(query, segments, subjects), np.inf, distance))
        seconds.append(time.perf_counter() - start)
        orders.append(found.order)
        scores.append(found.score)
    write_ranks(
        snakemake.output[0],
        [q.query for q in queries],
        np.array(orders),
        np.array(scores),
        np.array(seconds),
        measure=measure,
        experiment=snakemake.wildcards.experiment,
        queries="simulated",
        sources=store.sources(*snakemake.input),
    )


job.run(main, snakemake)  # noqa: F821
