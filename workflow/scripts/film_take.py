"""A take → a film and a contact sheet."""

from miburi import artefacts, job
from miburi.render.film import film
from miburi.render.sheets import rows, sheet


def main(snakemake):
    take, start_s, end_s = snakemake.params.stretch
    settings = snakemake.params.settings
    motion = artefacts.read_motions(snakemake.input[0], [take])[take]
    end = len(motion) if end_s is None else min(round(end_s * motion.fps), len(motion))
    motion = motion[round(start_s * motion.fps) : end]
    title = f"{take} (a simulated person)" if snakemake.params.simulated else take
    film(
        snakemake.output.film,
        motion,
        fps=settings["fps"],
        width=settings["width"],
        height=settings["height"],
        title=title,
    )
    sheet(snakemake.output.sheet, motion, rows(motion, columns=settings["columns"]), title=title)


job.run(main, snakemake)  # noqa: F821
