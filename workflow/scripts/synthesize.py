"""Models of labels → the motion of a string."""

import logging
import zlib
from pathlib import Path

from miburi import job, store
from miburi.hmm import Model, synthesize


def main(snakemake):
    models = {model.label: model for model in map(Model.open, snakemake.input.models)}
    words = Path(snakemake.input.words).read_text(encoding="utf-8")
    seed = [snakemake.params.seed, zlib.crc32(snakemake.wildcards.string.encode())]
    synthesis = synthesize(models, words, seed=seed, **snakemake.params.string)
    if synthesis.why_not:
        logging.warning("no global variance: %s", synthesis.why_not)
    if synthesis.lost is not None:
        logging.info("global variance costs %.3f of log-likelihood per frame", synthesis.lost)
    synthesis.save(snakemake.output[0], store.sources(*snakemake.input))


job.run(main, snakemake)  # noqa: F821
