"""From local rotations to places in the world, and back to angles."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.motion import Floats, Motion


def matrices(quaternions: ArrayLike) -> Floats:
    """Rotation matrices (…, 3, 3) of quaternions (…, 4), x y z w, of any length but zero."""
    q = np.asarray(quaternions, dtype=np.float64)
    return Rotation.from_quat(q.reshape(-1, 4)).as_matrix().reshape(*q.shape[:-1], 3, 3)


def quaternions(rotation_matrices: ArrayLike) -> Floats:
    """Quaternions (…, 4), x y z w, of rotation matrices (…, 3, 3)."""
    m = np.asarray(rotation_matrices, dtype=np.float64)
    return Rotation.from_matrix(m.reshape(-1, 3, 3)).as_quat().reshape(*m.shape[:-2], 4)


def euler(angles: ArrayLike, order: str, *, degrees: bool = True) -> Floats:
    """Quaternions (…, 4) of intrinsic Euler angles (…, 3) in the order given, as "ZXY" (R = Rz Rx Ry)."""
    a = np.asarray(angles, dtype=np.float64)
    turns = Rotation.from_euler(order.upper(), a.reshape(-1, 3), degrees=degrees)
    return np.asarray(turns.as_quat()).reshape(*a.shape[:-1], 4)


def forward(motion: Motion) -> tuple[Floats, Floats]:
    """Forward kinematics: each joint's place and rotation are its parent's, moved by its own.

    Returns
    -------
    positions : (T, J, 3) float64
        Metres, world frame.
    orientations : (T, J, 3, 3) float64
        Rotation of each joint's frame in the world.

    Raises
    ------
    InputError
        A rotation is a quaternion of length zero.
    """
    skeleton = motion.skeleton
    # a sum in both cases: an array that may not be written to would have the kernel compiled once more
    steps = skeleton.offsets[None] + (0.0 if motion.translations is None else motion.translations)
    positions = np.empty((len(motion), len(skeleton), 3))
    world = np.empty((len(motion), len(skeleton), 3, 3))
    start = motion.root + skeleton.offsets[0]
    bad = int(_chain(skeleton.parents, steps, start, motion.rotations, positions, world))
    if bad >= 0:
        t, j = divmod(bad, len(skeleton))
        raise InputError(
            f"take {motion.name!r}, frame {t}: joint {skeleton.joints[j]!r} has a quaternion of length zero"
        )
    return positions, world


@njit(error_model="numpy")
def _chain(
    parents: NDArray[np.int32],
    steps: Floats,
    start: Floats,
    rotations: Floats,
    positions: Floats,
    world: Floats,
) -> int:
    """Fill positions and world, frame by frame.

    Returns frame · J + joint of the first quaternion of length zero, or −1 if there is none.
    `steps` is (1, J, 3), the same in all frames, or (T, J, 3); `start` (T, 3) is where the root joint is.
    """
    local = np.empty((3, 3))
    for t in range(len(start)):
        own = t if len(steps) > 1 else 0
        for j in range(len(parents)):
            x, y, z, w = rotations[t, j]
            square = x * x + y * y + z * z + w * w
            if square == 0.0:
                return t * len(parents) + j
            s = 2.0 / square
            # element by element: assigning whole arrays takes numba six seconds more to compile
            local[0, 0] = 1 - s * (y * y + z * z)
            local[0, 1] = s * (x * y - z * w)
            local[0, 2] = s * (x * z + y * w)
            local[1, 0] = s * (x * y + z * w)
            local[1, 1] = 1 - s * (x * x + z * z)
            local[1, 2] = s * (y * z - x * w)
            local[2, 0] = s * (x * z - y * w)
            local[2, 1] = s * (y * z + x * w)
            local[2, 2] = 1 - s * (x * x + y * y)
            p = parents[j]
            if p < 0:
                for a in range(3):
                    positions[t, j, a] = start[t, a]
                    for b in range(3):
                        world[t, j, a, b] = local[a, b]
                continue
            for a in range(3):
                place = positions[t, p, a]
                for b in range(3):
                    place += world[t, p, a, b] * steps[own, j, b]
                    turn = 0.0
                    for c in range(3):
                        turn += world[t, p, a, c] * local[c, b]
                    world[t, j, a, b] = turn
                positions[t, j, a] = place
    return -1


def ends(motion: Motion) -> Floats:
    """Where the ends of the outermost bones are: (T, E, 3) float64, metres, world frame."""
    positions, world = forward(motion)
    e = motion.skeleton.ends
    return np.asarray(positions[:, e] + np.einsum("teab,eb->tea", world[:, e], motion.skeleton.end_offsets))


def hand_rotations(angles: ArrayLike) -> Floats:
    """Joint rotations of a hand.

    Parameters
    ----------
    angles : (T, 48)
        Degrees, joint-major, Z X Y ([H], M = 48).

    Returns
    -------
    (T, 16, 4) float64
        Quaternions x y z w of R = Rz Rx Ry.
    """
    a = np.asarray(angles, dtype=np.float64)
    return euler(a.reshape(len(a), -1, 3), "ZXY")


def unit(vectors: ArrayLike, fallback: ArrayLike = (0.0, 1.0, 0.0)) -> Floats:
    """Vectors (…, 3) of length one; those too short to have a direction become `fallback`."""
    v = np.asarray(vectors, dtype=np.float64)
    length = np.linalg.norm(v, axis=-1, keepdims=True)
    return np.where(length > 1e-9, v / np.maximum(length, 1e-9), np.asarray(fallback, dtype=np.float64))


def trunk_frame(left_hip: ArrayLike, right_hip: ArrayLike, waist: ArrayLike, neck: ArrayLike) -> Floats:
    """The body-centred frame: x to the person's left, y up the trunk, z forward.

    Parameters
    ----------
    left_hip, right_hip, waist, neck : (T, 3)
        Places in the world, metres.

    Returns
    -------
    (T, 3, 3) float64
        Columns are the axes; y follows the trunk exactly, x the hips as far as they are square to it.
    """
    y = unit(np.asarray(neck, dtype=np.float64) - np.asarray(waist, dtype=np.float64))
    across = np.asarray(left_hip, dtype=np.float64) - np.asarray(right_hip, dtype=np.float64)
    x = unit(across - np.sum(across * y, axis=-1, keepdims=True) * y, fallback=(1.0, 0.0, 0.0))
    return np.stack([x, y, np.cross(x, y)], axis=-1)


def yaw_pitch_roll(frames: ArrayLike) -> Floats:
    """Angles of a trunk, as a puppet's IMU reports them.

    R = Ry(yaw) Rx(pitch) Rz(roll): yaw positive to the person's left, pitch forward, roll to the right.

    Parameters
    ----------
    frames : (T, 3, 3)
        Rotation matrices of the trunk.

    Returns
    -------
    (T, 3) float64
        Radians; yaw and roll are unwrapped over time, so they do not jump at ±π.
    """
    r = np.asarray(frames, dtype=np.float64)
    yaw = np.arctan2(r[:, 0, 2], r[:, 2, 2])
    pitch = np.arcsin(np.clip(-r[:, 1, 2], -1.0, 1.0))
    roll = np.arctan2(r[:, 1, 0], r[:, 1, 1])
    return np.stack([np.unwrap(yaw), pitch, np.unwrap(roll)], axis=-1)


def resample(motion: Motion, fps: float) -> Motion:
    """The same motion at another frame rate: root linear, rotations by slerp.

    Frame k of the result is at k / fps seconds; the last one lies at or before the motion's last frame.
    """
    from dataclasses import replace

    if len(motion) < 2 or fps == motion.fps:
        return replace(motion, fps=fps)
    t = np.arange(int(np.floor((len(motion) - 1) * fps / motion.fps + 1e-9)) + 1) * (motion.fps / fps)
    i = np.minimum(t.astype(np.intp), len(motion) - 2)
    u = (t - i)[:, None]

    def linear(x: NDArray[np.float64] | None) -> NDArray[np.float64] | None:
        if x is None:
            return None
        w = u.reshape(-1, *([1] * (x.ndim - 1)))
        return np.asarray((1 - w) * x[i] + w * x[i + 1])

    a, b = motion.rotations[i], motion.rotations[i + 1]
    step = (Rotation.from_quat(a.reshape(-1, 4)).inv() * Rotation.from_quat(b.reshape(-1, 4))).as_rotvec()
    turn = Rotation.from_rotvec(step * np.repeat(u[:, 0], len(motion.skeleton))[:, None])
    q = (Rotation.from_quat(a.reshape(-1, 4)) * turn).as_quat().reshape(a.shape)
    root = linear(motion.root)
    assert root is not None
    return replace(
        motion,
        fps=fps,
        root=root,
        rotations=q,
        translations=linear(motion.translations),
        angles=linear(motion.angles),
    )
