"""Intervals of one label → its HMM with state durations."""

from miburi import job, store
from miburi.errors import InputError
from miburi.hands import labelled_takes
from miburi.hmm import by_label, global_variance, train


def main(snakemake):
    label, settings = snakemake.wildcards.label, dict(snakemake.params.settings)
    half = tuple(settings.pop("half"))
    takes, fps = labelled_takes(snakemake.input.motion, snakemake.input.annotations)
    intervals = by_label(takes, half)
    if label not in intervals:
        known = ", ".join(intervals)
        raise InputError(f"corpus {snakemake.wildcards.corpus!r} has no label {label!r}; it has {known}")
    reference = global_variance([x for x, _ in takes], half)
    model = train(intervals[label], label=label, half=half, fps=fps, reference=reference, **settings)
    model.save(snakemake.output[0], store.sources(*snakemake.input))


job.run(main, snakemake)  # noqa: F821
