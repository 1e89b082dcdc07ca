"""An index → the GP-LVM of each of its segments."""

from miburi import job, store
from miburi.retrieval.index import Index
from miburi.retrieval.latent import Settings


def main(snakemake):
    index = Index.open(snakemake.input[0]).trained(Settings(**snakemake.params.settings))
    index.models.save(snakemake.output[0], store.sources(snakemake.input[0]))


job.run(main, snakemake)  # noqa: F821
