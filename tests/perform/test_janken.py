"""The simulated glove wearer: counts as printed, a hand's poses, fingers of their own."""

from __future__ import annotations

import hashlib
import subprocess
import sys
from collections import Counter
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import miburi
from miburi.figures import FINGERS, HAND
from miburi.formats import columns, glove, read_annotations, read_labels
from miburi.perform import janken
from miburi.perform.janken import hand, wearer
from miburi.perform.janken.device import Device, played
from miburi.perform.janken.sensors import FINGER, FITTED, POSES, SENSORS

# [H], table 2: frames, intervals
TABLE_2 = {
    **{"p": (978, 41), "r": (581, 42), "s": (758, 41)},
    **{"pr": (377, 20), "rp": (269, 20), "rs": (234, 20), "sr": (373, 20), "ps": (357, 20), "sp": (270, 21)},
}


@pytest.fixture(scope="module")
def takes():
    return janken.perform(2011)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    home = tmp_path_factory.mktemp("janken")
    janken.write(home, 2011)
    return home


def digests(home: Path) -> dict[str, str]:
    return {p.name: hashlib.sha256(p.read_bytes()).hexdigest() for p in sorted(home.iterdir())}


@cache
def motion(folder: Path, take: str) -> miburi.Motion:
    return miburi.read(folder / f"{take}.csv")


def holds(folder: Path, takes, label: str, joint: str, axis: str = "x") -> np.ndarray:
    """Mean angle of each hold's middle half."""
    column = columns.angle_index("test", "test", joint, axis)
    means = []
    for take, (_, labels) in takes.items():
        angles = motion(folder, take).angles[:, column]
        means += [
            angles[s + (e - s) // 4 : e - (e - s) // 4].mean() for s, e, name in labels if name == label
        ]
    return np.array(means)


def half_ways(angles: np.ndarray, changes) -> np.ndarray:
    """When each finger's first joint is half way in each change, (K, 4) frames before or after their mean."""
    rows = []
    for start, end, _ in changes:
        row = []
        for finger in FINGERS[1:]:
            x = angles[start - 2 : end + 3, 3 * HAND.joints.index(f"{finger}1") + 1]
            middle = 0.5 * (x[0] + x[-1])
            k = int(np.flatnonzero((x[:-1] - middle) * (x[1:] - middle) <= 0)[0])
            row.append(k + (middle - x[k]) / (x[k + 1] - x[k] or 1.0))
        rows.append(row)
    return np.array(rows) - np.mean(rows, axis=1, keepdims=True)


@pytest.mark.parametrize("seed", [0, 2011, "another"])
def test_counts_are_table_2(seed):
    recordings = janken.perform(seed)
    assert tuple(recordings) == tuple(p.take for p in janken.plan(seed))
    frames, intervals = Counter(), Counter()
    for counts, labels in recordings.values():
        assert labels[0][0] == 0 and labels[-1][1] == len(counts)
        for (_, end, one), (start, _, other) in pairwise(labels):
            assert start == end
            # a hold is followed by a change that begins with it, a change by the hold that it leads to
            assert (len(one), len(other)) in ((1, 2), (2, 1)) and one[-1] == other[0]
        for start, end, label in labels:
            frames[label] += end - start
            intervals[label] += 1
    assert {k: (frames[k], intervals[k]) for k in frames} == TABLE_2
    assert sum(frames.values()) == 4197 and sum(intervals.values()) == 245


def test_each_recording_alternates_between_two_poses(takes):
    for (_, labels), pair in zip(takes.values(), ("rs", "rp", "sp"), strict=True):
        assert {n for _, _, n in labels} == {pair[0], pair[1], pair, pair[::-1]}


def test_lengths_vary_and_add_up():
    for label, (frames, intervals) in TABLE_2.items():
        lengths = np.array(wearer._lengths(3, label))
        assert len(lengths) == intervals and lengths.sum() == frames and lengths.min() >= 5
        assert 0.08 < lengths.std() / lengths.mean() < 0.5


def test_raw_counts(takes):
    gains = [abs(s["gain"]) for s in janken.calibration().values() if s]
    assert min(gains) >= 0.2 and max(gains) <= 1.2
    for counts, labels in takes.values():
        assert counts.dtype == np.int64 and counts.shape[1] == 22
        assert counts.min() >= 0 and counts.max() <= 255
        for start, end, label in labels:
            if len(label) == 1 and end - start > 12:
                core = counts[start + 5 : end - 5]
                assert np.abs(np.diff(core, axis=0)).max() <= 14  # a stretched hand that relaxes
        # noise lies below a count: a hold is runs of one count
        still = np.concatenate([np.diff(counts[s + 5 : e - 5], axis=0) for s, e, n in labels if len(n) == 1])
        assert np.mean(np.abs(still) <= 1) > 0.95 and np.mean(still == 0) > 0.8


def test_seeds(takes):
    again, other = janken.perform(2011), janken.perform(2012)
    for take, (counts, labels) in takes.items():
        np.testing.assert_array_equal(again[take][0], counts)
        assert again[take][1] == labels
        assert other[take][1] != labels


def test_files_are_the_same_every_time(folder, tmp_path):
    written = janken.write(tmp_path, 2011)
    assert sorted(p.name for p in written) == sorted(p.name for p in tmp_path.iterdir())
    assert digests(tmp_path) == digests(folder)
    assert b"simulated=1" in (folder / "rock_paper.csv").read_bytes().split(b"\n")[0]


def test_files_are_read_back(folder, takes):
    found = read_annotations(folder / "annotations.tsv")
    assert len(found) == 245
    by = janken.calibration()
    for take, (counts, labels) in takes.items():
        m = motion(folder, take)
        assert len(m) == len(counts) and m.fps == 30 and m.name == take
        assert read_labels(folder / f"{take}.lab", fps=30, frames=len(m)) == labels
        mine = [(round(a.start_s * 30), round(a.end_s * 30), a.keyword) for a in found if a.take == take]
        assert mine == labels
        # the naive calibration of one sensor and of the joint that follows it
        s = by["s09"]
        degrees = (counts[:, 8] - s["offset"]) * s["gain"]
        np.testing.assert_allclose(m.angles[:, 3 * HAND.joints.index("middle2") + 1], degrees)
        np.testing.assert_allclose(m.angles[:, 3 * HAND.joints.index("middle3") + 1], 0.62 * degrees)


def test_poses_are_a_hands(folder, takes):
    def mean(label, joint, axis="x"):
        return holds(folder, takes, label, joint, axis).mean()

    for finger in FINGERS[1:]:
        assert 62 < mean("r", f"{finger}1") < 92
        assert 88 < mean("r", f"{finger}2") < 115
        assert 52 < mean("r", f"{finger}3") < 72
        assert -22 < mean("p", f"{finger}1") < 15 and -12 < mean("p", f"{finger}2") < 20
        bent = finger in ("ring", "little")
        assert (mean("s", f"{finger}1") > 50) == bent and (mean("s", f"{finger}2") > 75) == bent
        assert bent or abs(mean("s", f"{finger}2")) < 20
    spread = mean("s", "middle1", "z") - mean("s", "index1", "z")
    assert 14 < spread < 35
    assert mean("p", "little1", "z") > mean("p", "ring1", "z") > mean("p", "middle1", "z")


def test_a_fist_is_a_fist_with_the_thumb_before_it(folder, takes):
    m = motion(folder, "rock_scissors")
    start, end, label = takes["rock_scissors"][1][0]
    assert label == "r"
    tips = m.end_positions()[start:end].mean(axis=0)
    joints = m.positions()[start:end].mean(axis=0)
    knuckles = joints[[HAND.joints.index(f"{f}1") for f in FINGERS]]
    assert (np.linalg.norm(tips[1:], axis=1) < np.linalg.norm(knuckles[1:], axis=1) + 0.005).all()
    assert (tips[1:, 1] < knuckles[1:, 1]).all() and (tips[1:, 2] > 0).all()
    assert tips[0, 2] > joints[HAND.joints.index("index2"), 2]  # the thumb's tip lies before the fingers
    assert tips[0, 0] < knuckles[1, 0]  # and across


def test_fingers_do_not_move_in_lockstep(folder, takes):
    angles = motion(folder, "rock_paper").angles
    halves = half_ways(angles, [i for i in takes["rock_paper"][1] if len(i[2]) == 2])
    assert 0.3 < halves.std() < 2.5  # frames
    assert len({tuple(np.argsort(row)) for row in halves}) > 5  # in more than one order
    # ring and little finger go together more than index and little
    r = np.corrcoef(halves.T)
    assert r[2, 3] > r[0, 3]


def test_intervals_differ_and_holds_sag(folder, takes):
    for label, joint, least, most in (
        ("r", "middle2", 0.8, 6.0),
        ("p", "index1", 4.0, 12.0),
        ("s", "ring1", 2.0, 10.0),
    ):
        assert least < holds(folder, takes, label, joint).std() < most
    sag = []
    for take in ("rock_paper", "paper_scissors"):
        x = motion(folder, take).angles[:, 3 * HAND.joints.index("ring2") + 1]
        sag += [x[e - 4] - x[s + 3] for s, e, n in takes[take][1][1:-1] if n == "p" and e - s > 20]
    assert 0.5 < np.mean(sag) < 12  # an open hand relaxes


def test_small_is_a_part_that_has_every_label(takes):
    small = janken.perform(2011, small=True)
    n = Counter(name for _, labels in small.values() for _, _, name in labels)
    assert set(n) == set(TABLE_2) and min(n.values()) >= 8
    for take, (counts, labels) in small.items():
        np.testing.assert_array_equal(counts, takes[take][0][: len(counts)])
        assert labels[-1][1] == len(counts)


def test_minimum_jerk_is_flash_and_hogans():
    u = np.linspace(0, 1, 501)
    s = hand.minimum_jerk(u)
    assert s[0] == 0 and s[-1] == 1 and (np.diff(s) >= 0).all()
    assert np.gradient(s, u).max() == pytest.approx(15 / 8, abs=1e-3)  # peak speed over mean speed
    assert hand.minimum_jerk(np.array([-3.0, 7.0])).tolist() == [0.0, 1.0]


def test_ranges_and_speeds_are_those_of_a_real_glove(folder, takes, recordings):
    """Flexions of a real wearer, half to twice as far and fast; the index's dead middle joint is left out."""
    real = glove.read_columns(
        recordings / "hand/cyberglove_rps/mock.txt.gz",
        Path(__file__).parents[2] / "config/gloves/cyberglove_rps.yaml",
    )
    for joint in ("index1", "middle1", "middle2", "ring1", "ring2", "little1", "little2"):
        c = 3 * HAND.joints.index(joint) + 1
        ours = [motion(folder, take).angles[:, c] for take in takes]
        far = np.ptp(np.concatenate(ours)) / np.ptp(real.angles[:, c])
        speeds = np.concatenate([np.abs(np.diff(x)) * 30 for x in ours])
        moving = np.quantile(speeds[speeds > 40], 0.9)
        theirs = np.abs(np.diff(real.angles[:, c])) * real.fps
        assert 0.6 < far < 1.7, joint
        assert 0.5 < moving / np.quantile(theirs[theirs > 40], 0.9) < 2.0, joint


def test_fingers_take_turns_as_a_real_hands_do(folder, takes, recordings):
    """Opening, the little finger goes first and the index last; closing, the other way round."""
    home = recordings / "hand/cyberglove_rps"
    real = glove.read_columns(
        home / "mock.txt.gz", Path(__file__).parents[2] / "config/gloves/cyberglove_rps.yaml"
    )
    labels = read_labels(home / "labels.tsv", fps=24)
    for label, sign in (("rp", 1), ("pr", -1)):
        theirs = half_ways(real.angles, [i for i in labels if i[2] == label]) / real.fps
        ours = half_ways(
            motion(folder, "rock_paper").angles, [i for i in takes["rock_paper"][1] if i[2] == label]
        )
        for lags in (theirs, ours / janken.FPS):
            first, last = lags.mean(axis=0)[[3, 0]]
            assert 0.02 < sign * (last - first) < 0.16
        assert 0.4 < (ours / janken.FPS).std() / theirs.std() < 2.0


@given(
    st.lists(st.floats(-50, 50), min_size=1, max_size=30),
    st.lists(st.floats(0.0, 5.0), min_size=1, max_size=3),
)
def test_play_holds_until_the_finger_has_crossed_it(values, plays):
    x = np.outer(values, np.arange(1, len(plays) + 1))
    found = played(x, np.array(plays))
    for s, p in enumerate(plays):
        y = x[0, s]
        for t, value in enumerate(x[:, s]):
            y = max(y, value - p / 2) if y < value else min(y, value + p / 2)
            assert found[t, s] == pytest.approx(y, abs=1e-12)


@given(st.lists(st.floats(-40, 120), min_size=22, max_size=22))
def test_a_ring_finger_does_not_extend_alone(values):
    angles = np.array(values)
    found = hand.together(angles)
    for middle, ring, little in ((7, 11, 15), (8, 12, 16)):
        assert found[ring] >= (found[middle] + found[little]) / 2 - 35 - 1e-9
        assert found[ring] >= angles[ring]
    np.testing.assert_array_equal(np.delete(found, [11, 12]), np.delete(angles, [11, 12]))
    pointed = np.where(FINGER == 3, POSES["p"], POSES["r"])  # a ring finger put up from a fist
    assert hand.together(pointed)[11] > 30 and hand.together(pointed)[12] > 60


def test_neighbours_drag_each_other():
    way = np.zeros((1, 1, 22))
    way[..., FINGER == 3] = 1.0  # the ring finger alone wants to move
    found = hand._dragged(way)[0, 0]
    assert found[11] < 0.6 and found[15] > 0.3 and 0.1 < found[7] < found[15]
    assert (found[FINGER < 2] == 0).all()
    np.testing.assert_allclose(hand._dragged(np.ones((2, 3, 22))), 1.0)


@given(st.lists(st.floats(0, 1), min_size=22, max_size=22))
def test_dragging_is_the_mixture_written_out(values):
    way = np.array(values)
    mean = [np.mean([way[s] for s in range(22) if FINGER[s] == f]) for f in range(6)]
    for s, found in enumerate(hand._dragged(way)):
        mixed = way[s] - mean[FINGER[s]] + sum(hand._DRAGGED[FINGER[s], g] * mean[g] for g in range(6))
        assert found == pytest.approx(min(max(mixed, 0.0), 1.0), abs=1e-12)


def test_the_glove_is_a_little_off_its_calibration():
    still = np.tile(POSES["s"], (600, 1))
    off = []
    for seed in range(8):
        device = Device.drawn(seed)
        counts = device.read(still, np.random.default_rng(seed))
        degrees = (counts - [s.offset for s in SENSORS]) * [s.gain for s in SENSORS]
        assert (counts[:, ~FITTED] == 127).all()
        assert (counts[:, 7] <= 5).all()  # the knuckle's sensor is at its end when the finger is straight
        off.append(degrees[-1] - still[-1])
        assert np.abs(counts[-1] - counts[0]).max() >= 1  # it drifts
    off = np.abs(np.array(off)[:, FITTED])
    assert 0.5 < np.median(off) < 4 and off.max() < 30


def test_bent_beside_straight_pulls_an_abduction():
    for seed in range(4):
        mix = Device.drawn(seed).crosstalk
        bent = np.zeros(22)
        bent[11] = 60.0
        assert 8 < (mix @ bent)[14] < 20 and (mix @ bent)[10] == pytest.approx(0, abs=3)


@pytest.mark.parametrize("small", [False, True])
def test_the_plan_is_what_is_written(tmp_path, small):
    plan = janken.plan(2011, small=small)
    names = {p.name for p in janken.write(tmp_path, 2011, small=small)}
    assert {f for p in plan for f in p.files} | {f"{plan[0].wearer}.yaml", "annotations.tsv"} == names
    for p in plan:
        m = miburi.read(tmp_path / f"{p.take}.csv")
        assert 0.8 < p.seconds * m.fps / len(m) < 1.25
    if not small:
        assert sum(p.seconds for p in plan) == pytest.approx(4197 / 30, abs=0.2)


def test_the_plan_needs_no_library():
    """It is read whenever the workflow is parsed."""
    code = "import sys; from miburi.perform import janken; janken.plan(1); print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"numpy", "scipy", "h5py", "numba", "yaml"} & set(run.stdout.split())
