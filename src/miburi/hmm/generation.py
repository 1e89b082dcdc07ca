"""Trajectories from Gaussians of static and dynamic features ([H], eqs. 22 to 25)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from miburi.errors import InputError
from miburi.hmm import solver
from miburi.hmm.windows import Floats, Half, checked_frames, windows

_LEAST = 1e-200  # variances below this have no finite precision worth the name


def mlpg(mean: ArrayLike, variance: ArrayLike, *, half: Half = (1, 1)) -> Floats:
    """The likeliest trajectory whose static and dynamic features have these Gaussians.

    Parameters
    ----------
    mean, variance : (T, 3 M)
        Of each frame, in the order static, Δ, Δ² (`deltas`). An infinite variance says nothing.
    half
        Half lengths L1, L2 of the delta windows.

    Returns
    -------
    (T, M)
        In the unit of the static features.

    Raises
    ------
    InputError
        Shapes do not fit, a mean is not finite, a variance is not above 0, or the Gaussians do not determine
        a trajectory (as where no static variance is finite).

    Notes
    -----
    R x = r with R = W' U⁻¹ W and r = W' U⁻¹ μ, of half-width 2 max(L1, L2), by LDL' for each dimension: O(T M
    L²) ([H], eqs. 23 to 25). Rows of W that reach outside the frames have no weight; nnmnkwii does the same,
    of all windows where the longest reaches outside.
    """
    mu = checked_frames(mean, "mlpg: mean")
    v = np.ascontiguousarray(variance, dtype=np.float64)
    if mu.shape[1] % 3:
        raise InputError(
            f"mlpg: mean has {mu.shape[1]} columns, expected 3 M: static, Δ and Δ² of each feature"
        )
    if v.shape != mu.shape:
        raise InputError(f"mlpg: variance has shape {v.shape}, mean has {mu.shape}")
    if not (v >= _LEAST).all():
        frame, column = (int(i) for i in np.argwhere(~(v >= _LEAST))[0])
        raise InputError(
            f"mlpg: variance, frame {frame}, column {column}: found {v[frame, column]}, expected one above 0"
        )
    x, margin = solver.trajectory(mu, v, *windows(half))
    found: Floats = x
    loose = np.flatnonzero(~(margin > 0.0) | ~np.isfinite(found).all(axis=0))
    if len(loose):
        raise InputError(
            f"mlpg: the Gaussians leave feature {loose[0]} open; are all of its static variances infinite?"
        )
    return found
