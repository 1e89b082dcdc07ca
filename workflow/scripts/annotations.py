"""Motion and annotation files of a corpus → a table of its takes, and what happens in them."""

import csv
import logging

from miburi import artefacts, job, store
from miburi.formats.annotations import write_annotations
from miburi.formats.plausibility import suspected_fps
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
    joints = {t.name: reading["groups"][t.group]["joints"] for t in takes}
    lengths, suspected = {}, {}
    for path in snakemake.input.motion:
        lengths |= artefacts.read_lengths(path)
        if reading["kind"] == "body":
            for name, motion in artefacts.read_motions(path).items():
                suspected[name] = suspected_fps(motion, joints[name])
                if suspected[name]:
                    logging.warning("%s falls as at %g frames/s", name, suspected[name])
    annotate = annotate_hand if reading["kind"] == "hand" else annotate_bodies
    write_annotations(snakemake.output.annotations, annotate(takes, reading["groups"], lengths))
    rows = []
    for t in takes:
        if t.name in lengths:
            frames, fps = lengths[t.name]
            doubt = suspected.get(t.name) or ""
            rows.append((t.name, t.subject, frames, fps, round(frames / fps, 3), t.recording, doubt))
    header = ["take", "subject", "frames", "fps", "seconds", "recording", "suspected_fps"]
    write_table(snakemake.output.takes, header, rows)
    skipped = []
    for path in snakemake.input.motion:
        with open(path.replace(".h5", "_skipped.csv"), encoding="utf-8", newline="") as file:
            skipped += list(csv.reader(file))[1:]
    write_table(snakemake.output.skipped, ["take", "recording", "reason"], sorted(skipped))


job.run(main, snakemake)  # noqa: F821
