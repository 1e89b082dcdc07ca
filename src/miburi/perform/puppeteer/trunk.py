"""How the puppet's trunk is carried."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation, Slerp

from miburi.kinematics import yaw_pitch_roll
from miburi.motion import Floats
from miburi.perform.puppeteer.chance import FPS, noise
from miburi.perform.puppeteer.users import Habits, User

_SETTLE_S = 0.3
"""Seconds in which the trunk tilts when it is put down, and in which it is jogged when it is taken."""
_EASIER = 0.5
"""The trunk is one stiff thing in the hand and upright is easy to judge: sizes err half as much as those of
paths."""


def heading_and_tilt(frames: Floats) -> tuple[Floats, Floats]:
    """Split rotations (T, 3, 3) into R = exp(tilt) Ry(heading).

    Returns
    -------
    heading : (T,) float64
        Radians, continuous over time.
    tilt : (T, 3) float64
        Rotation vector without a vertical part, at most π long.
    """
    q = Rotation.from_matrix(frames)
    quaternion = q.as_quat()
    heading = np.unwrap(2 * np.arctan2(quaternion[:, 1], quaternion[:, 3]))
    tilt = (q * Rotation.from_rotvec(np.outer(heading, [0.0, 1.0, 0.0])).inv()).as_rotvec()
    return heading, tilt


def _limited(rotations: Rotation, h: Habits) -> Rotation:
    """A trunk that turns a share of what it should and tilts no further than the stand or the user's back
    lets it."""
    heading, tilt = heading_and_tilt(rotations.as_matrix())
    size = np.linalg.norm(tilt, axis=-1, keepdims=True)
    limit = np.radians(h.trunk_limit)
    tilt = tilt / np.maximum(size, 1e-9) * limit * np.tanh(h.trunk_gain * size / limit)
    # a trunk past upside down tilts the other way: the stand takes its time
    tilt = gaussian_filter1d(tilt, 0.1 * FPS, axis=0, mode="nearest")
    return Rotation.from_rotvec(tilt) * Rotation.from_rotvec(
        np.outer(h.trunk_gain * heading, [0.0, 1.0, 0.0])
    )


def _misjudged(rotations: Rotation, log_size: float) -> Rotation:
    """Turns and tilts of another size; half a turn is a landmark that nobody misses.

    With θ the angle from upright, it becomes θ + (size − 1) sin θ about the same axis.
    """
    vectors = rotations.as_rotvec()
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    axis = vectors / np.maximum(angle, 1e-9)
    return Rotation.from_rotvec(axis * (angle + (np.exp(log_size) - 1) * np.sin(angle)))


def _blurred(rotations: Rotation, seconds: float) -> Rotation:
    """Rotations without their quick detail."""
    q = rotations.as_quat()
    flips = np.cumprod(np.where(np.sum(q[1:] * q[:-1], axis=-1) < 0, -1.0, 1.0))
    q[1:] *= flips[:, None]
    return Rotation.from_quat(gaussian_filter1d(q, seconds * FPS, axis=0, mode="nearest"))


def _unsteady(n: int, span: tuple[int, int], h: Habits, rng: np.random.Generator) -> Rotation:
    """How the trunk strays: held crooked, drifting, shaking, jogged when it is taken and tilted when it is
    left."""
    crooked = h.tilt * rng.normal(size=3) * [1.0, 0.3, 1.0]
    away = h.drift * noise(n, 3, 1.5, rng) + h.shake * (noise(n, 3, 0.012, rng) - noise(n, 3, 0.03, rng))
    jog, leave = 0.5 * h.tilt * rng.normal(size=(2, 3))
    t = np.arange(n)[:, None]
    width = _SETTLE_S * FPS
    taken = np.exp(-0.5 * ((t - span[0]) / (0.5 * width)) ** 2)
    left = 1 / (1 + np.exp(-(t - span[1]) / (0.25 * width)))
    return Rotation.from_rotvec(np.radians(crooked + away + jog * taken + leave * left))


def carry(
    frames: Floats, clock: Floats, span: tuple[int, int], user: User, rng: np.random.Generator
) -> Floats:
    """The trunk's rotations while a clip is played.

    Parameters
    ----------
    frames : (T, 3, 3)
        The target's trunk, at 60 frames/s.
    clock : (N,)
        Clip frame that is played at each sample.
    span
        First and last sample in which hands are on the limbs.

    Returns
    -------
    (N, 3, 3) float64
        Yaw starts at 0.
    """
    h = user.habits
    turn = Rotation.from_matrix(frames)
    north = heading_and_tilt(frames[:1])[0][0]
    turn = Rotation.from_rotvec([0.0, -north, 0.0]) * turn  # where the clip begins is forward
    if h.blur_s and len(frames) > 1:
        turn = _blurred(turn, h.blur_s)
    turn = _misjudged(turn, _EASIER * (h.amplitude + h.amplitude_error * float(rng.normal())))
    if h.trunk_limit < 180.0:
        turn = _limited(turn, h)
    if len(frames) > 1:
        turn = Slerp(np.arange(len(frames)), turn)(np.clip(clock, 0, len(frames) - 1))
    else:
        turn = Rotation.concatenate([turn] * len(clock))
    carried = (turn * _unsteady(len(clock), span, h, rng)).as_matrix()
    yaw = yaw_pitch_roll(carried[:1])[0, 0]
    found: Floats = Rotation.from_rotvec([0.0, -yaw, 0.0]).as_matrix() @ carried
    return found
