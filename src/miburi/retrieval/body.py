"""The 42 values of a frame: thirteen joints in a body-centred frame, and how the trunk is turned ([P])."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.compiled import njit
from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.figures import BODY_JOINTS, PERSON
from miburi.kinematics import trunk_frame, yaw_pitch_roll
from miburi.motion import Floats, Motion

WIDTH = 3 * len(BODY_JOINTS) + 3
YAW = 3 * len(BODY_JOINTS)
"""Column of the yaw; pitch and roll follow."""

# The thirteen joints and the waist before them, as on the puppet: what lies between two of these (spine,
# clavicles) is one bone.
_JOINTS = ("waist", *BODY_JOINTS)
_PARENTS = np.array(
    [
        _JOINTS.index(PERSON.joints[PERSON.parents[PERSON.index(name)]]) if name != "waist" else -1
        for name in _JOINTS
    ]
)
_OFFSETS = np.array([PERSON.offsets[PERSON.index(name)] for name in _JOINTS])


def names() -> list[str]:
    """Names of the 42 columns: `{joint}_x`, `_y`, `_z` of the thirteen joints, then yaw, pitch, roll."""
    return [f"{joint}_{axis}" for joint in BODY_JOINTS for axis in "xyz"] + ["yaw", "pitch", "roll"]


@njit(error_model="numpy")
def _fill(
    positions: Floats,
    where: NDArray[np.int64],
    frame: Floats,
    parents: NDArray[np.int64],
    offsets: Floats,
    mapped: bool,
    x: NDArray[np.float32],
) -> None:
    """Fill the first 39 columns: joints from the waist in the trunk's frame, as they are or, mapped, with the
    recorded bones' directions and the lengths of `offsets`. A parent stands before its children."""
    place = np.zeros((len(parents), 3))
    for t in range(len(x)):
        for k in range(1, len(parents)):
            p = parents[k] if mapped else 0
            length, square = 0.0, 0.0
            for a in range(3):
                bone = 0.0
                for b in range(3):
                    bone += frame[t, b, a] * (positions[t, where[k], b] - positions[t, where[p], b])
                place[k, a] = bone
                square += bone * bone
                length += offsets[k, a] * offsets[k, a]
            if mapped:
                # two joints on one spot have no direction: that of the offset then
                scale = np.sqrt(length / square) if square > 1e-18 else 0.0
                for a in range(3):
                    bone = place[k, a] * scale if scale > 0.0 else offsets[k, a]
                    place[k, a] = place[p, a] + bone
            for a in range(3):
                x[t, 3 * (k - 1) + a] = place[k, a]


def _followed(angles: Floats) -> Floats:
    """Yaw, pitch, roll (T, 3), radians, that a trunk which bends beyond the vertical takes without a jump.

    (yaw + π, π − pitch, roll + π) is the same attitude: of the two, each frame gets the one nearer to the
    frame before.
    """
    other = angles * [1.0, -1.0, 1.0] + np.pi

    def apart(a: Floats, b: Floats) -> Floats:
        gap: Floats = np.square((a - b + np.pi) % (2 * np.pi) - np.pi).sum(axis=1)
        return gap

    # changing sides is the same step from either side, so sides follow from counting the changes
    changes = apart(other[1:], angles[:-1]) < apart(angles[1:], angles[:-1])
    side = np.concatenate([[0], np.cumsum(changes) % 2])
    return np.unwrap(np.where(side[:, None] == 1, other, angles), axis=0)


def features(
    motion: Motion, joints: Mapping[str, str] | None = None, *, angle_weight: float = 0.3, mapped: bool = True
) -> NDArray[np.float32]:
    """The 42 values of each frame.

    Parameters
    ----------
    motion
        A person or a puppet.
    joints
        Canonical name (`waist` or one of `figures.BODY_JOINTS`) → name in this skeleton, where the tables of
        naming conventions do not know it.
    angle_weight
        Metres that one radian of the trunk's angles counts.
    mapped
        Bones keep their directions but take the lengths of `figures.PERSON`, so that people of all sizes and
        the puppet are one figure; False: everybody's own skeleton.

    Returns
    -------
    (T, 42) float32
        Metres: x (to the person's left), y (up the trunk), z (forward) from the waist of the 13 joints of
        `figures.BODY_JOINTS`; then yaw, pitch and roll of the trunk times `angle_weight`. Yaw is counted from
        the first frame and continuous. `names` lists the columns.

    Raises
    ------
    InputError
        The skeleton lacks a joint, or `angle_weight` is not positive.

    Notes
    -----
    [P], section on preprocessing. The angles follow a trunk that bends beyond the vertical. At a pitch of
    exactly ±90° yaw and roll are not separately defined, as on any device that reports these angles.
    """
    if not (np.isfinite(angle_weight) and angle_weight > 0):
        raise InputError(f"angle_weight is {angle_weight}, expected a positive number of metres per radian")
    where = find_joints(motion.skeleton, joints)
    if len(motion) == 0:
        return np.zeros((0, WIDTH), dtype=np.float32)
    positions = motion.positions()
    frame = trunk_frame(*(positions[:, where[j]] for j in ("l_hip", "r_hip", "waist", "neck")))
    x = np.empty((len(motion), WIDTH), dtype=np.float32)
    _fill(positions, np.array([where[j] for j in _JOINTS]), frame, _PARENTS, _OFFSETS, mapped, x)
    angles = _followed(yaw_pitch_roll(frame))
    angles[:, 0] -= angles[0, 0]
    x[:, YAW:] = angle_weight * angles
    return x


def reset_angles(
    x: ArrayLike, pieces: ArrayLike | None = None, *, angle_weight: float = 0.3
) -> NDArray[np.float32]:
    """Count the trunk's angles of each piece anew, whatever came before it.

    A puppet knows no north, and a person may perform the same motion in any direction: the yaw is counted from
    the piece's own mean. The mean is used, not the first frame, because a piece may begin a little earlier or
    later and its first frame is one noisy value, while a turn of the same size has the same shape about its
    mean. Who has turned over before the piece is not another person for it: pitch and roll begin as if the
    piece were all there is. A query is one piece and gets the same treatment.

    Parameters
    ----------
    x : (T, 42)
        Features.
    pieces : (S, 2), optional
        Start (inclusive) and end (exclusive) of pieces that do not overlap; absent: all of `x` is one piece.
    angle_weight
        Metres that one radian counts in `x`, as in `features`.

    Returns
    -------
    (T, 42) float32
        A copy; frames outside all pieces are as they were.

    Raises
    ------
    InputError
        A piece is empty, reaches outside the frames or overlaps another.
    """
    out = np.array(x, dtype=np.float32)
    if out.ndim != 2 or out.shape[1] != WIDTH:
        raise InputError(f"features have shape {out.shape}, expected any × {WIDTH}")
    spans = np.array([[0, len(out)]] if pieces is None else pieces, dtype=np.int64).reshape(-1, 2)
    if pieces is None and len(out) == 0:
        return out
    order = spans[np.argsort(spans[:, 0], kind="stable")]
    if len(order) and (
        order[0, 0] < 0
        or order[-1, 1] > len(out)
        or (order[:, 0] >= order[:, 1]).any()
        or (order[1:, 0] < order[:-1, 1]).any()
    ):
        raise InputError(f"pieces must be non-empty, apart and inside the {len(out)} frames")
    for start, end in order:
        angles = out[start:end, YAW:].astype(np.float64) / angle_weight
        turned = (angles[0, 1] + np.pi) % (2 * np.pi) - np.pi
        if abs(turned) > np.pi / 2:  # the same attitudes, begun on the usual side: see `_followed`
            angles = angles * [1.0, -1.0, 1.0] + np.pi
        angles[:, 1:] -= 2 * np.pi * np.round(angles[0, 1:] / (2 * np.pi))
        angles[:, 0] -= angles[:, 0].mean()
        out[start:end, YAW:] = angle_weight * angles
    return out
