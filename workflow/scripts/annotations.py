"""Motion and annotation files of a corpus → a table of its takes, and what happens in them."""

import csv

from miburi import artefacts, job, store
from miburi.formats.annotations import write_annotations
from miburi.recordings import annotate_bodies, annotate_hand
from miburi.takes import Take


def write_table(path, header, rows):
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)


def main(snakemake):
    reading = snakemake.params.reading
    takes = [Take(*row, 0.0) for row in reading["takes"]]
    lengths = {}
    for path in snakemake.input.motion:
        lengths |= artefacts.read_lengths(path)
    annotate = annotate_hand if reading["kind"] == "hand" else annotate_bodies
    write_annotations(snakemake.output.annotations, annotate(takes, reading["groups"], lengths))
    rows = [
        (t.name, t.subject, *lengths[t.name], round(lengths[t.name][0] / lengths[t.name][1], 3), t.recording)
        for t in takes
        if t.name in lengths
    ]
    write_table(snakemake.output.takes, ["take", "subject", "frames", "fps", "seconds", "recording"], rows)
    skipped = []
    for path in snakemake.input.motion:
        with open(path.replace(".h5", "_skipped.csv"), encoding="utf-8", newline="") as file:
            skipped += list(csv.reader(file))[1:]
    write_table(snakemake.output.skipped, ["take", "recording", "reason"], sorted(skipped))


job.run(main, snakemake)  # noqa: F821
