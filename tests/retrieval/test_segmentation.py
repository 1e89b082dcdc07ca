"""Cutting takes."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation
from scipy.stats import multivariate_normal

from miburi.errors import InputError
from miburi.figures import PERSON
from miburi.motion import Motion, Skeleton
from miburi.retrieval import pieces, ppca_curve, segment
from miburi.retrieval.segmentation import _ALIKE, _NOISE, _curve, _grouped, difference, pose


def performing(parts, fps=60.0, yaw=0.0, seed=0, seconds=5.0):
    """A simulated take: in each part other joints swing, a little unevenly."""
    rng = np.random.default_rng(seed)
    n = int(seconds * fps)
    t = np.arange(n * len(parts)) / fps
    angles = np.zeros((len(t), 14, 3))
    for k, joints in enumerate(parts):
        # half a second from one motion into the next
        weight = np.clip((t - k * seconds) / 0.5 + 0.5, 0, 1) * np.clip(
            ((k + 1) * seconds - t) / 0.5 + 0.5, 0, 1
        )
        for i, joint in enumerate(joints):
            swing = np.sin(2 * np.pi * (1.1 + 0.1 * i) * t + rng.uniform(0, 6)) + 0.1 * np.sin(1.3 * t + i)
            angles[:, PERSON.index(joint), 0] += weight * 0.9 * swing
    q = Rotation.from_rotvec(angles.reshape(-1, 3)).as_quat().reshape(len(t), 14, 4)
    q[:, 0] = (Rotation.from_euler("y", yaw) * Rotation.from_quat(q[:, 0])).as_quat()
    return Motion(PERSON, fps, np.zeros((len(t), 3)), q, name="performing")


ARMS, LEGS, LEFT = ("l_shoulder", "r_elbow"), ("l_hip", "r_hip", "r_knee"), ("l_shoulder", "l_elbow", "l_hip")
RIGHT = ("r_shoulder", "r_elbow", "r_knee")


def naive_curve(x, start, window, ahead, step, variance):
    """H with model and distance written out: Barbič et al. 2004, section 3.2."""
    curve = []
    for k in range(start + window, len(x) - ahead + 1, step):
        seen = x[start:k]
        mean = seen.mean(axis=0)
        values, vectors = np.linalg.eigh(np.cov(seen.T, bias=True) + _NOISE * np.eye(x.shape[1]))
        values, vectors = values[::-1], vectors[:, ::-1]
        r = 1
        while values[:r].sum() < variance * values.sum():
            r += 1
        sigma2 = values[r:].mean()
        w = vectors[:, :r] * np.sqrt(values[:r] - sigma2)
        c = w @ w.T + sigma2 * np.eye(x.shape[1])
        h = np.mean([(f - mean) @ np.linalg.inv(c) @ (f - mean) for f in x[k : k + ahead]])
        curve.append((k, h))
    return np.array(curve)


@pytest.mark.parametrize(("start", "step"), [(0, 5), (37, 7)])
def test_the_curve_is_the_mahalanobis_distance_of_the_growing_model(start, step):
    x = pose(performing([ARMS, LEGS]))
    frame, distance = ppca_curve(x, window=100, ahead=60, step=step, variance=0.9, start=start)
    want = naive_curve(x, start, 100, 60, step, 0.9)
    np.testing.assert_array_equal(frame, want[:, 0])
    np.testing.assert_allclose(distance, want[:, 1], rtol=1e-7)


def test_simulated_changes_are_found():
    motion = performing([ARMS, LEGS, LEFT, RIGHT])
    cuts = segment(motion)
    assert cuts.dtype == np.int64
    np.testing.assert_allclose(cuts / 60, [5, 10, 15], atol=0.5)


def naive_cut(curve, rise, hold):
    """The first peak `rise` times the valley before it that nothing passes within `hold` frames."""
    valley, where = np.inf, None
    for i, (frame, h) in enumerate(curve):
        if where is None:
            valley = min(valley, h)
            where = i if h > rise * valley else None
        elif h > curve[where][1]:
            where = i
        elif frame - curve[where][0] >= hold:
            return curve[where][0]
    return curve[where][0] if where is not None and curve[-1][1] < curve[where][1] else -1


@given(st.integers(0, 1000), st.floats(1.05, 6.0), st.integers(1, 40))
def test_a_cut_is_a_peak_high_above_the_valley_before_it(seed, rise, hold):
    rng = np.random.default_rng(seed)
    x = np.cumsum(rng.normal(size=(260, 3)), axis=0) * rng.uniform(0.01, 1.0, 3)
    _, h, cut = _curve(x, 0, 30, 20, 4, 0.9, rise, hold)
    whole = list(zip(*ppca_curve(x, window=30, ahead=20, step=4), strict=True))
    assert cut == naive_cut(whole, rise, hold)
    np.testing.assert_array_equal(h, [v for _, v in whole[: len(h)]])


def naive_surprise(x, variance=0.95):
    """−2 log-likelihood of frames under their own PPCA, by scipy's density; without the constant."""
    values, vectors = np.linalg.eigh(np.cov(x.T, bias=True) + _ALIKE * np.eye(x.shape[1]))
    r = 1
    while values[-r:].sum() < variance * values.sum():
        r += 1
    values[:-r] = values[:-r].mean() if r < len(values) else values[:-r]
    density = multivariate_normal(x.mean(axis=0), vectors * values @ vectors.T)
    return -2 * density.logpdf(x).sum() - x.size * np.log(2 * np.pi)


@given(st.integers(0, 1000), st.integers(2, 5))
def test_the_difference_is_a_likelihood_ratio(seed, width):
    rng = np.random.default_rng(seed)
    x = np.concatenate([rng.normal(size=(40, width)) @ rng.normal(size=(width, width)) for _ in range(2)])
    want = (naive_surprise(x) - naive_surprise(x[:40]) - naive_surprise(x[40:])) / 80
    assert difference(x, 0, 40, 80) == pytest.approx(want, rel=1e-6, abs=1e-9)


def test_one_motion_differs_little_from_itself_and_much_from_another():
    x = pose(performing([ARMS, LEGS]))
    assert difference(x, 60, 300, 540) > 5 * difference(x, 30, 150, 270)


def test_cuts_that_are_near_are_one_at_their_mean():
    assert _grouped([50, 10, 12, 17, 30], 8) == [13, 30, 50]
    assert _grouped([], 8) == []


def test_backwards_finds_the_simple_motion_after_the_rich_one():
    # swinging one arm stays inside what swinging both arms and the legs has shown
    motion = performing([(*ARMS, *LEGS), ARMS[:1]], seconds=6)
    np.testing.assert_allclose(segment(motion) / 60, [6], atol=0.5)


def test_one_motion_is_one_piece():
    assert len(segment(performing([ARMS], seconds=15))) == 0


def test_facing_elsewhere_does_not_matter():
    a, b = (segment(performing([ARMS, LEGS, LEFT], yaw=y)) for y in (0.0, 2.5))
    np.testing.assert_array_equal(a, b)


def test_the_frame_rate_hardly_matters():
    a, b = (segment(performing([ARMS, LEGS, LEFT], fps=f)) / f for f in (120.0, 30.0))
    np.testing.assert_allclose(a, b, atol=0.2)


def test_hands_feet_and_signs_of_quaternions_do_not_matter():
    motion = performing([ARMS, LEGS, LEFT])
    q = np.array(motion.rotations)
    rng = np.random.default_rng(0)
    for joint in ("l_hand", "r_foot"):
        q[:, PERSON.index(joint)] = Rotation.random(len(q), random_state=1).as_quat()
    q *= rng.choice([-1.0, 1.0], size=(*q.shape[:2], 1))
    np.testing.assert_array_equal(segment(Motion(PERSON, 60.0, motion.root, q)), segment(motion))


@pytest.mark.parametrize("method", ["PPCA", "PCA"])
def test_short_and_still_takes_are_one_piece(method):
    still = np.zeros((900, 14, 4))
    still[..., 3] = 1
    assert len(segment(Motion(PERSON, 60.0, np.zeros((900, 3)), still), method=method)) == 0
    for n in (0, 1, 5, 190):
        assert len(segment(performing([ARMS])[:n], method=method)) == 0


def test_the_pca_variant_finds_a_simulated_change():
    cuts = segment(performing([ARMS, LEGS], seconds=8), method="PCA") / 60
    assert np.abs(cuts - 8).min() < 1.0


@pytest.mark.parametrize(
    "settings",
    [
        {"variance": 1.0},
        {"variance": 0},
        {"rise": 1},
        {"window_s": 0},
        {"ahead_s": -1},
        {"step_s": 0},
        {"near_s": -1},
        {"differ": -1},
        {"differ": float("nan")},
        {"method": "SVD"},
    ],
)
def test_settings_out_of_range_are_refused(settings):
    with pytest.raises(InputError):
        segment(performing([ARMS]), **settings)


def test_pieces_cover_the_take():
    np.testing.assert_array_equal(pieces([], 7), [[0, 7]])
    np.testing.assert_array_equal(pieces([3, 5], 7), [[0, 3], [3, 5], [5, 7]])
    # 5–9 is shortest and joins the shorter neighbour 0–5; 0–9 is still short and joins 9–50
    np.testing.assert_array_equal(pieces([5, 9, 50], 100, 10), [[0, 50], [50, 100]])
    np.testing.assert_array_equal(pieces([40, 44], 84, 10), [[0, 44], [44, 84]])
    np.testing.assert_array_equal(pieces([40, 95], 100, 10), [[0, 40], [40, 100]])
    np.testing.assert_array_equal(pieces([4], 8, 10), [[0, 8]])


@given(st.sets(st.integers(1, 99)), st.integers(1, 60))
def test_no_piece_is_shorter_than_asked(cuts, shortest):
    got = pieces(sorted(cuts), 100, shortest)
    assert got[0, 0] == 0 and got[-1, 1] == 100
    np.testing.assert_array_equal(got[1:, 0], got[:-1, 1])
    assert len(got) == 1 or (got[:, 1] - got[:, 0]).min() >= shortest
    assert set(got[1:, 0]) <= cuts


@pytest.mark.parametrize("cuts", [[0], [7], [3, 3], [5, 2], [-1]])
def test_cuts_that_do_not_fit_are_refused(cuts):
    with pytest.raises(InputError, match="cuts"):
        pieces(cuts, 7)


def human_cuts(folder, take):
    """Best transition frames of subject 86, by hand (120 Hz)."""
    rows = [line.split() for line in (folder / f"segmentation/{take}.txt").read_text().splitlines()]
    return np.array([int(row[1]) for row in rows if len(row) == 3])


def test_a_real_take_is_cut_where_a_person_cut_it(recordings):
    from miburi.formats import read

    folder = recordings / "body"
    motion = read(folder / "cmu/86_01.amc.gz", skeleton=folder / "cmu/86.asf")
    cuts, human = segment(motion), human_cuts(folder, "86_01")
    assert len(cuts) <= len(human) + 2
    assert np.sum(np.abs(cuts[:, None] - human).min(axis=0) <= 60) >= len(human) - 1


def test_a_skeleton_of_fewer_joints_is_refused():
    with pytest.raises(InputError, match="hip"):
        stick = Skeleton(("hip", "head"), np.array([-1, 0]), np.zeros((2, 3)), "stick")
        segment(Motion(stick, 30.0, np.zeros((9, 3)), np.tile([0.0, 0, 0, 1], (9, 2, 1))))
