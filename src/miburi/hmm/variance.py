"""Global variance: trajectories that move as much as the recordings do (Toda and Tokuda, IEICE E90-D, 2007)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.hmm import solver
from miburi.hmm.model import Model
from miburi.hmm.windows import Floats, Half, windows

DRAWS = 200
"""Renderings of a string that its variance is counted over."""
LEAST_LABELS = 3
LEAST_INTERVALS = 2
_HALVINGS = 50
_STILL = 1e-6  # a feature whose variance is below this share of the largest is left alone


class Spread(NamedTuple):
    """Variance over all frames of a string, as the recordings have it: mean and variance over renderings, (M,)."""

    mean: Floats
    variance: Floats


def expected_spread(
    chain: Sequence[Model], frames: NDArray[np.int64], seed: int | Sequence[int] = 0
) -> Spread:
    """How much a string varies if each label is one of its recorded intervals, drawn at random.

    Parameters
    ----------
    chain
        The models of the string's labels, which know their intervals' moments.
    frames : (P,)
        Frames of each label: an interval counts as if it were that long.
    seed
        Of the draw.

    Raises
    ------
    InputError
        A model does not know its intervals.
    """
    rng = np.random.default_rng(seed)
    first = second = np.zeros(1)
    for model, share in zip(chain, frames / frames.sum(), strict=True):
        if model.interval_mean is None or model.interval_square is None:
            raise InputError(f"model {model.label!r} does not know its intervals; train it anew")
        drawn = rng.integers(len(model.interval_mean), size=DRAWS)
        first = first + share * model.interval_mean[drawn]
        second = second + share * model.interval_square[drawn]
    v = np.maximum(second - first**2, 0.0)
    return Spread(v.mean(axis=0), v.var(axis=0))


def why_not(chain: Sequence[Model]) -> str:
    """Why a string has no global variance worth the name; empty: it has."""
    if len(chain) < LEAST_LABELS:
        return f"the string has {len(chain)} labels, expected {LEAST_LABELS} or more"
    if few := next((m for m in chain if m.intervals < LEAST_INTERVALS), None):
        return f"label {few.label!r} has {few.intervals} interval, expected {LEAST_INTERVALS} or more"
    if full := next((m for m in chain if m.covariance is not None), None):
        return f"the covariance of {full.label!r} is full, expected diagonal ones"
    return ""


def with_spread(
    mean: Floats, variance: Floats, step: NDArray[np.int64], spread: Spread, half: Half = (1, 1)
) -> Floats:
    """The trajectory c that is likeliest by its Gaussians and by its variance v(c) over all frames together.

    Parameters
    ----------
    mean, variance : (S, 3 M)
        Of the staircase's steps.
    step : (T,)
        Of each frame.
    spread
        Gaussian of v(c) of each feature.
    half
        Half lengths of the windows.

    Returns
    -------
    (T, M)

    Notes
    -----
    Maximises ω log N(W c; μ, U) + log N(v(c); m, s) with ω = 1 / 3T, so that the windows' terms weigh as one frame
    (Toda and Tokuda, eq. 24). They climb by gradients; but for one feature, where the gradient is 0,
    (R + λ H) c = r with λ = 2 (v(c) − m) / (s T ω) and H the matrix that takes the mean away. v falls as λ grows,
    so λ is one root, found by halving an interval for all features at once; of each λ, c comes from two banded
    solves, the mean by the Sherman-Morrison formula. As long as R + λ H is positive definite, as it is kept, c is
    the maximum, not one of several.
    """
    window = windows(half)
    dims = mean.shape[1] // 3
    usual: Floats = solver.trajectory(mean, variance, step, *window)[0]
    v = usual.var(axis=0)
    moves = (spread.mean > _STILL * spread.mean.max()) & (v > _STILL * v.max())
    if not moves.any():
        return usual
    target = np.where(moves, spread.mean, v)
    width = np.where(moves, np.maximum(spread.variance, 1e-12 * target**2), 1.0)
    low, high = np.zeros(dims), np.zeros(dims)
    # R's diagonal is at most what all windows together say of a frame
    most = (1.0 / variance).reshape(len(mean), 3, dims).sum(axis=1).max(axis=0)
    low = np.where(moves & (v < target), -most, low)
    high = np.where(moves & (v > target), most, high)
    for _ in range(60):  # an upper end at which v is too small
        _, gap = _gap(mean, variance, step, window, high, target, width)
        if not (short := moves & (gap < 0.0)).any():
            break
        low, high = np.where(short, high, low), np.where(short, 4.0 * np.maximum(high, most), high)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        _, gap = _gap(mean, variance, step, window, middle, target, width)
        low, high = np.where(gap < 0.0, middle, low), np.where(gap < 0.0, high, middle)
    found, _ = _gap(mean, variance, step, window, high, target, width)
    return np.where(moves, found, usual)


def _gap(
    mean: Floats,
    variance: Floats,
    step: NDArray[np.int64],
    window: tuple[Floats, Floats],
    shift: Floats,
    target: Floats,
    width: Floats,
) -> tuple[Floats, Floats]:
    """c of a λ (M,) and how far v(c) is below what λ stands for, (M,); −∞ where R + λ H is not positive definite."""
    dims = mean.shape[1] // 3
    precision = 1.0 / variance
    precision[:, :dims] += shift
    precision[:, :dims][precision[:, :dims] == 0.0] = 1e-300
    changed = 1.0 / precision
    with np.errstate(all="ignore"):
        # means such that the right sides are r, and 1
        c, _ = solver.trajectory(mean / variance * changed, changed, step, *window, definite=False)
        ones = np.zeros_like(mean)
        ones[:, :dims] = changed[:, :dims]
        even, _ = solver.trajectory(ones, changed, step, *window, definite=False)
        share = shift / len(step)
        rest = 1.0 - share * even.sum(axis=0)  # det(R + λ H) / det(R + λ I)
        c = c + even * (share * c.sum(axis=0) / rest)
        gap = shift * width / 6.0 + target - c.var(axis=0)
    # R + λ H is R + λ I and, where λ < 0, something positive of rank one: it mends one negative eigenvalue at most
    below = _negative(changed, step, *window)
    definite = np.where(below == 0, rest > 0.0, (below == 1) & (rest < 0.0))
    return c, np.where(definite & np.isfinite(gap), gap, -np.inf)


@njit
def _negative(variance, step, delta, square):  # type: ignore[no-untyped-def]
    """Number of negative eigenvalues of W' U⁻¹ W, per feature (M,): as many as pivots (Sylvester)."""
    frames, dims = len(step), variance.shape[1] // 3
    width = 2 * max(len(delta) // 2, len(square) // 2)
    band, right = np.zeros((frames, width + 1, dims)), np.zeros((frames, dims))
    margin, count, nothing = np.empty(dims), np.zeros(dims, dtype=np.int64), np.zeros(dims)
    for s in range(frames):
        band[s, 0] += 1.0 / variance[step[s], :dims]
        for w in range(2):
            window = delta if w == 0 else square
            half = len(window) // 2
            if s >= half and s + half < frames:
                precision = 1.0 / variance[step[s], (w + 1) * dims : (w + 2) * dims]
                solver.add_row(band, right, precision, nothing, s, window)
    for t in range(frames):
        solver.factor_row(band, right, t, width, margin)
        for m in range(dims):
            count[m] += band[t, 0, m] < 0.0
    return count
