"""Intervals of one label → its HMM with state durations."""

from miburi import job, store
from miburi.hands import labelled_takes
from miburi.hmm import train_labels


def main(snakemake):
    label, found = snakemake.wildcards.label, snakemake.input
    takes, fps = labelled_takes(found.motion, found.annotations)
    models = train_labels(takes, [label], fps=fps, **snakemake.params.settings)
    models[label].save(snakemake.output[0], store.sources(*found))


job.run(main, snakemake)  # noqa: F821
