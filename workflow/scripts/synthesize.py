"""Models of labels → the motion of a string."""

from miburi import job, store
from miburi.hmm import Model, synthesize


def main(snakemake):
    models = {model.label: model for model in map(Model.open, snakemake.input)}
    string = snakemake.params.string
    synthesis = synthesize(models, string["labels"], rho=string["rho"], length=string["length"])
    synthesis.save(snakemake.output[0], store.sources(*snakemake.input))


job.run(main, snakemake)  # noqa: F821
