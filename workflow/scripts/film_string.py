"""A synthesised string → a film with its labels, and a contact sheet."""

from miburi import job
from miburi.hmm import Synthesis
from miburi.render.film import film
from miburi.render.sheets import rows, sheet


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input[0])
    settings, note = (
        snakemake.params.settings,
        ", from simulated recordings" if snakemake.params.simulated else "",
    )
    motion = synthesis.motion(snakemake.wildcards.string)
    edges = synthesis.boundaries / motion.fps
    captions = [(a, b, label + note) for a, b, label in zip(edges, edges[1:], synthesis.labels, strict=False)]
    film(
        snakemake.output.film,
        motion,
        fps=settings["fps"],
        width=settings["width"],
        height=settings["height"],
        captions=captions,
    )
    sheet(snakemake.output.sheet, motion, rows(motion, columns=settings["columns"]), captions=synthesis.label)


job.run(main, snakemake)  # noqa: F821
