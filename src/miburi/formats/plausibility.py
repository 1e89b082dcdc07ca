"""What is odd about a recording of a body: rest poses before it begins, a frame rate that cannot be right."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.motion import Floats, Motion

GRAVITY = 9.81

# Parts of the body: joints, share of the body's mass, where on the way from the one to the other their
# centre lies (Dempster's cadavers, after D. A. Winter, Biomechanics and Motor Control of Human Movement).
_PARTS = (
    ("neck", "head", 0.081, 1.0),
    ("waist", "neck", 0.497, 0.5),
    *(
        part
        for s in "lr"
        for part in (
            (f"{s}_shoulder", f"{s}_elbow", 0.028, 0.436),
            (f"{s}_elbow", f"{s}_hand", 0.022, 0.682),
            (f"{s}_hip", f"{s}_knee", 0.100, 0.433),
            (f"{s}_knee", f"{s}_foot", 0.061, 0.606),
        )
    ),
)

_LEADING_S, _SPEED, _FASTER = 0.1, 200.0, 3.0
"""A rest pose ends within these seconds; joints turn by so many degrees per second on the average, and by so
many times what is usual in the second that follows."""

_CLEAR, _FEWEST, _RISE = 0.04, 8, 0.02
"""Free flight: everything is so many metres above the ground, for so many frames, and the body's centre has
risen above the chord of its path by so many metres."""
_STRAIGHT, _SMOOTH = 0.12, 0.04
"""Free flight: sideways acceleration, as a share of that downwards; deviation from a parabola, as a share of
the rise."""
_RATE_RATIO = 1.25
"""Rates that differ by less are not told apart: people's masses and the recordings' noise."""


def rest_frames(motion: Motion) -> int:
    """Number of leading frames that are a rest pose which a program put before the motion.

    Public conversions often begin with one, which the motion then leaves in one step, or in a few where the
    conversion smoothed it: no joint could turn so fast, and none does soon after.

    Parameters
    ----------
    motion
        A take.

    Returns
    -------
    int
        Frames to leave out: as long as all joints that move turn, on the average, by more than 200° per
        second and by three times their median of the second that follows (or by nothing before that), for
        0.1 s at most; 0 where that does not end by then.
    """
    most = max(2, round(_LEADING_S * motion.fps))
    if len(motion) < 2 * most + 2:
        return 0
    q = motion.rotations[: most + round(motion.fps) + 2]
    cosine = np.abs(np.einsum("tja,tja->tj", q[1:], q[:-1]))
    step = np.degrees(2 * np.arccos(np.minimum(cosine, 1.0)))
    moving = step.max(axis=0) > 1e-4
    if not moving.any():
        return 0
    speed = step[:, moving].mean(axis=1) * motion.fps
    impossible = speed > max(_SPEED, _FASTER * float(np.median(speed[most:])))
    # a rest pose may stand for a few frames, all equal, before it is left
    possible = ~impossible & (speed > 1e-3)
    begin = int(np.argmax(possible)) if possible.any() else len(speed)
    left = np.flatnonzero(impossible[:begin])
    return int(left[-1]) + 1 if len(left) and begin <= most else 0


def _centre(motion: Motion, joints: Mapping[str, str] | None) -> tuple[Floats, Floats]:
    """Where the body's centre of mass is, (T, 3), and how high its lowest point, (T,)."""
    found = find_joints(motion.skeleton, joints)
    places = motion.positions()
    at = {name: places[:, j] for name, j in found.items()}
    at.setdefault("head", at["neck"])
    centre = sum(mass * ((1 - share) * at[a] + share * at[b]) for a, b, mass, share in _PARTS)
    lowest = places[:, :, 1].min(axis=1)
    if len(motion.skeleton.ends):
        lowest = np.minimum(lowest, motion.end_positions()[:, :, 1].min(axis=1))
    return np.asarray(centre) / sum(mass for *_, mass, _ in _PARTS), lowest


def flights(motion: Motion, joints: Mapping[str, str] | None = None) -> NDArray[np.float64]:
    """Free flights of a body and how it falls in them.

    Parameters
    ----------
    motion
        A take.
    joints
        As in `miburi.features`.

    Returns
    -------
    (N, 3) float64
        First frame, end (exclusive), and downward acceleration of the centre of mass in metres per second
        squared, by the take's own rate.

    Raises
    ------
    InputError
        The skeleton lacks a joint.

    Notes
    -----
    In a flight nothing touches the ground, the centre of mass moves along a parabola, and nothing pulls it
    sideways. The ground is the 5 % point of the lowest point's heights. What hangs, climbs, or is carried
    bends its path sideways or is no parabola.
    """
    centre, lowest = _centre(motion, joints)
    found = []
    if len(motion):
        air = lowest > np.percentile(lowest, 5) + _CLEAR
        edges = np.flatnonzero(np.diff(np.concatenate([[False], air, [False]]).astype(np.int8)))
        for before, after in edges.reshape(-1, 2):
            start, end = before + 1, after - 1
            n = end - start
            if n < _FEWEST or start < 2 or end > len(motion) - 2:
                continue
            t = (np.arange(n) - (n - 1) / 2) / motion.fps
            powers = np.stack([t**2, t, np.ones(n)], axis=1)
            path, *_ = np.linalg.lstsq(powers, centre[start:end], rcond=None)
            ax, ay, az = 2 * path[0]
            rise = -ay * (n / motion.fps) ** 2 / 8
            off = float(np.sqrt(np.mean((centre[start:end, 1] - powers @ path[:, 1]) ** 2)))
            if rise > _RISE and off < _SMOOTH * rise and np.hypot(ax, az) < -_STRAIGHT * ay:
                found.append((start, end, -ay))
    return np.array(found, dtype=np.float64).reshape(-1, 3)


def suspected_fps(motion: Motion, joints: Mapping[str, str] | None = None) -> float | None:
    """The frame rate at which a body would fall as bodies fall, where the take's own rate must be wrong.

    Parameters
    ----------
    motion
        A take.
    joints
        As in `miburi.features`.

    Returns
    -------
    float or None
        Frames per second, from the median of the take's flights (each counting by its frames), if it differs
        by more than a quarter from the take's rate; None if it does not, if nobody flies, or if the skeleton
        is not understood.
    """
    try:
        found = flights(motion, joints)
    except InputError:
        return None
    if not len(found):
        return None
    frames = (found[:, 1] - found[:, 0]).astype(np.int64)
    fall = float(np.median(np.repeat(found[:, 2], frames)))
    fps = motion.fps * float(np.sqrt(GRAVITY / fall))
    ratio = fps / motion.fps
    return round(fps, 1) if max(ratio, 1 / ratio) > _RATE_RATIO else None
