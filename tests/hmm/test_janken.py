"""The paper's experiment on the simulated glove wearer's recordings, and on the real glove's."""

from pathlib import Path

import numpy as np
import pytest

from miburi import InputError, formats
from miburi.hmm import by_label, global_variance, largest_step, lengths, splice, synthesize, train
from miburi.perform import janken

GLOVES = Path(__file__).parents[2] / "config/gloves"
STRING = "r rs s sp p pr r rp p ps s sr r"  # [H]: a succession that no recording contains


@pytest.fixture(scope="module")
def takes(tmp_path_factory):
    """Angles and labels of the three recordings, read from their logs."""
    folder = tmp_path_factory.mktemp("janken")
    janken.write(folder, 0)
    found = []
    for take in janken.RECORDINGS:
        motion = formats.read(folder / f"{take}.csv")
        intervals = formats.read_labels(folder / f"{take}.lab", fps=motion.fps, frames=len(motion))
        found.append((motion.angles, intervals))
    return found


@pytest.fixture(scope="module")
def models(takes):
    reference = global_variance([x for x, _ in takes])
    return {s: train(x, label=s, reference=reference, fps=30.0) for s, x in by_label(takes).items()}


def test_nine_models_of_all_frames(models):
    assert sorted(models) == sorted(janken.COUNTS)
    for label, (frames, intervals) in janken.COUNTS.items():
        model = models[label]
        assert (model.frames, model.intervals, model.left_out) == (frames, intervals, 0)
        assert model.duration_mean.sum() == pytest.approx(frames / intervals)
        assert (np.diff(model.log_likelihood) > -1e-9 * np.abs(model.log_likelihood[-1])).all()


def test_the_string_lasts_as_long_as_table_2_says(models):
    exact = sum(frames / intervals for frames, intervals in (janken.COUNTS[s] for s in STRING.split()))
    assert exact == pytest.approx(219.5, abs=0.1)
    assert abs(len(synthesize(models, STRING)) - 219.5) <= 5


def test_lengths_with_and_without_an_exit(takes):
    reference = global_variance([x for x, _ in takes])
    found = {(exits, form): n for exits, form, n in lengths(by_label(takes), STRING, reference=reference)}
    assert all(abs(found[True, form] - 219.5) <= 5 for form in ("exact", "product"))
    # a hold that ends before its last state does not count there: the states' means add up to more
    assert all(225 < found[False, form] <= 340 for form in ("exact", "product"))


def test_the_generated_hand_shows_what_the_labels_say(models):
    """Of each hold's middle: a fist is bent, an open hand straight, scissors bend ring and little finger."""
    made = synthesize(models, STRING)
    hand = made.motion().skeleton
    bend = {f: made.trajectory[:, 3 * hand.index(f"{f}2") + 1] for f in ("index", "middle", "ring", "little")}
    for label, start, end in zip(made.labels, made.boundaries, made.boundaries[1:], strict=False):
        shape = {f: x[(start + end) // 2] > 50 for f, x in bend.items()}
        if label == "r":
            assert all(shape.values())
        elif label == "p":
            assert not any(shape.values())
        elif label == "s":
            assert shape == {"index": False, "middle": False, "ring": True, "little": True}


def test_joins_step_in_the_splice_alone(takes, models):
    made, cut = synthesize(models, STRING), splice(by_label(takes, None), STRING)
    generated = largest_step(made.trajectory, made.boundaries)
    assert largest_step(cut.trajectory, cut.boundaries) > 3 * generated
    assert generated < largest_step(takes[0][0])  # smoother than the recordings are anywhere


def test_the_real_glove(recordings):
    """Few intervals, dead sensors, neither rs nor sr: models say what they learnt from."""
    folder = recordings / "hand/cyberglove_rps"
    motion = formats.glove.read_columns(folder / "mock.txt.gz", GLOVES / "cyberglove_rps.yaml")
    rows = np.loadtxt(folder / "labels_exclusive.tsv", dtype=str, skiprows=1)
    takes = [(motion.angles, [(int(s), int(e), label) for s, e, label in rows])]
    reference = global_variance([motion.angles])
    models = {s: train(x, label=s, reference=reference, fps=24.0) for s, x in by_label(takes).items()}
    assert {s: m.intervals for s, m in models.items()} == {
        "p": 7, "r": 5, "s": 2, "pr": 5, "rp": 4, "ps": 2, "sp": 2,
    }  # fmt: skip
    still = 3 * int((motion.angles.min(axis=0) == motion.angles.max(axis=0)).sum())
    assert still > 0 and all(m.constant == still for m in models.values())
    string = "r rp p ps s sp p pr r"
    made = synthesize(models, string)
    exact = sum(m.frames / m.intervals for m in (models[s] for s in string.split()))
    assert abs(len(made) - exact) <= 0.5 * 3 * 9
    low, high = motion.angles.min(axis=0), motion.angles.max(axis=0)
    margin = 0.25 * (high - low) + 1e-9
    assert ((made.trajectory > low - margin) & (made.trajectory < high + margin)).all()
    with pytest.raises(InputError, match="label 2 is 'rs', known are p, pr, ps, r, rp, s, sp"):
        synthesize(models, "r rs s")
