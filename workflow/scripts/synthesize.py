"""Models of labels, or what they are trained on → the motion of a string."""

import logging
import zlib
from pathlib import Path

from miburi import job, store
from miburi.hands import labelled_takes
from miburi.hmm import Model, synthesize, train_labels
from miburi.strings import label_of


def main(snakemake):
    found, training = snakemake.input, snakemake.params.training
    words = Path(found.words).read_text(encoding="utf-8")
    if training is None:
        models = {model.label: model for model in map(Model.open, found.models)}
    else:
        takes, fps = labelled_takes(found.motion, found.annotations)
        models = train_labels(takes, map(label_of, words.split()), fps=fps, **training)
    seed = [snakemake.params.seed, zlib.crc32(snakemake.wildcards.string.encode())]
    synthesis = synthesize(models, words, seed=seed, **snakemake.params.string)
    if synthesis.why_not:
        logging.warning("no global variance: %s", synthesis.why_not)
    if synthesis.lost is not None:
        logging.info("global variance costs %.3f of log-likelihood per frame", synthesis.lost)
    synthesis.save(snakemake.output[0], store.sources(*found))


job.run(main, snakemake)  # noqa: F821
