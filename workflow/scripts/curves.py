"""A synthesised string and the recordings → [H]'s figures 4 and 5: the middle finger's third joint."""

from miburi import job
from miburi.figures import HAND
from miburi.hands import labelled_takes
from miburi.hmm import Synthesis, by_label, splice
from miburi.render import plots

FLEXION = 3 * HAND.index("middle3") + 1
YLABEL = "middle finger,\nthird joint (degrees)"


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input.synthesis)
    takes, fps = labelled_takes(snakemake.input.motion, snakemake.input.annotations)
    spliced = splice(by_label(takes, None), synthesis.string)
    x, pieces = synthesis.trajectory[:, FLEXION], spliced.trajectory[:, FLEXION]
    kind = "simulated" if snakemake.params.simulated else "recorded"
    plots.curve(
        snakemake.output.fig4,
        x,
        synthesis.boundaries,
        synthesis.labels,
        fps,
        ylabel=YLABEL,
        title=f"Generated from {kind} intervals",
    )
    plots.spliced(
        snakemake.output.fig5,
        pieces,
        spliced.boundaries,
        spliced.labels,
        fps,
        generated=x,
        generated_boundaries=synthesis.boundaries,
        ylabel=YLABEL,
        title=f"The same labels cut from {kind} intervals and put end to end",
        source=kind,
    )


job.run(main, snakemake)  # noqa: F821
