"""The 42 values."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from miburi.errors import InputError
from miburi.figures import BODY_JOINTS, PERSON
from miburi.motion import Motion, Skeleton
from miburi.retrieval import features, names, reset_angles

WEIGHT = 0.3


def moving(seed=0, frames=20, skeleton=PERSON, yaw=0.0):
    """A person whose joints all turn smoothly, trunk included."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, frames)[:, None, None]
    angles = 0.6 * np.sin(
        t * rng.uniform(0.2, 1.0, (1, len(skeleton), 3)) + rng.uniform(0, 6, (1, len(skeleton), 3))
    )
    q = Rotation.from_rotvec(angles.reshape(-1, 3)).as_quat().reshape(frames, len(skeleton), 4)
    turn = Rotation.from_euler("y", yaw)
    q[:, 0] = (turn * Rotation.from_quat(q[:, 0])).as_quat()
    return Motion(skeleton, 60.0, rng.normal(size=(frames, 3)), q, name="moving")


def scaled(skeleton, factors):
    return Skeleton(
        skeleton.joints, skeleton.parents, skeleton.offsets * np.reshape(factors, (-1, 1)), "scaled"
    )


def column(name):
    return names().index(name)


def test_the_columns_have_names():
    assert names()[:4] == ["neck_x", "neck_y", "neck_z", "l_shoulder_x"]
    assert names()[-6:] == ["r_foot_x", "r_foot_y", "r_foot_z", "yaw", "pitch", "roll"]
    assert len(names()) == 42


def test_standing_still_is_the_person_at_rest():
    q = np.zeros((3, 14, 4))
    q[..., 3] = 1
    x = features(Motion(PERSON, 60.0, np.full((3, 3), 7.0), q))
    assert x.shape == (3, 42)
    assert x.dtype == np.float32
    rest = Motion(PERSON, 60.0, np.zeros((1, 3)), q[:1]).positions()[0]
    want = [rest[PERSON.index(j)] for j in BODY_JOINTS]
    np.testing.assert_allclose(x[:, :39], np.tile(np.ravel(want), (3, 1)), atol=1e-6)
    np.testing.assert_allclose(x[:, 39:], 0, atol=1e-6)


def test_a_puppet_has_the_values_of_the_formula():
    # Trunk = Ry(yaw) Rx(pitch) Rz(roll); upper arm Rz(s z) Rx(-x) Ry(s y) on (0, -1, 0), forearm R Rx(-elbow)
    rng = np.random.default_rng(4)
    n = 15
    degrees = {name: rng.uniform(-30, 60, n) for name in ("z", "x", "y", "elbow", "hip_z", "hip_x", "knee")}
    trunk = np.stack([np.linspace(0, 400, n), rng.uniform(-30, 30, n), rng.uniform(-20, 20, n)], axis=1)
    q = np.zeros((n, 14, 4))
    q[..., 3] = 1

    def turn(order, *angles):
        return Rotation.from_euler(order, np.stack(angles, axis=-1).reshape(n, -1), degrees=True)

    R = turn("YXZ", *trunk.T)
    q[:, 0] = R.as_quat()
    want = {}
    for side, s in (("l", 1), ("r", -1)):
        arm = turn("ZXY", s * degrees["z"], -degrees["x"], s * degrees["y"])
        forearm = turn("X", -degrees["elbow"])
        thigh = turn("ZX", s * degrees["hip_z"], -degrees["hip_x"])
        shank = turn("X", degrees["knee"])
        for joint, rotation in (("shoulder", arm), ("elbow", forearm), ("hip", thigh), ("knee", shank)):
            q[:, PERSON.index(f"{side}_{joint}")] = rotation.as_quat()
        down = np.array([0.0, -1.0, 0.0])
        shoulder, hip = np.array([0.19 * s, 0.46, 0.0]), np.array([0.09 * s, -0.06, 0.0])
        want[f"{side}_shoulder"] = np.tile(shoulder, (n, 1))
        want[f"{side}_elbow"] = shoulder + 0.30 * arm.apply(down)
        want[f"{side}_hand"] = want[f"{side}_elbow"] + 0.26 * (arm * forearm).apply(down)
        want[f"{side}_hip"] = np.tile(hip, (n, 1))
        want[f"{side}_knee"] = hip + 0.42 * thigh.apply(down)
        want[f"{side}_foot"] = want[f"{side}_knee"] + 0.42 * (thigh * shank).apply(down)
    want["neck"] = np.tile([0.0, 0.5, 0.0], (n, 1))
    for mapped in (True, False):
        x = features(Motion(PERSON, 60.0, np.zeros((n, 3)), q), mapped=mapped)
        for k, joint in enumerate(BODY_JOINTS):
            np.testing.assert_allclose(x[:, 3 * k : 3 * k + 3], want[joint], atol=1e-6)
        # more than a whole turn of the trunk, without a jump
        np.testing.assert_allclose(x[:, 39:], WEIGHT * np.radians(trunk), atol=1e-5)


def test_left_is_positive_x_and_forward_positive_z():
    q = np.zeros((1, 14, 4))
    q[..., 3] = 1
    q[:, PERSON.index("l_shoulder")] = Rotation.from_euler("x", -90, degrees=True).as_quat()
    x = features(Motion(PERSON, 60.0, np.zeros((1, 3)), q))[0]
    assert x[column("l_hand_z")] == pytest.approx(0.56, abs=1e-6)
    assert x[column("l_hand_x")] == pytest.approx(0.19, abs=1e-6)
    assert x[column("r_hand_x")] == pytest.approx(-0.19, abs=1e-6)


@given(st.integers(0, 50), st.floats(-3, 3))
def test_where_one_stands_and_faces_does_not_matter(seed, yaw):
    a, b = features(moving(seed)), features(moving(seed, yaw=yaw))
    np.testing.assert_allclose(a, b, atol=2e-5)


def test_people_of_all_sizes_are_one_figure():
    rng = np.random.default_rng(3)
    tall = scaled(PERSON, 1.3)
    np.testing.assert_allclose(features(moving(2, skeleton=tall)), features(moving(2)), atol=1e-6)
    long_limbs = PERSON.offsets.copy()
    for joint in ("l_elbow", "l_hand", "r_elbow", "r_hand", "l_knee", "l_foot", "r_knee", "r_foot", "neck"):
        long_limbs[PERSON.index(joint)] *= rng.uniform(0.7, 1.4)
    other = Skeleton(PERSON.joints, PERSON.parents, long_limbs, "long")
    q = moving(2)
    assert np.abs(features(moving(2, skeleton=other), mapped=False) - features(q, mapped=False)).max() > 0.05
    limbs = [column(f"{s}_{j}_{a}") for s in "lr" for j in ("knee", "foot") for a in "xyz"]
    np.testing.assert_allclose(
        features(moving(2, skeleton=other))[:, limbs], features(q)[:, limbs], atol=1e-6
    )


def test_bones_keep_the_persons_lengths_and_the_recorded_directions():
    factors = np.random.default_rng(5).uniform(0.6, 1.6, 14)
    motion = moving(8, skeleton=scaled(PERSON, factors))
    x = features(motion).reshape(len(motion), 14, 3)[:, :13]
    own = features(motion, mapped=False).reshape(len(motion), 14, 3)[:, :13]
    for a, b, length in (
        ("l_shoulder", "l_elbow", 0.30),
        ("r_knee", "r_foot", 0.42),
        ("r_elbow", "r_hand", 0.26),
    ):
        i, j = BODY_JOINTS.index(a), BODY_JOINTS.index(b)
        bone, recorded = x[:, j] - x[:, i], own[:, j] - own[:, i]
        np.testing.assert_allclose(np.linalg.norm(bone, axis=1), length, atol=1e-5)
        np.testing.assert_allclose(
            bone / length, recorded / np.linalg.norm(recorded, axis=1)[:, None], atol=1e-4
        )


def naive_features(motion, mapped):
    """Joints in the trunk's frame, joint by joint and frame by frame."""
    p, j = motion.positions(), motion.skeleton.index
    want = np.empty((len(motion), 39))
    for t in range(len(motion)):
        y = p[t, j("neck")] - p[t, j("waist")]
        y = y / np.linalg.norm(y)
        across = p[t, j("l_hip")] - p[t, j("r_hip")]
        x = across - (across @ y) * y
        x = x / np.linalg.norm(x)
        axes = np.stack([x, y, np.cross(x, y)])
        place = {"waist": np.zeros(3)}
        for joint in PERSON.joints:
            if joint == "waist":
                continue
            parent = PERSON.joints[PERSON.parents[PERSON.index(joint)]] if mapped else "waist"
            bone = axes @ (p[t, j(joint)] - p[t, j(parent)])
            if mapped:
                offset = PERSON.offsets[PERSON.index(joint)]
                length = np.linalg.norm(bone)
                bone = offset if length == 0 else bone / length * np.linalg.norm(offset)
            place[joint] = place[parent] + bone
        want[t] = np.ravel([place[joint] for joint in BODY_JOINTS])
    return want


@given(st.integers(0, 100), st.integers(1, 12), st.booleans(), st.booleans())
def test_joints_are_where_the_naive_twin_has_them(seed, frames, mapped, spot):
    factors = np.random.default_rng(seed).uniform(0.5, 1.5, 14)
    if spot:
        factors[PERSON.index("l_hand")] = 0.0  # a hand on the elbow has no direction
    motion = moving(seed, frames, scaled(PERSON, factors))
    np.testing.assert_allclose(
        features(motion, mapped=mapped)[:, :39], naive_features(motion, mapped), atol=1e-6
    )


@pytest.mark.parametrize("take", ["02_01", "14_14", "86_09"])
def test_acclaim_written_as_biovision_gives_the_same_values(recordings, tmp_path, take):
    from miburi.formats import read, write

    folder = recordings / "body/cmu"
    motion = read(folder / f"{take}.amc.gz", skeleton=folder / f"{take[:2]}.asf")[::4]
    write(tmp_path / "a.bvh", motion)
    np.testing.assert_allclose(features(read(tmp_path / "a.bvh")), features(motion), atol=2e-6)


def test_the_legs_of_public_conversions_have_the_same_values(recordings):
    from miburi.formats import read

    folder = recordings / "body"
    for k in range(1, 11):
        amc = features(read(folder / f"cmu/02_{k:02d}.amc.gz"), mapped=False)
        bvh = features(read(folder / f"cmu_bvh/02_{k:02d}.bvh.gz")[1:], mapped=False)
        # the conversions leave out the thorax: the trunk is shorter, and no longer quite in the same direction
        legs = [column(f"{s}_{j}_{a}") for s in "lr" for j in ("hip", "knee", "foot") for a in "xyz"]
        lengths = [np.linalg.norm(x[:, legs].reshape(len(x), 6, 3), axis=2) for x in (amc, bvh)]
        np.testing.assert_allclose(*lengths, atol=1.1e-5)
        assert 0.1 < np.median(amc[:, column("neck_y")] - bvh[:, column("neck_y")]) < 0.12


def test_angles_are_weighed():
    np.testing.assert_allclose(
        features(moving(1), angle_weight=0.6)[:, 39:], 2 * features(moving(1))[:, 39:], atol=1e-6
    )
    with pytest.raises(InputError, match="angle_weight is 0"):
        features(moving(1), angle_weight=0)


@pytest.mark.parametrize("yaw", [0.0, 170.0])
def test_angles_follow_a_trunk_that_bends_beyond_the_vertical(yaw):
    pitch = np.concatenate([np.linspace(0, 150, 40), np.linspace(150, -130, 80)])
    turned = np.stack([np.linspace(yaw, yaw + 40, 120), pitch, np.full(120, 5.0)], axis=1)
    q = np.zeros((120, 14, 4))
    q[..., 3] = 1
    q[:, 0] = Rotation.from_euler("YXZ", turned, degrees=True).as_quat()
    x = features(Motion(PERSON, 60.0, np.zeros((120, 3)), q), angle_weight=1.0)
    np.testing.assert_allclose(np.degrees(x[:, 39:]), turned - [yaw, 0, 0], atol=1e-3)


def test_no_frames_give_no_values():
    assert features(moving()[:0]).shape == (0, 42)


def test_a_missing_joint_is_named():
    names_ = tuple("pelvis" if j == "l_knee" else j for j in PERSON.joints)
    odd = Skeleton(names_, PERSON.parents, PERSON.offsets, "odd")
    with pytest.raises(InputError, match=r"l_knee.*r_knee"):
        features(moving(skeleton=odd))


def test_yaw_is_counted_from_each_pieces_mean():
    x = np.zeros((10, 42), np.float32)
    x[:, 39] = np.arange(10)
    x[:, 40] = 0.2
    got = reset_angles(x, [[5, 8], [0, 4]])
    np.testing.assert_allclose(got[:, 39], [-1.5, -0.5, 0.5, 1.5, 4, -1, 0, 1, 8, 9], atol=1e-6)
    np.testing.assert_array_equal(got[:, :39], x[:, :39])
    np.testing.assert_allclose(got[:, 40:], x[:, 40:], atol=1e-6)
    assert x[0, 39] == 0 and x[9, 39] == 9
    assert abs(reset_angles(x)[:, 39].sum()) < 1e-5
    np.testing.assert_allclose(
        reset_angles(x + np.array([0] * 39 + [3, 0, 0]))[:, 39], reset_angles(x)[:, 39], atol=1e-5
    )


@pytest.mark.parametrize("axis", ["x", "z"])
@pytest.mark.parametrize("weight", [0.3, 1.0])
@pytest.mark.parametrize("turns", [1, 2, -1])
def test_who_turned_over_before_a_piece_is_the_same_person_in_it(axis, weight, turns):
    """A somersault or cartwheel, then a bend: the bend's values are those of the bend alone."""
    before, bend = np.linspace(0, 360 * turns, 200), 30 * np.sin(np.linspace(0, 3, 60))
    turn = Rotation.from_euler(axis, np.concatenate([before, 360 * turns + bend])[:, None], degrees=True)
    rotations = np.tile([0.0, 0.0, 0.0, 1.0], (260, len(PERSON.joints), 1))
    rotations[:, 0] = turn.as_quat()
    motion = Motion(PERSON, 60.0, np.zeros((260, 3)), rotations)
    whole = reset_angles(features(motion, angle_weight=weight), [[0, 200], [200, 260]], angle_weight=weight)
    alone = reset_angles(features(motion[200:], angle_weight=weight), angle_weight=weight)
    np.testing.assert_allclose(whole[200:], alone, atol=1e-5)
    first = whole[:200, 39:] / weight
    assert np.ptp(first, axis=0).max() == pytest.approx(2 * np.pi * abs(turns), abs=0.05), "turns are kept"


@pytest.mark.parametrize("pieces", [[[0, 11]], [[-1, 3]], [[3, 3]], [[0, 5], [4, 8]]])
def test_pieces_that_do_not_fit_are_refused(pieces):
    with pytest.raises(InputError, match="pieces"):
        reset_angles(np.zeros((10, 42)), pieces)


def test_a_real_person_stands_upright(recordings):
    from miburi.formats import read

    folder = recordings / "body/cmu"
    motion = read(folder / "14_14.amc.gz", skeleton=folder / "14.asf")
    x = features(motion)
    median = dict(zip(names(), np.median(x, axis=0), strict=True))
    assert median["l_hip_x"] > 0.03 > -0.03 > median["r_hip_x"]
    assert median["l_foot_y"] < -0.7 and median["r_foot_y"] < -0.7
    assert np.median(x[:, column("l_hand_x")]) > np.median(x[:, column("r_hand_x")])
    # knees bend so that the shank goes back: a foot is rarely in front of the line from hip through knee
    thigh = x[:, column("l_knee_z")] - x[:, column("l_hip_z")]
    shank = x[:, column("l_foot_z")] - x[:, column("l_knee_z")]
    assert np.mean(shank < thigh + 0.02) > 0.95
    assert np.abs(np.diff(x[:, 39:], axis=0)).max() < 0.3
