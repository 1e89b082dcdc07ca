"""Intervals of a corpus of hands → how likely each is to a model that has not seen it, by states and covariance."""

import csv

from miburi import job, store
from miburi.hands import labelled_takes
from miburi.hmm import by_label, global_variance, leave_one_out
from miburi.render import plots


def main(snakemake):
    settings = dict(snakemake.params.settings)
    half = tuple(settings.pop("half"))
    takes, _ = labelled_takes(snakemake.input.motion, snakemake.input.annotations)
    reference = global_variance([x for x, _ in takes], half)
    found = leave_one_out(by_label(takes, half), reference, half=half, **settings)
    sums = {}
    for row in found:
        total = sums.setdefault((row.covariance, row.states), [0, 0, 0.0])
        for k, value in enumerate((row.intervals, row.frames, row.log_likelihood)):
            total[k] += value
    kind = "simulated" if snakemake.params.simulated else "recorded"
    rows = [("all", *key, *total) for key, total in sums.items()] + [tuple(row) for row in found]
    with (
        store.replaced(snakemake.output.table) as path,
        open(path, "w", encoding="utf-8", newline="") as file,
    ):
        table = csv.writer(file, lineterminator="\n")
        columns = ["label", "covariance", "states", "intervals", "frames"]
        table.writerow([*columns, "log_likelihood_per_frame", "recordings"])
        table.writerows((*row[:5], f"{row[5] / row[4]:.4f}", kind) for row in rows)
    curves = {}
    for (covariance, states), (_, frames, total) in sums.items():
        curves.setdefault(covariance, {})[states] = total / frames
    title = f"Intervals left out in turn, {kind}"
    plots.by_states(snakemake.output.plot, curves, ylabel="log-likelihood\nper frame", title=title)


job.run(main, snakemake)  # noqa: F821
