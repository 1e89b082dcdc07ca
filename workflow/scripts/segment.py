"""Motion → the pieces of each take: by PPCA segmentation, or the whole take where the config says so."""

import numpy as np

from miburi import artefacts, job, store
from miburi.retrieval.segmentation import pieces, segment


def main(snakemake):
    settings = dict(snakemake.params.settings)
    shortest = settings.pop("shortest_s")
    cut, joints = snakemake.params.cut, snakemake.params.joints
    found = {}
    for take, motion in job.progress(artefacts.read_motions(snakemake.input[0]).items(), "takes"):
        frames = len(motion)
        if cut[take] == "whole":
            cuts = np.array([], dtype=np.int64)
        else:
            cuts = segment(motion, method=cut[take], joints=joints.get(take), **settings)
        found[take] = pieces(cuts, frames, round(shortest * motion.fps))
    artefacts.write_segments(
        snakemake.output[0], found, cut, snakemake.params.settings, store.sources(*snakemake.input)
    )


job.run(main, snakemake)  # noqa: F821
