"""A synthesised string → a film with its labels (MP4 or animated WebP), and a contact sheet if one is wanted."""

from miburi import job
from miburi.hmm import Synthesis
from miburi.render.film import film
from miburi.render.sheets import rows, sheet


def main(snakemake):
    synthesis = Synthesis.open(snakemake.input[0])
    settings = snakemake.params.settings
    motion = synthesis.motion(snakemake.wildcards.string)
    kind = "simulated" if snakemake.params.simulated else "recorded"
    title = f"{synthesis.string} (generated from {kind} intervals)"
    edges = synthesis.boundaries / motion.fps
    captions = list(zip(edges[:-1], edges[1:], synthesis.labels, strict=True))
    film(
        snakemake.output[0],
        motion,
        fps=settings["fps"],
        width=settings["width"],
        height=settings["height"],
        title=title,
        captions=captions,
    )
    if "sheet" in snakemake.output.keys():  # noqa: SIM118 (Snakemake's list of files has names)
        strips = rows(motion, columns=settings["columns"])
        sheet(snakemake.output.sheet, motion, strips, title=title, captions=synthesis.label)


job.run(main, snakemake)  # noqa: F821
