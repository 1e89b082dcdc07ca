"""Motion and segments → the 42 values of each frame."""

from miburi import artefacts, job, store
from miburi.retrieval.body import features, reset_angles


def main(snakemake):
    segments = artefacts.read_segments(snakemake.input.segments)
    joints, settings = snakemake.params.joints, snakemake.params.settings
    values, fps = {}, {}
    for take, motion in artefacts.read_motions(snakemake.input.motion).items():
        x = features(motion, joints.get(take), **settings)
        pieces = [(start, end) for name, start, end in segments if name == take]
        values[take] = reset_angles(x, pieces, angle_weight=settings["angle_weight"])
        fps[take] = motion.fps
    artefacts.write_features(snakemake.output[0], values, segments, fps, store.sources(*snakemake.input))


job.run(main, snakemake)  # noqa: F821
