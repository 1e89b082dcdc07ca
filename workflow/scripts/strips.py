"""A synthesised string → [H]'s figure 6: strips of its changes."""

from miburi import job
from miburi.hmm import Synthesis
from miburi.render.sheets import changes, sheet


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input[0])
    strips = changes(synthesis.labels, synthesis.boundaries, snakemake.params.changes)
    if snakemake.params.simulated:
        strips = [s._replace(title=f"{s.title}, from simulated recordings") for s in strips]
    sheet(snakemake.output[0], synthesis.motion(), strips, captions=synthesis.label)


job.run(main, snakemake)  # noqa: F821
