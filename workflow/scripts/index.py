"""Features of all shards → the index of a corpus's segments."""

from miburi import artefacts, job, store
from miburi.retrieval.index import Index


def main(snakemake):
    features, segments = [], []
    for path in snakemake.input:
        takes, pieces, _ = artefacts.read_features(path)
        place = {take: len(features) + i for i, take in enumerate(takes)}
        features += takes.values()
        segments += [(take, place[take], start, end) for take, start, end in pieces]
    p = snakemake.params
    index = Index.build(features, segments, dims=p.dims, samples=p.samples, seed=p.seed)
    index.save(snakemake.output[0], store.sources(*snakemake.input))


job.run(main, snakemake)  # noqa: F821
