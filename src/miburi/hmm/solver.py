"""The banded system of trajectory generation ([H], eqs. 23 to 25)."""

from __future__ import annotations

import numpy as np
from numba import njit

# sums may be taken in another order (vectors), but infinities and signs stay what they are
_SUMS = {"reassoc", "contract", "nsz"}
_SINGULAR = 1e-13  # a pivot below this share of its diagonal element is rounding


@njit(cache=True, fastmath=_SUMS, error_model="numpy")
def trajectory(mean, variance, delta, square):  # type: ignore[no-untyped-def]
    """Solve R x = r with R = W' U⁻¹ W and r = W' U⁻¹ μ for all dimensions at once, by LDL'.

    mean and variance (T, 3 M), delta (2 L1 + 1,) and square (2 L2 + 1,) the coefficients of the windows.
    Returns x (T, M) and, per dimension, a number that is not positive where the system is singular (M,). Rows
    of windows that reach outside 1..T are left out.

    band[t, k] holds R[t, t − k], then the factor's L[t, t − k], and 1 / D[t] for k = 0. The innermost loop
    runs over dimensions, which lie beside one another.
    """
    frames, dims = mean.shape[0], mean.shape[1] // 3
    halves = (len(delta) // 2, len(square) // 2)
    longest = max(halves)
    width = 2 * longest
    band = np.zeros((frames, width + 1, dims))
    x = np.zeros((frames, dims))
    margin = np.full(dims, np.inf)
    precision, weighted = np.empty(dims), np.empty(dims)
    for s in range(frames + longest):
        if s < frames:
            for m in range(dims):
                precision[m] = 1.0 / variance[s, m]
                band[s, 0, m] += precision[m]
                x[s, m] += precision[m] * mean[s, m]
            for w in range(2):
                half = halves[w]
                if s >= half and s + half < frames:
                    first = (w + 1) * dims
                    for m in range(dims):
                        precision[m] = 1.0 / variance[s, first + m]
                        weighted[m] = precision[m] * mean[s, first + m]
                    _add_row(band, x, precision, weighted, s, delta if w == 0 else square)
        if s >= longest:
            _factor_row(band, x, s - longest, width, margin)
    for t in range(frames - 1, -1, -1):
        for m in range(dims):
            x[t, m] *= band[t, 0, m]
        for k in range(1, min(width, frames - 1 - t) + 1):
            for m in range(dims):
                x[t, m] -= band[t + k, k, m] * x[t + k, m]
    return x, margin


@njit(cache=True, fastmath=_SUMS, error_model="numpy")
def _add_row(band, r, precision, weighted, s, window):  # type: ignore[no-untyped-def]
    """Add to R and r what a window says at frame s."""
    half = len(window) // 2
    for j in range(len(window)):
        a = window[j]
        if a == 0.0:
            continue
        t = s + j - half
        for m in range(len(precision)):
            r[t, m] += a * weighted[m]
        for i in range(j + 1):
            b = a * window[i]
            if b != 0.0:
                for m in range(len(precision)):
                    band[t, j - i, m] += b * precision[m]


@njit(cache=True, fastmath=_SUMS, error_model="numpy")
def _factor_row(band, y, t, width, margin):  # type: ignore[no-untyped-def]
    """Row t of L and 1 / D, and of the forward substitution."""
    dims = y.shape[1]
    reach = min(width, t)
    for k in range(reach, 0, -1):  # L D first
        for q in range(k + 1, reach + 1):
            for m in range(dims):
                band[t, k, m] -= band[t, q, m] * band[t - k, q - k, m]
    floor = _SINGULAR * band[t, 0]
    for k in range(1, reach + 1):
        for m in range(dims):
            factor = band[t, k, m] * band[t - k, 0, m]
            band[t, 0, m] -= band[t, k, m] * factor
            y[t, m] -= factor * y[t - k, m]
            band[t, k, m] = factor
    for m in range(dims):
        margin[m] = min(margin[m], band[t, 0, m] - floor[m])
        band[t, 0, m] = 1.0 / band[t, 0, m]
