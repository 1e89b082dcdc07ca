"""A string → its lengths with and without exit, by exact durations and by products; its jumps; a stream's errors."""

import csv

from miburi import job, store
from miburi.hands import labelled_takes
from miburi.hmm import Synthesis, by_label, delay_errors, global_variance, largest_step, lengths, splice

DELAYS = (0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32)


def write(path, header, rows):
    with store.replaced(path) as temporary, open(temporary, "w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        table.writerows(rows)


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input.synthesis)
    takes, fps = labelled_takes(snakemake.input.motion, snakemake.input.annotations)
    settings = {k: v for k, v in snakemake.params.settings.items() if k not in ("exit", "durations")}
    settings["half"] = tuple(settings["half"])
    string = synthesis.string
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
    if synthesis.lost is not None:
        rows.append(("log-likelihood per frame, lost to global variance", f"{synthesis.lost:.4f}", ""))
    write(snakemake.output.lengths, ["quantity", "value", "unit"], rows)
    errors = delay_errors(synthesis.mean, synthesis.variance, DELAYS, half=settings["half"])
    header = ["delay_frames", "delay_s", "largest_error_degrees", "rms_error_degrees"]
    write(
        snakemake.output.delays,
        header,
        [(e.delay, f"{e.delay / fps:.3f}", f"{e.largest:.3g}", f"{e.rms:.3g}") for e in errors],
    )


job.run(main, snakemake)  # noqa: F821
