"""A string as it was recorded, as recordings put end to end, and as it is generated → a film."""

from itertools import pairwise

from miburi import job
from miburi.hands import labelled_takes, longest_match
from miburi.hmm import Synthesis, by_label, splice
from miburi.hmm.synthesis import hand_motion
from miburi.render.film import film


def spans(boundaries, labels, fps):
    return [(a / fps, b / fps, label) for (a, b), label in zip(pairwise(boundaries), labels, strict=True)]


def main(snakemake):
    given, p = snakemake.input, snakemake.params
    synthesis = Synthesis.open(given.synthesis)
    takes, fps = labelled_takes(given.motion, given.annotations)
    spliced = splice(by_label(takes, None), synthesis.string)
    longest = max(len(synthesis), len(spliced.trajectory))
    recorded, intervals = longest_match(takes, synthesis.labels)
    kind = "simulated" if p.simulated else "recorded"
    film(
        snakemake.output[0],
        [hand_motion(x, fps) for x in (recorded[:longest], spliced.trajectory, synthesis.trajectory)],
        fps=p.settings["fps"],
        width=round(p.settings["width"] * 0.75) * 2,
        height=p.settings["height"],
        title=f"{synthesis.string} ({kind} hand)",
        names=[f"one {kind} take", "put end to end", "generated"],
        own_captions=[
            [(a / fps, b / fps, label) for a, b, label in intervals],
            spans(spliced.boundaries, spliced.labels, fps),
            spans(synthesis.boundaries, synthesis.labels, fps),
        ],
    )


job.run(main, snakemake)  # noqa: F821
