"""Annotated segments → what simulated users play with the puppet, as puppet logs."""

import csv
from pathlib import Path

from miburi import artefacts, job
from miburi.evaluate.queries import plan_queries, spans, write_queries
from miburi.formats import puppet
from miburi.formats.annotations import read_annotations
from miburi.perform.bodies import imagine
from miburi.perform.puppeteer import imitate, users


def main(snakemake):
    name, seed, wanted = snakemake.wildcards.experiment, snakemake.params.seed, snakemake.params.experiment
    with open(snakemake.input.takes, encoding="utf-8", newline="") as file:
        takes = {row["take"]: row for row in csv.DictReader(file)}
    fps = {take: float(row["fps"]) for take, row in takes.items()}
    subjects = {take: row["subject"] for take, row in takes.items()}
    segments = sorted(s for path in snakemake.input.segments for s in artefacts.read_segments(path))
    players = {u.name: u for u in users(name, wanted["split"], wanted["users"], seed)}
    queries = plan_queries(
        name,
        wanted["protocols"],
        wanted["keywords"],
        list(players.values()),
        segments,
        spans(read_annotations(snakemake.input.annotations), fps),
        subjects,
        imagined=wanted["imagined"],
        seed=seed,
    )
    motions = {}
    for path in snakemake.input.motion:
        here = {q.take for q in queries} & set(artefacts.read_lengths(path))
        motions |= artefacts.read_motions(path, sorted(here)) if here else {}
    logs = Path(snakemake.output.logs)
    logs.mkdir(parents=True)
    for q in job.progress(queries, "queries"):
        clip = motions[q.take][q.start : q.end] if q.take else imagine(q.keyword, f"{seed}-{q.query}")
        angles, rate = imitate(clip, players[q.user], seed_parts=(seed, q.query))
        puppet.write_log(logs / f"{q.query}.csv", angles, rate, simulated=True)
    write_queries(snakemake.output.table, queries)


job.run(main, snakemake)  # noqa: F821
