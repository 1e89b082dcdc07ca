"""Gaussians of the states: log densities and their re-estimation, diagonal and full.

`variance` is (N, D) where the covariance is diagonal and (N, D, D) where it is full.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_triangular

from miburi.hmm import kernels
from miburi.hmm.windows import Floats
from miburi.threads import one_thread

_RARE = 1e-8  # a state with fewer expected frames keeps its Gaussian


def log_densities(x: Floats, mean: Floats, variance: Floats) -> Floats:
    """Log density of each frame in each state's Gaussian.

    Parameters
    ----------
    x : (T, D)
    mean : (N, D)
    variance : (N, D) or (N, D, D)

    Returns
    -------
    (T, N)
    """
    if variance.ndim == 2:
        found: Floats = kernels.log_densities(x, mean, variance)
        return found
    return _full_log_densities(x, mean, variance)


@one_thread
def _full_log_densities(x: Floats, mean: Floats, variance: Floats) -> Floats:
    out = np.empty((len(x), len(mean)))
    for i, root in enumerate(np.linalg.cholesky(variance)):
        z = solve_triangular(root, (x - mean[i]).T, lower=True)
        constant = x.shape[1] * np.log(2.0 * np.pi) + 2.0 * np.log(np.diagonal(root)).sum()
        out[:, i] = -0.5 * (constant + np.square(z).sum(axis=0))
    return out


def reestimate(
    x: Floats, gamma: Floats, mean: Floats, variance: Floats, floors: Floats
) -> tuple[Floats, Floats]:
    """M step of the Gaussians ([H], eqs. 6 and 7), with a floor.

    Parameters
    ----------
    x : (T, D)
    gamma : (T, N)
        Probability of each state at each frame.
    mean, variance
        So far; kept by a state that is never reached.
    floors : (D,)
        Smallest variances.

    Returns
    -------
    mean : (N, D)
    variance : as before

    Notes
    -----
    Sums are taken around the old means, which loses no digits. A covariance Σ is floored to F by clipping the
    eigenvalues of F^−½ Σ F^−½ at 1: the likeliest Σ with Σ − F positive semidefinite.
    """
    occupied = gamma.sum(axis=0)
    kept = occupied < _RARE
    if variance.ndim == 2:
        weight = np.where(kept, 1.0, occupied)[:, None]
        first, second = kernels.moments(x, gamma, mean)
        shift = first / weight
        new = np.maximum(second / weight - shift**2, floors)
        return np.where(kept[:, None], mean, mean + shift), np.where(kept[:, None], variance, new)
    return _full_reestimate(x, gamma, mean, variance, floors, kept)


@one_thread
def _full_reestimate(
    x: Floats, gamma: Floats, mean: Floats, variance: Floats, floors: Floats, kept: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    new_mean, new_variance = mean.copy(), variance.copy()
    for i in np.flatnonzero(~kept):
        z, weight = x - mean[i], gamma[:, i] / gamma[:, i].sum()
        shift = weight @ z
        new_mean[i] = mean[i] + shift
        new_variance[i] = _floored((z * weight[:, None]).T @ z - np.outer(shift, shift), floors)
    return new_mean, new_variance


def _floored(covariance: Floats, floors: Floats) -> Floats:
    """The covariance with no direction below the floor."""
    scale = np.sqrt(floors)
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T) / np.outer(scale, scale))
    if values[0] >= 1.0:
        return 0.5 * (covariance + covariance.T)
    root = scale[:, None] * vectors * np.sqrt(np.maximum(values, 1.0))
    floored: Floats = root @ root.T
    return 0.5 * (floored + floored.T)
