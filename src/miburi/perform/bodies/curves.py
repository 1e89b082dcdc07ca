"""Tracks of keys as curves, and the slow noise that lies on them."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from miburi.motion import Floats
from miburi.perform.bodies.score import Key

RATE = 60.0
"""Frames per second of what is computed; the double rate is interpolated."""

_BEND = 0.8  # of the second difference of keys that are passed through


def _slopes(keys: list[Key]) -> tuple[Floats, Floats]:
    """Speed and acceleration at each key: its own; none at a rest; where it is passed through, of the parabola
    through it and its neighbours."""
    values = np.array([k.value for k in keys])
    speeds, bends = np.zeros_like(values), np.zeros_like(values)
    for i, key in enumerate(keys):
        if key.speed is not None:
            speeds[i] = key.speed
            bends[i] = 0.0 if key.bend is None else key.bend
        elif key.through and 0 < i < len(keys) - 1 and keys[i - 1].frame == key.frame == keys[i + 1].frame:
            before, after = max(key.t - keys[i - 1].t, 1e-3), max(keys[i + 1].t - key.t, 1e-3)
            came, goes = (values[i] - values[i - 1]) / before, (values[i + 1] - values[i]) / after
            if key.even:
                speeds[i] = (after * came + before * goes) / (before + after)
                bends[i] = _BEND * 2 * (goes - came) / (before + after)
            else:
                speeds[i] = (values[i + 1] - values[i - 1]) / (before + after)
    return speeds, bends


def _weights(keys: list[Key], i: int, t: Floats) -> Floats:
    """Weights (T, 5) of the way to the next key, both keys' speeds and both keys' accelerations.

    The quintic with given places, speeds and accelerations; between two rests it is the minimum-jerk movement.
    """
    span = keys[i + 1].t - keys[i].t
    u = np.clip((t - keys[i].t) / span, 0.0, 1.0)
    u3 = u * u * u
    square = span * span
    return np.stack(
        [
            u3 * (10 + u * (6 * u - 15)),
            span * (u - u3 * (6 + u * (3 * u - 8))),
            span * u3 * (-4 + u * (7 - 3 * u)),
            square * 0.5 * u * u * (1 - u) ** 3,
            square * 0.5 * u3 * (1 - u) ** 2,
        ],
        axis=1,
    )


def curve(keys: list[Key], t: Floats) -> Floats:
    """A track whose keys lie in one frame, at times (T,): (T, D)."""
    values = np.array([k.value for k in keys])
    speeds, bends = _slopes(keys)
    result = np.repeat(values[-1:], len(t), axis=0)
    edges = np.searchsorted(t, [k.t for k in keys])
    result[: edges[0]] = values[0]
    for i in range(len(keys) - 1):
        if edges[i] == edges[i + 1]:
            continue
        rows = slice(edges[i], edges[i + 1])
        parts = np.stack([values[i + 1] - values[i], speeds[i], speeds[i + 1], bends[i], bends[i + 1]])
        result[rows] = values[i] + (_weights(keys, i, t[rows]) @ parts if parts.any() else 0.0)
    return result


def framed(
    keys: list[Key], t: Floats, frames: dict[str, tuple[Floats, Floats]], arcs: Floats, mirror: float
) -> Floats:
    """A track whose keys lie in frames that move, as places in the world (T, 3).

    `frames` holds origins (T, 3) and axes (T, 3, 3), scaled; `mirror` turns outwards into left; `arcs` is the
    frame of the ways' bends.
    """

    def place(k: Key, rows: slice) -> Floats:
        value = np.array(k.value)
        if k.frame == "world":
            return np.repeat(value[None], len(t[rows]), axis=0)
        origin, axes = frames[k.frame]
        moving: Floats = origin[rows] + axes[rows] @ (value * [mirror, 1.0, 1.0])
        return moving

    speeds, bends = _slopes(keys)
    result = place(keys[-1], slice(0, len(t)))
    edges = np.searchsorted(t, [k.t for k in keys])
    for i in range(len(keys) - 1):
        if edges[i] == edges[i + 1]:
            continue
        rows = slice(edges[i], edges[i + 1])
        weight = _weights(keys, i, t[rows])
        there = weight[:, :1]
        one, two = place(keys[i], rows), place(keys[i + 1], rows)
        joint = {keys[i].frame, keys[i + 1].frame} - {"world"}
        if joint in ({"hip"}, {"arm"}) and "world" in (keys[i].frame, keys[i + 1].frame):
            result[rows] = _round(one, two, there, frames[joint.pop()][0][rows])
        else:
            result[rows] = (1 - there) * one + there * two
        for column, slope, k in ((1, speeds, i), (2, speeds, i + 1), (3, bends, i), (4, bends, i + 1)):
            if slope[k].any():
                own = keys[k].frame == "world"
                axes = np.eye(3) if own else frames[keys[k].frame][1][rows]
                result[rows] += weight[:, column : column + 1] * (
                    axes @ (slope[k] * [1.0 if own else mirror, 1.0, 1.0])
                )
        if any(keys[i + 1].arc):
            bend = 16 * there**2 * (1 - there) ** 2
            result[rows] += bend * (arcs[rows] @ (np.array(keys[i + 1].arc) * [mirror, 1.0, 1.0]))
    return result


def _round(a: Floats, b: Floats, there: Floats, joint: Floats) -> Floats:
    """Part of the way from a to b (T, 3), round a limb's first joint rather than through it."""
    one, two = a - joint, b - joint
    far, near = (np.maximum(np.linalg.norm(v, axis=1, keepdims=True), 1e-6) for v in (one, two))
    one, two = one / far, two / near
    angle = np.arccos(np.clip(np.sum(one * two, axis=1, keepdims=True), -0.98, 1.0)) + 1e-6
    way = (np.sin((1 - there) * angle) * one + np.sin(there * angle) * two) / np.sin(angle)
    length = np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 0.05)
    result: Floats = joint + ((1 - there) * far + there * near) * way / length
    return result


def unrest(rng: np.random.Generator, frames: int, width: int, hz: float) -> Floats:
    """Noise (frames, width) of variance one below a frequency."""
    sigma = RATE / (2 * np.pi * hz)
    pad = int(4 * sigma) + 1
    noise = gaussian_filter1d(rng.standard_normal((frames + 2 * pad, width)), sigma, axis=0, mode="nearest")
    result: Floats = noise[pad : pad + frames] * np.sqrt(2 * np.sqrt(np.pi) * sigma)
    return result


def lower(a: Floats, b: Floats, soft: float = 0.006) -> Floats:
    """The smaller of two, without a corner."""
    return -soft * np.logaddexp(-a / soft, -b / soft)
