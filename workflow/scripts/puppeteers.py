"""Logs of another origin and development users who imitate the same clips → the ranks that both get."""

from miburi import artefacts, job
from miburi.evaluate.puppeteers import compare, read_targets, write_comparison
from miburi.perform.puppeteer import users
from miburi.retrieval.index import Index


def main(snakemake):
    p = snakemake.params
    targets = read_targets(snakemake.input.targets, p.compared["target"])
    clips = {}
    for path in snakemake.input.motion:
        here = {t.take for t in targets} & set(artefacts.read_lengths(path))
        clips |= artefacts.read_motions(path, sorted(here)) if here else {}
    rows = compare(
        Index.open(snakemake.input.index),
        targets,
        dict(zip(p.compared["queries"], snakemake.input.logs, strict=True)),
        clips,
        users(p.compared["experiment"], "development", p.compared["users"], p.seed),
        measures=p.compared["measures"],
        reduction=p.reduction,
        settings=p.settings,
        simulated=p.compared["simulated"],
        seed=p.seed,
    )
    write_comparison(snakemake.output[0], rows)


job.run(main, snakemake)  # noqa: F821
