"""A string → its length with and without exit, by exact durations and by products; its largest jumps."""

import csv

from miburi import job, store
from miburi.hands import labelled_takes
from miburi.hmm import Synthesis, by_label, global_variance, largest_step, lengths, splice


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input.synthesis)
    takes, fps = labelled_takes(snakemake.input.motion, snakemake.input.annotations)
    settings = {k: v for k, v in snakemake.params.settings.items() if k not in ("exit", "durations")}
    settings["half"] = tuple(settings["half"])
    string = snakemake.params.string["labels"]
    intervals = by_label(takes, settings["half"])
    reference = global_variance([x for x, _ in takes], settings["half"])
    rows = [
        (f"length, {'exit' if exits else 'no exit'}, {form}", frames, "frames")
        for exits, form, frames in lengths(intervals, string, fps=fps, reference=reference, **settings)
    ]
    spliced = splice(by_label(takes, None), string)
    rows += [
        ("length, this run", len(synthesis), "frames"),
        ("length, spliced", len(spliced.trajectory), "frames"),
        ("largest jump, generated", f"{largest_step(synthesis.trajectory):.4f}", "degrees"),
        (
            "largest jump at joins, generated",
            f"{largest_step(synthesis.trajectory, synthesis.boundaries):.4f}",
            "degrees",
        ),
        ("largest jump, spliced", f"{largest_step(spliced.trajectory):.4f}", "degrees"),
        (
            "largest jump at joins, spliced",
            f"{largest_step(spliced.trajectory, spliced.boundaries):.4f}",
            "degrees",
        ),
    ]
    with store.replaced(snakemake.output[0]) as path, open(path, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["quantity", "value", "unit"])
        table.writerows(rows)


job.run(main, snakemake)  # noqa: F821
