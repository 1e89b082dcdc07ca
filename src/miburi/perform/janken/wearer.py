"""A simulated glove wearer who shows rock, paper and scissors ([H], section on the experiment).

Nobody wore a glove. Every interval has the length that the label counts of [H]'s table 2 leave it; within it,
each sensor has its own onset, duration and skew of a minimum-jerk movement (Flash and Hogan 1985), opening
overshoots, holds sag back, habits and sensors drift, hands tremble. The glove that reads this is a little
off its calibration, mixes neighbouring sensors, saturates, and gives whole counts.

The 22 columns are in the order of the glove maker's kit without the absolute abduction of the index. Its four
sensors of the outermost finger joints are not fitted (they give one count throughout), as on an 18-sensor
glove: the calibration lets these joints follow the middle ones.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml
from numpy.typing import NDArray

from miburi import store
from miburi.formats import glove
from miburi.formats.annotations import Annotation, write_annotations
from miburi.formats.labels import Interval, write_labels
from miburi.motion import Floats
from miburi.perform.janken import COUNTS, FPS, RECORDINGS, SMALL, WEARER, alternation

_SHORTEST = {1: 5, 2: 6}  # frames: a hold, a change


class Sensor(NamedTuple):
    """A sensor of the glove: calibration, then the angle (degrees) it measures in rock, paper and scissors.

    `entry` is what the calibration says beside gain (degrees per count) and offset (count at 0°).
    """

    name: str
    gain: float
    offset: float
    entry: Mapping[str, Any]
    rock: float
    paper: float
    scissors: float


def _bend(joint: str, also: str = "") -> dict[str, Any]:
    entry: dict[str, Any] = {"joint": joint, "axis": "x"}
    return entry | {"also": [{"joint": also, "axis": "x", "factor": 0.62}]} if also else entry


def _spread(joints: Sequence[str], weights: Sequence[float]) -> dict[str, Any]:
    return {"joint": list(joints), "axis": "z", "weights": list(weights)}


_UNFITTED: Mapping[str, Any] = {}
_SENSORS = (
    Sensor("thumb roll", -0.6, 60, {"joint": "thumb1", "axis": "y"}, -84, -22, -96),
    Sensor("thumb MCP", 0.41, 70, _bend("thumb2"), 20, 4, 48),
    Sensor("thumb IP", 0.47, 58, _bend("thumb3"), 52, -6, 56),
    Sensor("thumb-index", 0.34, 150, {"joint": "thumb1", "axis": "z"}, -8, -12, -30),
    Sensor("index MCP", 0.66, 75, _bend("index1"), 74, -5, 4),
    Sensor("index PIP", 0.71, 62, _bend("index2", "index3"), 99, 3, 8),
    Sensor("index DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor("middle MCP", 0.62, 13, _bend("middle1"), 80, -6, 1),
    Sensor("middle PIP", 0.74, 58, _bend("middle2", "middle3"), 103, 2, 6),
    Sensor("middle DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor(
        "middle-index",
        0.27,
        84,
        _spread(("middle1", "index1", "ring1", "little1"), (0.4, -0.6, 0.4, 0.4)),
        2,
        11,
        22,
    ),
    Sensor("ring MCP", 0.68, 72, _bend("ring1"), 78, -4, 68),
    Sensor("ring PIP", 0.78, 54, _bend("ring2", "ring3"), 105, 3, 97),
    Sensor("ring DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor("ring-middle", 0.25, 90, _spread(("ring1", "little1"), (1.0, 1.0)), 1, 8, -4),
    Sensor("little MCP", 0.7, 78, _bend("little1"), 72, -3, 63),
    Sensor("little PIP", 0.75, 56, _bend("little2", "little3"), 101, 5, 92),
    Sensor("little DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor("little-ring", 0.31, 88, _spread(("little1",), (1.0,)), 2, 10, 3),
    Sensor("palm arch", 0.36, 100, _UNFITTED, 16, 4, 11),
    Sensor("wrist pitch", 0.55, 110, {"joint": "wrist", "axis": "x"}, -9, 5, -3),
    Sensor("wrist yaw", 0.48, 118, {"joint": "wrist", "axis": "z"}, 2, -3, 0),
)
NAMES = tuple(f"s{k:02d}" for k in range(1, len(_SENSORS) + 1))
_FITTED = np.array([s.gain != 0 for s in _SENSORS])
_POSES: Mapping[str, Floats] = {
    "r": np.array([s.rock for s in _SENSORS], dtype=np.float64),
    "p": np.array([s.paper for s in _SENSORS], dtype=np.float64),
    "s": np.array([s.scissors for s in _SENSORS], dtype=np.float64),
}
# Which finger a sensor rides on: 0 thumb … 4 little, 5 palm and wrist.
_FINGER = np.array([0] * 4 + [1] * 3 + [2] * 4 + [3] * 4 + [4] * 4 + [5] * 3)
_FINGERS = 6
_MIDDLE = np.array(["PIP" in s.name for s in _SENSORS])
_FLEXES = np.array(["MCP" in s.name or "PIP" in s.name for s in _SENSORS])
# Ring and little finger share tendons: what one does the other half does. Rows: finger; columns: its sources.
_COUPLED = np.eye(_FINGERS)
_COUPLED[2:5, 2:5] = [[0.95, 0.3, 0.0], [0.2, 0.8, 0.57], [0.0, 0.6, 0.8]]


def calibration() -> dict[str, dict[str, Any]]:
    """The wearer's calibration: sensor → gain (degrees per count), offset (count), joint, axis; {}: no joint.

    Returns
    -------
    dict
        As `miburi.formats.glove` describes it under `sensors`.
    """
    return {
        name: {"gain": s.gain, "offset": s.offset, **s.entry} if s.entry else {}
        for name, s in zip(NAMES, _SENSORS, strict=True)
    }


def perform(seed: int, *, small: bool = False) -> dict[str, tuple[NDArray[np.int64], list[Interval]]]:
    """The three recordings of a simulated glove wearer.

    Parameters
    ----------
    seed
        Another seed is another session of the same wearer.
    small
        About 40 % of each recording, for trying and testing.

    Returns
    -------
    dict of (counts, labels)
        By take: counts (T, 22) from 0 to 255 at 30 frames/s, and intervals (start, end, label), end
        exclusive, that cover every frame. In all 4197 frames and 245 intervals, those of [H]'s table 2
        label by label (not small).
    """
    lengths = {label: iter(_lengths(seed, label)) for label in COUNTS}
    device = _Device.drawn(seed)
    recordings = {}
    for take in RECORDINGS:
        labels = alternation(take)
        ends = np.cumsum([next(lengths[label]) for label in labels])
        starts = np.concatenate([[0], ends[:-1]])
        intervals = [(int(s), int(e), n) for s, e, n in zip(starts, ends, labels, strict=True)]
        angles = _angles(intervals, store.seed(seed, "janken", take, "hand"))
        counts = device.read(angles, store.seed(seed, "janken", take, "glove"))
        if small:
            intervals = intervals[: 2 * SMALL - 1]
            counts = counts[: intervals[-1][1]]
        recordings[take] = counts, intervals
    return recordings


def write(folder: str | os.PathLike[str], seed: int, *, small: bool = False) -> list[Path]:
    """Write the recordings: `{take}.csv`, `{take}.lab`, `wearer.yaml` and `annotations.tsv`.

    Returns
    -------
    list of Path
        What was written.
    """
    home = Path(folder)
    rows, written = [], []
    for take, (counts, labels) in perform(seed, small=small).items():
        log, lab = home / f"{take}.csv", home / f"{take}.lab"
        glove.write_log(log, counts, FPS, sensors=NAMES, simulated=True)
        write_labels(lab, labels, fps=FPS)
        rows += [Annotation(take, s / FPS, e / FPS, label) for s, e, label in labels]
        written += [log, lab]
    body = yaml.safe_dump({"sensors": calibration()}, sort_keys=False, default_flow_style=None, width=160)
    store.write_text(home / f"{WEARER}.yaml", f"# miburi glove calibration 1, simulated=1\n{body}")
    write_annotations(home / "annotations.tsv", rows)
    return [*written, home / f"{WEARER}.yaml", home / "annotations.tsv"]


def _lengths(seed: int, label: str) -> list[int]:
    """Lengths of a label's intervals, frames: log-normal, slowly wandering tempo, the sum of table 2
    exactly."""
    frames, intervals = COUNTS[label]
    rng = store.seed(seed, "janken", "lengths", label)
    tempo = _wander(rng, intervals, 0.75)
    raw = np.exp(0.38 * (0.5 * tempo + 0.87 * rng.standard_normal(intervals)))
    least = _SHORTEST[len(label)]
    exact = least + raw / raw.sum() * (frames - least * intervals)
    whole = np.floor(exact).astype(np.int64)
    whole[np.argsort(whole - exact, kind="stable")[: frames - whole.sum()]] += 1  # largest remainders
    return [int(n) for n in whole]


def _wander(rng: np.random.Generator, n: int, memory: float) -> Floats:
    """A first-order autoregression of unit variance: (n,)."""
    from scipy.signal import lfilter

    noise = rng.standard_normal(n)
    noise[1:] *= np.sqrt(1 - memory**2)
    return np.asarray(lfilter([1.0], [1.0, -memory], noise))


def _minimum_jerk(phase: Floats) -> Floats:
    """Share of the way at a share of the time (Flash and Hogan 1985): 10 u³ − 15 u⁴ + 6 u⁵."""
    u = np.clip(phase, 0.0, 1.0)
    return u**3 * (10 - 15 * u + 6 * u**2)


def _settling(frames: Floats, time: Floats | float) -> Floats:
    """From 1 to 0 without a kink, critically damped, within a few `time`."""
    x = np.maximum(frames, 0.0) / time
    return (1 + x) * np.exp(-x)


def _targets(holds: Sequence[str], rng: np.random.Generator) -> Floats:
    """The pose of each hold, (K, 22) degrees: habits of the hand, its fingers and each joint wander from
    hold to hold."""
    n = len(holds)
    poses = np.stack([_POSES[h] for h in holds])
    hand = _wander(rng, n, 0.6)[:, None]
    fingers = np.stack([_wander(rng, n, 0.5) for _ in range(_FINGERS)], axis=1) @ _COUPLED.T
    joints = np.stack([_wander(rng, n, 0.4) for _ in _SENSORS], axis=1)
    closed = np.array([h == "r" for h in holds])[:, None]
    # a fist ends at the palm, so it varies less than an open hand
    size = np.where(_FLEXES, np.where(closed, 2.4, np.where(_MIDDLE, 3.6, 5.0)), 2.0)
    return poses + size * (0.5 * hand + 0.8 * fingers[:, _FINGER] + 0.8 * joints)


def _angles(intervals: Sequence[Interval], rng: np.random.Generator) -> Floats:
    """What the sensors would measure of the hand: (T, 22) degrees."""
    frames = np.arange(intervals[-1][1], dtype=np.float64)[:, None, None]
    targets = _targets([n for _, _, n in intervals[0::2]], rng)
    changes = intervals[1::2]
    begin, length, skew = _timing(changes, rng)
    steps = np.diff(targets, axis=0)
    phase = np.clip((frames - begin) / length, 0.0, 1.0) ** skew
    way = _minimum_jerk(phase)  # (T, K − 1, 22)
    angles = targets[0] + np.sum(way * steps, axis=1)

    # After a change the hand is a little beyond the pose and settles; as the hold goes on it sags towards
    # rest.
    opening = np.where(_FLEXES & (steps < -30), 1.0, 0.0)
    beyond = steps * (0.03 + 0.04 * opening) * rng.gamma(4.0, 0.25, steps.shape)
    settle = rng.uniform(4.0, 8.0, steps.shape)
    rest = 0.7 * _POSES["p"] + 0.3 * _POSES["r"]
    sag = 0.07 * (rest - targets[1:]) * rng.gamma(3.0, 1 / 3, steps.shape)
    since = frames - (begin + 0.8 * length)
    held = beyond * _settling(since, settle) * _minimum_jerk((phase - 0.35) / 0.65)
    held += sag * (1 - _settling(since, 22.0)) * (since > 0)
    held[:, :-1] *= 1 - way[:, 1:]  # the next change takes the sag with it
    angles += held.sum(axis=1)
    return np.asarray(angles + _tremor(len(angles), rng))


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
    habit = np.array([0.05, 0.10, 0.04, -0.04, -0.07, 0.0])
    order = np.where(closing, -habit, habit) + 0.045 * rng.standard_normal((k, _FINGERS)) @ _COUPLED.T
    lead = np.where(closing & _MIDDLE, -0.03, np.where(_MIDDLE, 0.03, 0.0))
    late = order[:, _FINGER] + lead + 0.02 * rng.standard_normal((k, len(_SENSORS)))
    onset = np.clip(0.11 + late, -0.05, 0.32)
    share = rng.normal(0.73, 0.05, (k, 1)) + 0.05 * rng.standard_normal((k, _FINGERS))[:, _FINGER]
    share = np.minimum(np.clip(share, 0.58, 0.9), 1.04 - onset)
    skew = np.exp(rng.normal(0.0, 0.1, (k, 1)) + rng.normal(0.0, 0.06, (k, len(_SENSORS))))
    eye = rng.normal(0.0, 0.5, (k, 1))  # a labeller's half frame
    return start + eye + onset * span, share * span, skew


def _tremor(frames: int, rng: np.random.Generator) -> Floats:
    """Physiological tremor (6-12 Hz, about 0.1°) and slow unrest (below 1 Hz, about 0.5°): (T, 22)
    degrees."""
    from scipy.signal import butter, sosfilt

    noise = rng.standard_normal((frames + 120, _FINGERS)) @ _COUPLED.T
    own = rng.standard_normal((frames + 120, len(_SENSORS)))
    both = noise[:, _FINGER] + 0.6 * own
    fast = sosfilt(butter(2, (6.0, 12.0), "bandpass", fs=FPS, output="sos"), both, axis=0)[120:]
    slow = sosfilt(butter(2, 0.7, "lowpass", fs=FPS, output="sos"), both, axis=0)[120:]
    slow *= 0.45 / max(float(slow.std()), 1e-9)
    return np.asarray(0.12 * fast + slow)


class _Device(NamedTuple):
    """The glove as it is, which its calibration only nearly knows."""

    gain: Floats
    offset: Floats
    crosstalk: Floats

    @staticmethod
    def drawn(seed: int) -> _Device:
        """The glove of a session: gains 2 % and offsets 1.5 counts beside the calibration."""
        rng = store.seed(seed, "janken", "device")
        n = len(_SENSORS)
        gain = np.array([s.gain or 1.0 for s in _SENSORS]) * np.exp(0.02 * rng.standard_normal(n))
        offset = np.array([s.offset for s in _SENSORS]) + np.where(_FITTED, 1.5 * rng.standard_normal(n), 0.0)
        return _Device(gain, offset, _crosstalk(rng))

    def read(self, angles: Floats, rng: np.random.Generator) -> NDArray[np.int64]:
        """Counts (T, 22) of angles (T, 22)."""
        t, n = angles.shape
        warming = 2.5 * rng.standard_normal(n) * np.exp(-np.arange(t) / (40 * FPS))[:, None]
        walk = np.cumsum(rng.standard_normal((t, n)), axis=0) * (0.8 / np.sqrt(t))
        noise = 0.16 * rng.standard_normal((t, n))  # below a count
        counts = self.offset + (angles @ self.crosstalk.T) / self.gain + warming + walk + noise
        counts[:, ~_FITTED] = self.offset[~_FITTED]
        return np.asarray(np.clip(np.rint(counts), 0, 255), dtype=np.int64)


def _crosstalk(rng: np.random.Generator) -> Floats:
    """What each sensor takes from the others, (22, 22): its finger's other sensors, and for abductions the
    bends of the two fingers that they lie between (as real ones do when one finger is bent and its
    neighbour straight)."""
    n = len(_SENSORS)
    mix = np.eye(n)
    for k in range(n):
        same = (_FINGER[k] == _FINGER) & (np.arange(n) != k) & _FITTED
        mix[k, same] += 0.012 * rng.standard_normal(int(same.sum()))
    for spread, (near, far) in {10: (4, 7), 14: (7, 11), 18: (11, 15)}.items():
        pull = rng.uniform(0.04, 0.08)
        mix[spread, far] += pull
        mix[spread, near] -= pull
    return mix
