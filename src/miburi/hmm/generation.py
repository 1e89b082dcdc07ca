"""Trajectories from Gaussians of static and dynamic features ([H], eqs. 22 to 25)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError
from miburi.hmm import full, solver
from miburi.hmm.windows import Floats, Half, checked_frames, shaped_frames, windows

_LEAST = 1e-200  # variances below this have no finite precision worth the name


def mlpg(
    mean: ArrayLike, variance: ArrayLike, *, half: Half = (1, 1), frames: ArrayLike | None = None
) -> Floats:
    """The likeliest trajectory whose static and dynamic features have these Gaussians.

    Parameters
    ----------
    mean : (S, 3 M)
        Of each step of the staircase, in the order static, Δ, Δ² (`deltas`).
    variance : (S, 3 M) or (S, 3 M, 3 M)
        Of each step; an infinite one says nothing. Three axes: full covariances.
    half
        Half lengths L1, L2 of the delta windows.
    frames : (S,), optional
        How many frames each step lasts; absent: one, so that S is T.

    Returns
    -------
    (T, M)
        In the unit of the static features.

    Raises
    ------
    InputError
        Shapes do not fit, a mean is not finite, a variance is not above 0 or a covariance not positive
        definite, or the Gaussians do not determine a trajectory (as where no static variance is finite).

    Notes
    -----
    R x = r with R = W' U⁻¹ W and r = W' U⁻¹ μ, of half-width 2 max(L1, L2), by LDL' for each dimension: O(T M
    L²) ([H], eqs. 23 to 25). Rows of W that reach outside the frames have no weight; nnmnkwii does the same,
    of all windows where the longest reaches outside. With full covariances all dimensions are one system, of
    half-width (2 max(L1, L2) + 1) M, by Cholesky: O(T M³ L²); rows outside are integrated out.
    """
    # writable, so that the kernels are not compiled once more for arrays that are not
    mu = np.require(shaped_frames(mean, "mlpg: mean"), requirements="W")
    v = np.require(variance, dtype=np.float64, requirements=["C", "W"])
    _check_shapes(mu, v)
    step = steps_of(len(mu), frames)
    if v.ndim == 3:
        return full.trajectory(checked_frames(mu, "mlpg: mean"), v, step, *windows(half))
    x, sound = solver.trajectory(mu, v, step, *windows(half))
    # values are looked at only where something is wrong: for many frames that takes as long as the solution
    if not (sound and np.isfinite(x[0]).all()):
        checked_frames(mu, "mlpg: mean")
        _check_variance(v)
        loose = np.flatnonzero(~np.isfinite(x[0]))
        raise InputError(
            f"mlpg: the Gaussians leave feature {loose[0]} open; are all of its static variances infinite?"
        )
    return x


def log_likelihood(
    trajectory: ArrayLike,
    mean: ArrayLike,
    variance: ArrayLike,
    *,
    half: Half = (1, 1),
    frames: ArrayLike | None = None,
) -> float:
    """Log density of a trajectory (T, M) and its deltas in the Gaussians of its frames.

    Parameters are those of `mlpg`, whose trajectory is the likeliest. Rows of windows that reach outside the
    frames do not count, nor do infinite variances.
    """
    x, mu = checked_frames(trajectory, "trajectory"), checked_frames(mean, "log-likelihood: mean")
    v = np.ascontiguousarray(variance, dtype=np.float64)
    _check_shapes(mu, v)
    _check_variance(v)
    step = steps_of(len(mu), frames)
    if x.shape != (len(step), mu.shape[1] // 3):
        raise InputError(
            f"log-likelihood: a trajectory of shape {x.shape}, expected {(len(step), mu.shape[1] // 3)}"
        )
    if v.ndim == 3:
        return full.log_density(x, mu, v, step, *windows(half))
    return float(solver.log_density(x, mu, v, step, *windows(half)).sum())


def steps_of(steps: int, frames: ArrayLike | None) -> NDArray[np.int64]:
    """The step of each frame (T,), from how many frames each of the steps lasts."""
    if frames is None:
        return np.arange(steps)
    lasting = np.asarray(frames)
    if lasting.shape != (steps,) or lasting.dtype.kind not in "iu" or (lasting < 1).any():
        raise InputError(f"mlpg: frames of shape {lasting.shape}, expected {steps} whole numbers, 1 or more")
    return np.repeat(np.arange(steps), lasting)


def _check_shapes(mu: Floats, v: Floats) -> None:
    if mu.shape[1] % 3:
        raise InputError(
            f"mlpg: mean has {mu.shape[1]} columns, expected 3 M: static, Δ and Δ² of each feature"
        )
    if v.shape not in (mu.shape, (*mu.shape, mu.shape[1])):
        raise InputError(f"mlpg: variance has shape {v.shape}, mean has {mu.shape}")


def _check_variance(v: Floats) -> None:
    if v.ndim == 2 and not v.min() >= _LEAST:  # NaN is not, either
        frame, column = (int(i) for i in np.argwhere(~(v >= _LEAST))[0])
        raise InputError(
            f"mlpg: variance, frame {frame}, column {column}: found {v[frame, column]}, expected one above 0"
        )
