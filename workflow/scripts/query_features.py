"""Puppet logs → the 42 values of each frame; each log is one segment."""

from pathlib import Path

from miburi import artefacts, job, store
from miburi.evaluate.queries import read_queries
from miburi.formats import puppet
from miburi.retrieval.body import features, reset_angles


def main(snakemake):
    values, fps, segments = {}, {}, []
    logs = {
        q.query: Path(snakemake.input.logs) / f"{q.query}.csv" for q in read_queries(snakemake.input.table)
    }
    for query, path in sorted(logs.items()):
        motion = puppet.read(path)
        x = features(motion, **snakemake.params.settings)
        values[query] = reset_angles(x, angle_weight=snakemake.params.settings["angle_weight"])
        fps[query] = motion.fps
        segments.append((query, 0, len(motion)))
    sources = store.sources(snakemake.input.table, *logs.values())
    artefacts.write_features(snakemake.output[0], values, segments, fps, sources)


job.run(main, snakemake)  # noqa: F821
