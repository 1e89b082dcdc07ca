"""A synthesised string and the recordings → [H]'s figures 4 and 5 of one angle, and the staircase under it."""

from miburi import job
from miburi.hands import angle_of, labelled_takes
from miburi.hmm import Synthesis, by_label, splice
from miburi.render import plots


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input.synthesis)
    takes, fps = labelled_takes(snakemake.input.motion, snakemake.input.annotations)
    column, words = angle_of(snakemake.params.angle)
    spliced = splice(by_label(takes, None), synthesis.string)
    x, pieces = synthesis.trajectory[:, column], spliced.trajectory[:, column]
    kind = "simulated" if snakemake.params.simulated else "recorded"
    ylabel, title = f"{words} (degrees)", f"Generated from {kind} intervals"
    string = synthesis.boundaries, synthesis.labels, fps
    plots.curve(snakemake.output.fig4, x, *string, ylabel=ylabel, title=title)
    plots.spliced(
        snakemake.output.fig5,
        pieces,
        spliced.boundaries,
        spliced.labels,
        fps,
        generated=x,
        generated_boundaries=synthesis.boundaries,
        ylabel=ylabel,
        title=f"The same labels cut from {kind} intervals and put end to end",
        source=kind,
    )
    mean, variance = synthesis.mean[:, column], synthesis.variance[:, column]
    plots.staircase(snakemake.output.staircase, x, mean, variance, *string, ylabel=ylabel, title=title)


job.run(main, snakemake)  # noqa: F821
