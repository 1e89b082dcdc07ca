"""The glove as it is, which its calibration only nearly knows: angles in, whole counts out."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.motion import Floats
from miburi.perform.janken import FPS
from miburi.perform.janken.sensors import FINGER, FITTED, SENSORS

_HIGHEST = 255
_GAIN_ERROR = 0.02
"""Spread of the logarithm of true over calibrated degrees per count."""
_OFFSET_ERROR = 1.2
"""Counts by which the glove sits otherwise than when it was calibrated."""
_WARMING = (1.5, 40.0)
"""Counts, and seconds in which they fade: a glove that was just put on."""
_WALK = 0.7
"""Counts by which a sensor has drifted at the end of a recording."""
_NOISE = 0.05
"""Counts: a real glove's noise lies below a count."""
_PLAY = (0.8, 2.0)
"""Counts by which a finger moves inside the cloth before the sensor bends: a hold is one count throughout."""
_NEIGHBOUR = 0.012
"""Spread of what a sensor takes from its finger's other sensors."""
_PULL = (0.15, 0.3)
"""What an abduction takes of the difference between the bends of the two fingers that it lies between."""
_TILT = 0.25
"""What pulls an abduction pulls the next by this share, as both ride on one finger."""


class Device(NamedTuple):
    """A glove in a session.

    Parameters
    ----------
    gain, offset : (22,)
        Degrees per count, count at 0°.
    crosstalk : (22, 22)
        What each sensor takes from each other's angle; ones on the diagonal.
    play : (22,)
        Counts.
    """

    gain: Floats
    offset: Floats
    crosstalk: Floats
    play: Floats

    @staticmethod
    def drawn(seed: object) -> Device:
        """The glove of a session: a little beside its calibration."""
        rng = store.seed(seed, "janken", "device")
        n = len(SENSORS)
        gain = np.array([s.gain or 1.0 for s in SENSORS]) * np.exp(_GAIN_ERROR * rng.standard_normal(n))
        offset = np.array([s.offset for s in SENSORS], dtype=np.float64)
        offset[FITTED] += _OFFSET_ERROR * rng.standard_normal(int(FITTED.sum()))
        return Device(gain, offset, _crosstalk(rng), rng.uniform(*_PLAY, n))

    def read(self, angles: Floats, rng: np.random.Generator) -> NDArray[np.int64]:
        """Counts (T, 22), from 0 to 255, of angles (T, 22) in degrees."""
        t, n = angles.shape
        size, seconds = _WARMING
        warming = size * rng.standard_normal(n) * np.exp(-np.arange(t) / (seconds * FPS))[:, None]
        walk = np.cumsum(rng.standard_normal((t, n)), axis=0) * (_WALK / np.sqrt(t))
        counts = self.offset + (angles @ self.crosstalk.T) / self.gain + warming + walk
        counts = played(counts + _NOISE * rng.standard_normal((t, n)), self.play)
        counts[:, ~FITTED] = self.offset[~FITTED]
        return np.asarray(np.clip(np.rint(counts), 0, _HIGHEST), dtype=np.int64)


def played(x: Floats, play: Floats) -> Floats:
    """What comes through a joint with play: y_t = min(max(y_{t−1}, x_t − p/2), x_t + p/2), y_0 = x_0.

    Parameters
    ----------
    x : (T, n)
    play : (n,)
        Full width p.
    """
    y = np.array(x)
    for k in range(1, len(y)):
        y[k] = np.clip(y[k - 1], x[k] - play / 2, x[k] + play / 2)
    return y


def _crosstalk(rng: np.random.Generator) -> Floats:
    """What each sensor takes from the others: its finger's other sensors; for abductions the bends of the two
    fingers that they lie between (as real ones do when one finger is bent and its neighbour straight), and
    a share of what pulls the abduction beside them."""
    n = len(SENSORS)
    mix = np.eye(n)
    for k in range(n):
        same = (FINGER[k] == FINGER) & (np.arange(n) != k) & FITTED
        mix[k, same] += _NEIGHBOUR * rng.standard_normal(int(same.sum()))
    spreads = {10: (4, 7), 14: (7, 11), 18: (11, 15)}
    for spread, (near, far) in spreads.items():
        pull = rng.uniform(*_PULL)
        mix[spread, far] += pull
        mix[spread, near] -= pull
    mix[18] += _TILT * (mix[14] - np.eye(n)[14])
    return mix
