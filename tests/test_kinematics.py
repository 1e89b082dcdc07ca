"""Kinematics against the equations written out and against scipy's rotations."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from miburi import kinematics
from miburi.errors import InputError
from miburi.figures import HAND, PERSON
from miburi.motion import Motion, Skeleton


def skeletons(rng: np.random.Generator, joints: int) -> Skeleton:
    """A random tree, parents before children."""
    parents = np.array([-1] + [int(rng.integers(0, j)) for j in range(1, joints)])
    ends = rng.integers(0, joints, 3)
    names = tuple(f"j{k}" for k in range(joints))
    return Skeleton(
        names, parents, rng.standard_normal((joints, 3)), "tree", ends, rng.standard_normal((3, 3))
    )


def motions(seed: int, frames: int, joints: int, *, moving: bool) -> Motion:
    """A random motion; quaternions are of any length."""
    rng = np.random.default_rng(seed)
    moves = rng.standard_normal((frames, joints, 3)) if moving else None
    if moves is not None:
        moves[:, 0] = 0.0
    return Motion(
        skeletons(rng, joints),
        30,
        rng.standard_normal((frames, 3)),
        rng.standard_normal((frames, joints, 4)) + 1e-3,
        translations=moves,
    )


def naive_forward(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """p_j = p_parent + R_parent (o_j + d_j), R_j = R_parent R(q_j); frame by frame, joint by joint."""
    skeleton = motion.skeleton
    places, turns = np.zeros((len(motion), len(skeleton), 3)), np.zeros((len(motion), len(skeleton), 3, 3))
    for t in range(len(motion)):
        for j, p in enumerate(skeleton.parents):
            own = Rotation.from_quat(motion.rotations[t, j]).as_matrix()
            if p < 0:
                places[t, j], turns[t, j] = motion.root[t] + skeleton.offsets[j], own
                continue
            moved = 0.0 if motion.translations is None else motion.translations[t, j]
            places[t, j] = places[t, p] + turns[t, p] @ (skeleton.offsets[j] + moved)
            turns[t, j] = turns[t, p] @ own
    return places, turns


@given(st.integers(0, 1000), st.integers(0, 5), st.integers(1, 12), st.booleans())
def test_forward_is_the_equation(seed, frames, joints, moving):
    motion = motions(seed, frames, joints, moving=moving)
    places, turns = kinematics.forward(motion)
    expected = naive_forward(motion)
    np.testing.assert_allclose(places, expected[0], atol=1e-12)
    np.testing.assert_allclose(turns, expected[1], atol=1e-12)
    np.testing.assert_array_equal(motion.positions(), places)
    for e, joint in enumerate(motion.skeleton.ends):
        tips = expected[0][:, joint] + expected[1][:, joint] @ motion.skeleton.end_offsets[e]
        np.testing.assert_allclose(motion.end_positions()[:, e], tips, atol=1e-12)


def test_a_bent_arm_by_hand():
    """Left arm out to the side (a quarter turn about z), elbow bent forward by a quarter about y."""
    angles = np.zeros((1, 14, 3))
    angles[0, PERSON.index("l_shoulder")] = (90, 0, 0)
    angles[0, PERSON.index("l_elbow")] = (0, -90, 0)
    m = Motion(PERSON, 30, [[0, 1, 0]], kinematics.euler(angles, "ZXY"))
    at = dict(zip(PERSON.joints, m.positions()[0], strict=True))
    np.testing.assert_allclose(at["l_shoulder"], (0.19, 1.46, 0), atol=1e-12)
    np.testing.assert_allclose(at["l_elbow"], (0.49, 1.46, 0), atol=1e-12)
    np.testing.assert_allclose(at["l_hand"], (0.49, 1.46, 0.26), atol=1e-12)
    np.testing.assert_allclose(at["r_hand"], (-0.19, 0.90, 0), atol=1e-12)


def test_a_quaternion_without_length_is_named():
    q = np.tile([0.0, 0, 0, 1], (3, 14, 1))
    q[2, 5] = 0.0
    with pytest.raises(InputError, match="'fall', frame 2: joint 'r_shoulder' has a quaternion of length"):
        kinematics.forward(Motion(PERSON, 30, np.zeros((3, 3)), q, name="fall"))


@given(st.integers(0, 1000), st.sampled_from(["ZXY", "XYZ", "yxz", "ZYX"]))
def test_angles_quaternions_matrices(seed, order):
    rng = np.random.default_rng(seed)
    angles = rng.uniform(-180, 180, (4, 2, 3))
    q = kinematics.euler(angles, order)
    axes = {"X": np.eye(3)[0], "Y": np.eye(3)[1], "Z": np.eye(3)[2]}
    for i in np.ndindex(4, 2):
        expected = np.eye(3)
        for axis, degrees in zip(order.upper(), angles[i], strict=True):
            expected = expected @ Rotation.from_rotvec(np.radians(degrees) * axes[axis]).as_matrix()
        np.testing.assert_allclose(kinematics.matrices(q)[i], expected, atol=1e-12)
    back = kinematics.quaternions(kinematics.matrices(q))
    np.testing.assert_allclose(np.abs(np.sum(back * q, axis=-1)), 1.0)  # q and −q are one rotation
    np.testing.assert_allclose(kinematics.matrices(3.7 * q), kinematics.matrices(q), atol=1e-12)


def test_flexion_of_a_hand_brings_fingertips_to_the_palm():
    angles = np.zeros((1, 48))
    for j, name in enumerate(HAND.joints):
        if name != "wrist" and not name.startswith("thumb"):
            angles[0, 3 * j + 1] = 80
    q = kinematics.hand_rotations(angles)
    assert q.shape == (1, 16, 4)
    tips = Motion(HAND, 30, np.zeros((1, 3)), q).end_positions()[0, 1:]
    assert (tips[:, 2] > 0).all() and (tips[:, 1] < 0.09).all()  # before the palm, below the knuckles


def test_trunk_frame_and_its_angles():
    yaw, pitch, roll = np.radians([[200.0, 20, -15], [170, -40, 30], [-175, 5, 0]]).T
    wanted = np.stack(
        [(Rotation.from_euler("YXZ", a)).as_matrix() for a in zip(yaw, pitch, roll, strict=True)]
    )
    waist = np.array([[1.0, 1, 1]] * 3)
    frames = kinematics.trunk_frame(
        waist + wanted @ [0.1, -0.03, 0],
        waist + wanted @ [-0.1, -0.03, 0],
        waist,
        waist + wanted @ [0, 0.5, 0],
    )
    np.testing.assert_allclose(frames, wanted, atol=1e-12)
    angles = kinematics.yaw_pitch_roll(frames)
    np.testing.assert_allclose(np.exp(1j * angles), np.exp(1j * np.stack([yaw, pitch, roll], 1)), atol=1e-9)
    assert (np.abs(np.diff(angles[:, [0, 2]], axis=0)) <= np.pi).all()


def test_a_trunk_without_direction_is_finite():
    point = np.zeros((2, 3))
    frames = kinematics.trunk_frame(point, point, point, point)
    np.testing.assert_allclose(frames, np.tile(np.eye(3), (2, 1, 1)))
    np.testing.assert_array_equal(kinematics.unit([[0, 0, 2.0], [0, 0, 1e-12]]), [[0, 0, 1], [0, 1, 0]])


@given(st.integers(0, 1000), st.integers(2, 8), st.sampled_from([7.0, 30.0, 60.0, 100.0]))
def test_resampled_is_slerp(seed, frames, fps):
    motion = motions(seed, frames, 3, moving=True)
    other = kinematics.resample(motion, fps)
    t = np.arange(len(other)) / fps
    assert other.fps == fps and t[-1] <= (frames - 1) / 30 + 1e-9 < t[-1] + 1 / fps + 1e-6
    known = np.arange(frames) / 30
    t = np.minimum(t, known[-1])
    for axis in range(3):
        np.testing.assert_allclose(other.root[:, axis], np.interp(t, known, motion.root[:, axis]), atol=1e-9)
    for j in range(3):
        expected = Slerp(known, Rotation.from_quat(motion.rotations[:, j]))(t)
        apart = expected.inv() * Rotation.from_quat(other.rotations[:, j])
        np.testing.assert_allclose(apart.magnitude(), 0, atol=1e-6)


def test_a_single_frame_keeps_to_itself():
    motion = motions(1, 1, 4, moving=False)
    assert len(kinematics.resample(motion, 60)) == 1
    assert len(kinematics.resample(motion[:0], 60)) == 0
