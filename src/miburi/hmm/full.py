"""Trajectories from Gaussians with full covariances: all features are one banded system ([H], eqs. 23 to 25)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve, solveh_banded

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.hmm.windows import Floats
from miburi.threads import one_thread

MOST = 4e9
"""Bytes of a system at most: some 70 000 frames of a hand."""


class _Said(NamedTuple):
    """What a frame says of the frames around it: its part of R and r, and where it begins."""

    left: Floats
    right: Floats
    reach: int


@one_thread
def trajectory(
    mean: Floats, covariance: Floats, step: NDArray[np.int64], delta: Floats, square: Floats
) -> Floats:
    """Solve R x = r for all features together.

    Parameters
    ----------
    mean : (S, 3 M)
    covariance : (S, 3 M, 3 M)
    step : (T,)
        Of each frame.
    delta, square
        Coefficients of the windows.

    Returns
    -------
    (T, M)

    Raises
    ------
    InputError
        A covariance is not positive definite, or the system is larger than 4 GB.
    """
    frames, dims = len(step), mean.shape[1] // 3
    below = (2 * max(len(delta) // 2, len(square) // 2) + 1) * dims - 1
    if 8.0 * (below + 1) * frames * dims > MOST:
        raise InputError(
            f"mlpg: full covariances of {frames} frames need more than {MOST / 1e9:g} GB; train diagonal ones"
        )
    band, right = np.zeros((frames * dims, below + 1)), np.zeros(frames * dims)
    known: dict[tuple[int, tuple[int, ...]], _Said] = {}
    for t, i, present in _rows(step, delta, square):
        if (i, present) not in known:
            known[i, present] = _said(mean[i], covariance[i], present, i, delta, square)
        said = known[i, present]
        first = (t - said.reach) * dims
        _add(band, said.left, first)
        right[first : first + len(said.right)] += said.right
    x: Floats = solveh_banded(band.T, right, lower=True, check_finite=False)
    return x.reshape(frames, dims)


@one_thread
def log_density(
    x: Floats, mean: Floats, covariance: Floats, step: NDArray[np.int64], delta: Floats, square: Floats
) -> float:
    """Log density of a trajectory (T, M) and its deltas in the Gaussians of its frames."""
    total, dims = 0.0, x.shape[1]
    known: dict[tuple[int, tuple[int, ...]], tuple[tuple[Floats, bool], float]] = {}
    for t, i, present in _rows(step, delta, square):
        rows = _columns(present, dims)
        if (i, present) not in known:
            factor = _factor(covariance[i][np.ix_(rows, rows)], i)
            constant = len(rows) * np.log(2.0 * np.pi) + 2.0 * np.log(np.diagonal(factor[0])).sum()
            known[i, present] = factor, float(constant)
        factor, constant = known[i, present]
        coefficients, reach = _coefficients(present, delta, square)
        z = (coefficients @ x[t - reach : t + reach + 1]).ravel() - mean[i][rows]
        total -= 0.5 * (constant + float(z @ cho_solve(factor, z)))
    return total


def _rows(
    step: NDArray[np.int64], delta: Floats, square: Floats
) -> Iterator[tuple[int, int, tuple[int, ...]]]:
    """Each frame, its step, and the windows that lie within the frames (0 static, 1 Δ, 2 Δ²)."""
    for t, i in enumerate(step.tolist()):
        room = min(t, len(step) - 1 - t)
        yield t, i, (0, *(k for k, w in ((1, delta), (2, square)) if len(w) // 2 <= room))


def _coefficients(present: tuple[int, ...], delta: Floats, square: Floats) -> tuple[Floats, int]:
    """Windows one below the other, (windows, 2 h + 1), and h, the half length of the longest."""
    chosen = [(np.ones(1), delta, square)[k] for k in present]
    reach = max(len(w) // 2 for w in chosen)
    return np.array([np.pad(w, reach - len(w) // 2) for w in chosen]), reach


def _columns(present: tuple[int, ...], dims: int) -> NDArray[np.int64]:
    return np.concatenate([np.arange(k * dims, (k + 1) * dims) for k in present])


def _factor(covariance: Floats, step: int) -> tuple[Floats, bool]:
    try:
        factor: tuple[Floats, bool] = cho_factor(covariance, lower=True, check_finite=False)
        if not np.isfinite(factor[0]).all():
            raise LinAlgError
    except LinAlgError:
        raise InputError(f"mlpg: the covariance of step {step} is not positive definite") from None
    return factor


def _said(
    mean: Floats, covariance: Floats, present: tuple[int, ...], step: int, delta: Floats, square: Floats
) -> _Said:
    dims = len(mean) // 3
    rows = _columns(present, dims)
    factor = _factor(covariance[np.ix_(rows, rows)], step)
    coefficients, reach = _coefficients(present, delta, square)
    w = np.kron(coefficients, np.eye(dims))
    weighted = cho_solve(factor, w)
    return _Said(np.ascontiguousarray(w.T @ weighted), weighted.T @ mean[rows], reach)


@njit
def _add(band, left, first):  # type: ignore[no-untyped-def]
    """Add a frame's part of R, rows and columns from `first` on, to its lower band: band[c, r − c] is R[r, c]."""
    for c in range(len(left)):
        for r in range(c, len(left)):
            band[first + c, r - c] += left[r, c]
