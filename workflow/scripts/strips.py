"""A synthesised string → [H]'s figure 6: strips of its changes."""

from miburi import job
from miburi.hmm import Synthesis
from miburi.render.sheets import changes, sheet


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input[0])
    strips = changes(synthesis.labels, synthesis.boundaries, snakemake.params.changes)
    kind = "simulated" if snakemake.params.simulated else "recorded"
    title = f"Changes of the hand, generated from {kind} intervals"
    sheet(snakemake.output[0], synthesis.motion(), strips, title=title, captions=synthesis.label)


job.run(main, snakemake)  # noqa: F821
