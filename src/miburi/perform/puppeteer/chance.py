"""Smooth noise."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import gaussian_filter1d

from miburi.motion import Floats

FPS = 60.0
"""Samples per second of the puppet's log ([P])."""


def noise(n: int, width: int, seconds: float, rng: np.random.Generator) -> Floats:
    """Smooth noise (n, width) of unit variance that changes over about `seconds`."""
    sigma = max(seconds * FPS, 0.5)
    margin = int(4 * sigma)
    white = gaussian_filter1d(rng.normal(size=(n + 2 * margin, width)), sigma, axis=0)
    steady: Floats = white[margin : margin + n] * np.sqrt(2 * np.sqrt(np.pi) * sigma)
    return steady
