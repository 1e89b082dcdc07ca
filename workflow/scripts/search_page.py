"""A ranking, its log and the corpus → a page that plays what was found."""

from miburi import job, store
from miburi.formats import puppet
from miburi.report.search import page
from miburi.retrieval.body import features, reset_angles


def main(snakemake):
    given, p = snakemake.input, snakemake.params
    query = reset_angles(
        features(puppet.read(given.log), **p.settings), angle_weight=p.settings["angle_weight"]
    )
    about = {"simulated": p.simulated}
    text = page(given.table, given.log, given.index, list(given.motion), query, about)
    store.write_text(snakemake.output[0], text)


job.run(main, snakemake)  # noqa: F821
