"""Recordings of a shard → motion. A damaged one stops the job, or is set aside where the config says so."""

import csv
import logging

from miburi import artefacts, job, store
from miburi.errors import InputError
from miburi.recordings import read_take
from miburi.takes import Take


def main(snakemake):
    reading, skip = snakemake.params.reading, snakemake.params.on_error == "skip"
    motions, recordings, skipped = {}, {}, []
    for name, subject, path, group in job.progress(reading["takes"], "takes"):
        try:
            motions[name] = read_take(Take(name, subject, path, group, 0.0), reading["groups"][group])
            recordings[name] = path
        except InputError as error:
            if not skip:
                raise
            logging.warning("set aside: %s", error)
            skipped.append((name, path, str(error)))
    artefacts.write_motions(snakemake.output.motion, motions, recordings, store.sources(*snakemake.input))
    with (
        store.replaced(snakemake.output.skipped) as path,
        open(path, "w", encoding="utf-8", newline="") as file,
    ):
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["take", "recording", "reason"])
        table.writerows(skipped)


job.run(main, snakemake)  # noqa: F821
