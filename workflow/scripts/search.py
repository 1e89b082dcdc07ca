"""A puppet log and an index → the segments of a corpus, nearest first."""

import csv

from miburi import job, store
from miburi.formats import puppet
from miburi.retrieval.body import features, reset_angles
from miburi.retrieval.index import Index


def main(snakemake):
    index = Index.open(snakemake.input.index, *snakemake.input.models)
    with open(snakemake.input.takes, encoding="utf-8", newline="") as file:
        fps = {row["take"]: float(row["fps"]) for row in csv.DictReader(file)}
    p, log = snakemake.params, snakemake.input.log
    x = reset_angles(features(puppet.read(log), **p.settings), angle_weight=p.settings["angle_weight"])
    found = index.rank(x, p.measure, reduction=p.reduction)
    queries = "simulated" if p.simulated or puppet.is_simulated(log) else "recorded"
    with store.replaced(snakemake.output[0]) as path, open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["rank", "take", "start_s", "end_s", "score", "measure", "queries"])
        for rank, (i, score) in enumerate(zip(found.order, found.score, strict=True), 1):
            take = index.take[i]
            start, end = index.start[i] / fps[take], index.end[i] / fps[take]
            table.writerow([rank, take, f"{start:.3f}", f"{end:.3f}", f"{score:.6g}", p.measure, queries])


job.run(main, snakemake)  # noqa: F821
