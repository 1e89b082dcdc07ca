"""Rest poses before the motion, and frame rates that cannot be right."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from miburi.figures import PERSON
from miburi.formats import asf_amc, bvh
from miburi.formats.plausibility import flights, rest_frames, suspected_fps
from miburi.motion import Motion, Skeleton


def jumping(fps=120.0, times=3, gravity=9.81, height=0.3, swing=0.3, seed=0):
    """A simulated person who jumps straight up a few times and stands before, between and after."""
    rng = np.random.default_rng(seed)
    flight = 2 * np.sqrt(2 * height / gravity)
    t = np.arange(int(fps * times * (flight + 1.0))) / fps
    local = t % (flight + 1.0) - 0.5
    up = np.where((local > 0) & (local < flight), gravity / 2 * local * (flight - local), 0.0)
    angles = swing * np.sin(3 * t[:, None, None] + rng.uniform(0, 6, (14, 3))) * (np.arange(14) > 0)[:, None]
    q = Rotation.from_rotvec(angles.reshape(-1, 3)).as_quat().reshape(len(t), 14, 4)
    motion = Motion(PERSON, fps, np.zeros((len(t), 3)), q, name="jumping")
    centre_free = motion.positions()
    ground = centre_free[:, :, 1].min(axis=1)
    root = np.stack([np.zeros(len(t)), up - np.median(ground), np.zeros(len(t))], axis=1)
    return Motion(PERSON, fps, root, q, name="jumping")


def with_rest(motion, frames=1):
    """The motion after so many frames of the skeleton at rest."""
    rest = np.zeros((frames, len(motion.skeleton), 4))
    rest[..., 3] = 1
    q = np.concatenate([rest, motion.rotations])
    return replace(motion, rotations=q, root=np.concatenate([motion.root[:1].repeat(frames, 0), motion.root]))


@pytest.mark.parametrize("fps", [30.0, 60.0, 120.0])
@pytest.mark.parametrize("frames", [1, 2])
def test_a_rest_pose_before_the_motion_is_recognised(fps, frames):
    motion = jumping(fps, swing=1.0)
    assert rest_frames(motion) == 0
    assert rest_frames(with_rest(motion, frames)) == frames


@given(st.integers(0, 1000), st.integers(0, 30), st.sampled_from([24.0, 60.0, 120.0]))
def test_no_take_is_too_short_or_too_still(seed, frames, fps):
    rng = np.random.default_rng(seed)
    q = (
        Rotation.random(max(1, frames * 14), random_state=seed)
        .as_quat()[: frames * 14]
        .reshape(frames, 14, 4)
    )
    shaken = Motion(PERSON, fps, rng.normal(size=(frames, 3)), q)
    assert 0 <= rest_frames(shaken) <= frames
    still = np.zeros((frames, 14, 4))
    still[..., 3] = 1
    assert rest_frames(Motion(PERSON, fps, np.zeros((frames, 3)), still)) == 0
    assert suspected_fps(Motion(PERSON, fps, np.zeros((frames, 3)), still)) is None


def test_motion_that_is_fast_all_along_has_no_rest_pose():
    t = np.arange(240) / 120
    q = np.zeros((240, 14, 4))
    q[..., 3] = 1
    q[:, 1:] = Rotation.from_euler("x", 15 * t[:, None]).as_quat()[:, None]
    assert rest_frames(Motion(PERSON, 120.0, np.zeros((240, 3)), q)) == 0


REST = {"02_01": 1, "07_12": 2, "13_32_mb": 1, "49_04": 1, "14_14": 0, "85_03": 0, "85_14": 0}


@pytest.mark.parametrize("take", REST)
def test_public_conversions_begin_with_a_rest_pose(recordings, take):
    assert rest_frames(bvh.read(recordings / f"body/cmu_bvh/{take}.bvh.gz")) == REST[take]


@pytest.mark.parametrize("take", ["05_01", "10_03", "13_32", "16_36"])
def test_a_rest_pose_that_the_conversion_smoothed_takes_a_few_frames(recordings, take):
    assert 3 <= rest_frames(bvh.read(recordings / f"body/cmu_bvh/{take}.bvh.gz")) <= 5


def test_recordings_without_a_rest_pose_lose_nothing(recordings):
    for path in sorted((recordings / "body_hdm05").glob("*/*.amc.gz"))[::12]:
        motion = asf_amc.read(path, skeleton=recordings / f"body_hdm05/asf/{path.name[:2]}.asf.gz")
        assert rest_frames(motion) == 0, path.name
    for path in sorted((recordings / "body_bandai").glob("*/*.bvh.gz"))[::40]:
        assert rest_frames(bvh.read(path)) == 0, path.name


def naive_fall(motion, start, end):
    """Downward acceleration by second differences of the centre of mass, averaged over the flight."""
    j = motion.skeleton.index
    p = motion.positions()
    parts = [("neck", "head", 0.081, 1.0), ("waist", "neck", 0.497, 0.5)]
    for s in "lr":
        parts += [(f"{s}_shoulder", f"{s}_elbow", 0.028, 0.436), (f"{s}_elbow", f"{s}_hand", 0.022, 0.682)]
        parts += [(f"{s}_hip", f"{s}_knee", 0.1, 0.433), (f"{s}_knee", f"{s}_foot", 0.061, 0.606)]
    y = np.zeros(len(motion))
    for a, b, mass, share in parts:
        b = "neck" if b == "head" else b  # this figure has no head
        for t in range(len(motion)):
            y[t] += mass * (p[t, j(a), 1] + share * (p[t, j(b), 1] - p[t, j(a), 1])) / 1.0
    n, middle = end - start, (start + end) // 2
    # the second difference over half the flight
    h = n // 2 - 1
    return -(y[middle + h] - 2 * y[middle] + y[middle - h]) * (motion.fps / h) ** 2


def test_simulated_flights_fall_as_they_were_made():
    motion = jumping(swing=0.0)
    found = flights(motion)
    assert len(found) == 3
    for start, end, fall in found:
        assert fall == pytest.approx(9.81, rel=1e-6)
        assert naive_fall(motion, int(start), int(end)) == pytest.approx(fall, rel=1e-6)


@pytest.mark.parametrize(("recorded", "header"), [(60, 120), (120, 60), (30, 120), (120, 30)])
def test_a_simulated_wrong_header_is_suspected(recorded, header):
    motion = jumping(float(recorded), height=0.4)
    assert suspected_fps(motion) is None
    assert suspected_fps(replace(motion, fps=float(header))) == pytest.approx(recorded, rel=0.12)


def test_rates_that_differ_little_are_not_told_apart():
    assert suspected_fps(replace(jumping(25.0), fps=30.0)) is None


def test_hanging_and_being_carried_are_no_flights():
    motion = jumping(times=2)
    t = np.arange(len(motion)) / 120
    swinging = np.stack([0.8 * np.sin(2 * t), 2 - 0.2 * np.cos(2 * t) ** 2, 0 * t], axis=1)
    assert suspected_fps(replace(motion, root=swinging)) is None


FLYING = {"01_01": "01", "02_04": "02", "13_29": "02", "14_14": "14", "14_20": "14"}


@pytest.mark.parametrize("take", FLYING)
def test_real_people_fall_at_their_true_rate_and_are_suspected_at_a_false_one(recordings, take):
    folder = recordings / "body/cmu"
    motion = asf_amc.read(folder / f"{take}.amc.gz", skeleton=folder / f"{FLYING[take]}.asf", fps=120)
    assert len(flights(motion))
    assert suspected_fps(motion) is None
    # 60 frames/s under a header that says 120, as some CMU subjects are said to be, and the other way
    assert suspected_fps(replace(motion[::2], fps=120)) in (None, pytest.approx(60, rel=0.12))
    assert suspected_fps(replace(motion, fps=240)) == pytest.approx(120, rel=0.12)
    assert suspected_fps(replace(motion, fps=60)) == pytest.approx(120, rel=0.12)


def test_climbing_and_unknown_bodies_are_not_suspected(recordings):
    folder = recordings / "body/cmu"
    for take in ("01_02", "01_05"):
        assert suspected_fps(asf_amc.read(folder / f"{take}.amc.gz", fps=120)) is None
    stick = Skeleton(("a", "b"), np.array([-1, 0]), np.zeros((2, 3)), "stick")
    assert suspected_fps(Motion(stick, 30.0, np.zeros((9, 3)), np.tile([0.0, 0, 0, 1], (9, 2, 1)))) is None
