"""Durations and trajectory together: [H], eq. 18 with a finite weight α of the durations."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi.errors import InputError
from miburi.hmm import solver
from miburi.hmm.generation import steps_of
from miburi.hmm.windows import Floats, Half, windows

_PASSES = 100  # over all durations, at most
_NEAR = 3  # states between which frames are exchanged
_SIZES = (1, -1, 2, -2, 4, -4)  # frames at a time
_SAME = 1e-9  # a smaller gain is rounding


class Staircase(NamedTuple):
    """Gaussians of a string's states, (S, 3 M) each, and of their durations, (S,) each, frames and frames²."""

    mean: Floats
    variance: Floats
    lasting: Floats
    spread: Floats


def joint_score(stairs: Staircase, frames: NDArray[np.int64], alpha: float, half: Half = (1, 1)) -> float:
    """α log p(durations) + log p(trajectory and deltas | durations), of the likeliest trajectory ([H], eq. 18).

    Durations that do not vary (σ² = 0) have no density and do not count.
    """
    step, window = steps_of(len(frames), frames), windows(half)
    x, _ = solver.trajectory(stairs.mean, stairs.variance, step, *window)
    density = float(solver.log_density(x, stairs.mean, stairs.variance, step, *window).sum())
    varies = stairs.spread > 0.0
    d, m, v = frames[varies], stairs.lasting[varies], stairs.spread[varies]
    return alpha * float(-0.5 * (np.log(2.0 * np.pi * v) + (d - m) ** 2 / v).sum()) + density


def joint_durations(
    stairs: Staircase,
    start: NDArray[np.int64],
    alpha: float,
    *,
    half: Half = (1, 1),
) -> NDArray[np.int64]:
    """Frames of each state that, with their trajectory, are likeliest among those of the same length ([H], eq. 18).

    Parameters
    ----------
    stairs
        The string's states.
    start : (S,)
        Where the search begins: the paper's answer, eq. 20, which a large α leaves as it is.
    alpha
        Weight of the durations, above 0.

    Returns
    -------
    (S,)
        With the sum of `start`. No one, two or four frames given by one state to another within three make it
        likelier: the best that is near, which need not be the best of all. States whose durations do
        not vary keep them.

    Raises
    ------
    InputError
        α is not above 0.

    Notes
    -----
    The length is not searched: densities of trajectories of different lengths are densities in spaces of different
    dimension, and which is larger depends on the unit. Searched all the same, a hand of 48 angles, some of whose
    sensors are dead, would never end.
    """
    if not (np.isfinite(alpha) and alpha > 0.0):
        raise InputError(f"alpha is {alpha}, expected a number above 0")
    frames = start.copy()
    best = joint_score(stairs, frames, alpha, half)
    moves = _moves(stairs.spread > 0.0)
    for _ in range(_PASSES):
        before = best
        for move in moves:
            while True:  # as far as it helps
                other = frames + move
                if other.min() < 1 or (score := joint_score(stairs, other, alpha, half)) <= best + _SAME:
                    break
                frames, best = other, score
        if best <= before + _SAME:
            break
    return frames


def _moves(varies: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Changes of durations that are tried: some frames of one state for another, near one."""
    one = np.eye(len(varies), dtype=np.int64)
    pairs = [
        (i, j)
        for distance in range(1, _NEAR + 1)
        for i, j in zip(range(len(varies)), range(distance, len(varies)), strict=False)
        if varies[i] and varies[j]
    ]
    return [size * (one[i] - one[j]) for i, j in pairs for size in _SIZES]
