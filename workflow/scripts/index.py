"""Features of all shards → the index of a corpus's segments."""

from miburi import artefacts, job, store
from miburi.retrieval.index import Index


def main(snakemake):
    values, segments = {}, []
    for path in snakemake.input:
        takes, pieces, _ = artefacts.read_features(path)
        values |= takes
        segments += pieces
    # in the order of takes' names, so that shards of another size give the same index
    place = {take: i for i, take in enumerate(sorted(values))}
    features = [values[take] for take in place]
    segments = [(take, place[take], start, end) for take, start, end in sorted(segments)]
    p = snakemake.params
    index = Index.build(features, segments, dims=p.dims, samples=p.samples, seed=p.seed)
    index.save(snakemake.output[0], store.sources(*snakemake.input))


job.run(main, snakemake)  # noqa: F821
