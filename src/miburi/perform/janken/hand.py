"""How the simulated wearer's hand goes from pose to pose.

Each finger has its own onset, duration and skew of a minimum-jerk movement (Flash and Hogan 1985), some with a
second, corrective one; neighbours drag each other along, opening overshoots, an open hand that was stretched
relaxes of a sudden, holds sag, habits wander, hands tremble.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from miburi.formats.labels import Interval
from miburi.motion import Floats
from miburi.perform.janken import FPS
from miburi.perform.janken.sensors import FINGER, FINGERS, FLEXES, KNUCKLE, MIDDLE, POSES, SENSORS

_COUPLED = np.eye(FINGERS)
_COUPLED[2:5, 2:5] = [[0.95, 0.3, 0.0], [0.2, 0.8, 0.57], [0.0, 0.6, 0.8]]
"""Habits of ring and little finger go together. Rows: finger; columns: its sources; about unit variance."""
_DRAGGED = np.eye(FINGERS)
_DRAGGED[1:5, 1:5] = [
    [0.92, 0.08, 0.00, 0.00],
    [0.08, 0.74, 0.18, 0.00],
    [0.00, 0.22, 0.52, 0.26],
    [0.00, 0.00, 0.32, 0.68],
]
"""How far each finger is on its way: shares of its own will and its neighbours'. Thumb, index and little finger
are more their own than middle and ring finger (Häger-Ross and Schieber 2000)."""
_ALONE = 35.0
"""Degrees by which the ring finger can be straighter than the mean of its neighbours: their tendons are joined."""
_VARIES = {"closed": 2.4, "open knuckle": 7.0, "open middle": 8.0, "other": 2.0}
"""Degrees by which poses differ from hold to hold; a fist ends at the palm, so it varies less."""
_RELAXES = 0.35
"""Chance that an open hand was stretched too far and relaxes within the hold."""
_STRETCHED = 11.0
"""Degrees, at the knuckles; the middle joints have `_LESS` of it."""
_LESS = 0.4
_STOPS = {"knuckle": (-18.0, 20.0), "middle": (-8.0, 14.0)}
"""Degrees from which on a stretched joint resists, and the most by which it goes beyond."""
_CORRECTED = 0.3
"""Chance that a finger makes the last part of its way in a second movement."""


def wander(rng: np.random.Generator, n: int, memory: float) -> Floats:
    """A first-order autoregression of unit variance: (n,)."""
    from scipy.signal import lfilter

    noise = rng.standard_normal(n)
    noise[1:] *= np.sqrt(1 - memory**2)
    return np.asarray(lfilter([1.0], [1.0, -memory], noise))


def minimum_jerk(phase: Floats) -> Floats:
    """Share of the way at a share of the time (Flash and Hogan 1985): 10 u³ − 15 u⁴ + 6 u⁵."""
    u = np.clip(phase, 0.0, 1.0)
    return u * u * u * (10 - 15 * u + 6 * u * u)


def _settling(frames: Floats, time: Floats | float) -> Floats:
    """From 1 to 0 without a kink, critically damped, within a few `time`."""
    x = np.maximum(frames, 0.0) / time
    return (1 + x) * np.exp(-x)


def together(angles: Floats) -> Floats:
    """Hold the ring finger back: it cannot extend alone.

    Parameters
    ----------
    angles : (..., 22)
        Degrees.

    Returns
    -------
    (..., 22)
        Each bend of the ring finger is at least the mean of its neighbours' less 35°.
    """
    out = angles.copy()
    for middle, ring, little in ((7, 11, 15), (8, 12, 16)):
        least = 0.5 * (angles[..., middle] + angles[..., little]) - _ALONE
        out[..., ring] = np.maximum(angles[..., ring], least)
    return out


def _resisted(angles: Floats) -> Floats:
    """Angles (..., 22) of joints that yield ever less the further they are stretched."""
    out = angles.copy()
    for joints, (limit, beyond) in ((KNUCKLE, _STOPS["knuckle"]), (MIDDLE, _STOPS["middle"])):
        x = angles[..., joints]
        out[..., joints] = np.where(x < limit, limit + beyond * np.tanh((x - limit) / beyond), x)
    return out


def _targets(holds: Sequence[str], rng: np.random.Generator) -> Floats:
    """The pose of each hold, (K, 22) degrees: habits of the hand, its fingers and each joint wander from
    hold to hold."""
    n = len(holds)
    poses = np.stack([POSES[h] for h in holds])
    hand = wander(rng, n, 0.6)[:, None]
    fingers = np.stack([wander(rng, n, 0.5) for _ in range(FINGERS)], axis=1) @ _COUPLED.T
    joints = np.stack([wander(rng, n, 0.4) for _ in SENSORS], axis=1)
    bent = poses > 30
    opened = np.where(MIDDLE, _VARIES["open middle"], _VARIES["open knuckle"])
    size = np.where(FLEXES, np.where(bent, _VARIES["closed"], opened), _VARIES["other"])
    return together(poses + size * (0.6 * hand + 0.7 * fingers[:, FINGER] + 0.5 * joints))


def movement(intervals: Sequence[Interval], rng: np.random.Generator) -> Floats:
    """What the sensors would measure of the hand.

    Parameters
    ----------
    intervals
        Hold, change, hold … without gaps from frame 0 on.

    Returns
    -------
    (T, 22) float64
        Degrees at 30 frames/s.
    """
    frames = np.arange(intervals[-1][1], dtype=np.float64)[:, None, None]
    targets = _targets([n for _, _, n in intervals[0::2]], rng)
    begin, length, skew = _timing(intervals[1::2], rng)
    steps = np.diff(targets, axis=0)
    phase = np.clip((frames - begin) / length, 0.0, 1.0) ** skew
    way = _ways(phase, rng)  # (T, K − 1, 22)
    angles = targets[0] + np.sum(way * steps, axis=1)

    # After a change the hand is a little beyond the pose and settles, mostly by little and at times by much;
    # as the hold goes on it sags towards rest.
    opening = np.where(FLEXES & (steps < -30), 1.0, 0.0)
    beyond = steps * (0.02 + 0.05 * opening) * rng.gamma(1.2, 1 / 1.2, steps.shape)
    settle = rng.uniform(2.0, 5.0, steps.shape)
    rest = 0.7 * POSES["p"] + 0.3 * POSES["r"]
    sag = 0.03 * (rest - targets[1:]) * rng.gamma(2.0, 0.5, steps.shape)
    since = frames - (begin + 0.8 * length)
    held = beyond * _settling(since, settle) * minimum_jerk((phase - 0.35) / 0.65)
    held += sag * (1 - _settling(since, 22.0)) * (since > 0)
    held += _stretched(intervals[2::2], targets[1:], frames, rng) * way
    held[:, :-1] *= 1 - way[:, 1:]  # the next change takes the sag with it
    angles += held.sum(axis=1)
    return together(_resisted(angles + _tremor(len(angles), rng)))


def _ways(phase: Floats, rng: np.random.Generator) -> Floats:
    """How far each sensor is on each way, (T, K, 22), from 0 to 1: neighbouring fingers drag each other, and
    some fingers come to a halt and make the rest in a second movement."""
    k = phase.shape[1]
    rest = np.where(rng.random((k, FINGERS)) < _CORRECTED, rng.uniform(0.08, 0.25, (k, FINGERS)), 0.0)
    first = minimum_jerk(phase / (1 - 1.2 * rest[:, FINGER]))
    way = (1 - rest[:, FINGER]) * first + rest[:, FINGER] * minimum_jerk((phase - 0.55) / 0.45)
    return _dragged(way)


def _dragged(way: Floats) -> Floats:
    """Ways (..., 22): each sensor's becomes its finger's shares (`_DRAGGED`) of the fingers' mean ways, plus what
    it differs from its own finger's mean."""
    member = (FINGER[:, None] == np.arange(FINGERS)).astype(np.float64)
    mean = member / member.sum(axis=0)
    mixed = way + (way @ mean) @ (_DRAGGED.T - np.eye(FINGERS)) @ member.T
    return np.asarray(np.clip(mixed, 0.0, 1.0))


def _stretched(
    holds: Sequence[Interval], targets: Floats, frames: Floats, rng: np.random.Generator
) -> Floats:
    """Straight fingers that are stretched beyond the pose and relax of a sudden: (T, K, 22) degrees."""
    k = len(holds)
    start = np.array([s for s, _, _ in holds], dtype=np.float64)[:, None]
    span = np.array([e - s for s, e, _ in holds], dtype=np.float64)[:, None]
    happens = (rng.random((k, 1)) < _RELAXES) & (span > 10)
    fingers = rng.gamma(4.0, 0.25, (k, FINGERS)) @ (_COUPLED / _COUPLED.sum(axis=1, keepdims=True)).T
    size = _STRETCHED * rng.gamma(3.0, 1 / 3, (k, 1)) * fingers[:, FINGER]
    size = np.where(KNUCKLE, size, np.where(MIDDLE, _LESS * size, 0.0))
    size = np.where(happens & (targets < 30), size, 0.0)
    when = start + span * (0.2 + 0.4 * rng.random((k, 1))) + rng.standard_normal((k, FINGERS))[:, FINGER]
    lasts = np.minimum(rng.uniform(4.0, 9.0, (k, 1)), 0.35 * span)
    return -size * (1 - minimum_jerk((frames - when) / lasts))


def _timing(changes: Sequence[Interval], rng: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Onset and duration (frames) and skew of each change and sensor, each (K, 22).

    The labelled interval holds the whole change but for the first and last percents of its way, as one
    labels by eye. Fingers start one after the other in an order that is the wearer's habit, with
    exceptions; within a finger the middle joint leads a little when the hand closes.
    """
    k = len(changes)
    start = np.array([s for s, _, _ in changes], dtype=np.float64)[:, None]
    span = np.array([e - s for s, e, _ in changes], dtype=np.float64)[:, None]
    closing = np.array([n[1] == "r" for _, _, n in changes])[:, None]
    habit = np.array([0.05, 0.12, 0.04, -0.05, -0.11, 0.0])
    order = np.where(closing, -habit, habit) + 0.055 * rng.standard_normal((k, FINGERS)) @ _COUPLED.T
    lead = np.where(closing & MIDDLE, -0.03, np.where(MIDDLE, 0.03, 0.0))
    late = order[:, FINGER] + lead + 0.02 * rng.standard_normal((k, len(SENSORS)))
    onset = np.clip(0.11 + late, -0.05, 0.32)
    share = rng.normal(0.73, 0.05, (k, 1)) + 0.05 * rng.standard_normal((k, FINGERS))[:, FINGER]
    share = np.minimum(np.clip(share, 0.58, 0.9), 1.04 - onset)
    skew = np.exp(rng.normal(0.0, 0.1, (k, 1)) + rng.normal(0.0, 0.06, (k, len(SENSORS))))
    eye = rng.normal(0.0, 0.5, (k, 1))  # a labeller's half frame
    return start + eye + onset * span, share * span, skew


def _tremor(frames: int, rng: np.random.Generator) -> Floats:
    """Physiological tremor (6-12 Hz, about 0.1°) and slow unrest (below 1 Hz, about 0.4°) of the bends;
    the rest moves a little less: (T, 22) degrees."""
    from scipy.signal import butter, sosfilt

    noise = rng.standard_normal((frames + 120, FINGERS)) @ _COUPLED.T
    own = rng.standard_normal((frames + 120, len(SENSORS)))
    both = noise[:, FINGER] + 0.6 * own
    fast = sosfilt(butter(2, (6.0, 12.0), "bandpass", fs=FPS, output="sos"), both, axis=0)[120:]
    slow = sosfilt(butter(2, 0.7, "lowpass", fs=FPS, output="sos"), both, axis=0)[120:]
    slow *= 0.4 / max(float(slow.std()), 1e-9)
    return np.asarray((0.12 * fast + slow) * np.where(FLEXES, 1.0, 0.8))
