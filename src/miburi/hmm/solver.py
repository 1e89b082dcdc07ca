"""The banded system of trajectory generation ([H], eqs. 23 to 25), R x = r, by LDL'.

R = W' U⁻¹ W and r = W' U⁻¹ μ. Gaussians come as a staircase: mean and variance (S, 3 M) of its steps, and step
(T,), the number of each frame's. Rows of windows that reach outside 1..T are left out. Innermost loops run over
features, which lie beside one another.
"""

from __future__ import annotations

import numpy as np

from miburi.compiled import njit

# sums may be taken in another order (vectors), but infinities and signs stay what they are
_SUMS = {"reassoc", "contract", "nsz"}
_SINGULAR = 1e-13  # a pivot below this share of its diagonal element is rounding
_BLOCK = 48  # features that `_narrow` solves side by side: a hand's; known beforehand, so that loops become vectors


@njit
def trajectory(mean, variance, step, delta, square):  # type: ignore[no-untyped-def]
    """Solve for all features; windows delta (2 L1 + 1,) and square (2 L2 + 1,).

    Returns x (T, M) and, per feature, a number that is not positive where the system is singular (M,).
    """
    if len(delta) == 3 and len(square) == 3:
        return _narrow(mean, variance, step, delta, square)
    return wide(mean, variance, step, delta, square)


@njit(fastmath=_SUMS, error_model="numpy")
def _narrow(mean, variance, step, delta, square):  # type: ignore[no-untyped-def]
    """`wide` for windows of half length 1, a few times faster: a frame's work is one loop."""
    frames, dims = len(step), mean.shape[1] // 3
    x, margin = np.empty((frames, dims)), np.empty(dims)
    lower = np.empty((frames + 2, 2, _BLOCK))  # L[t, t − 1] and L[t, t − 2]
    said = np.zeros((4, 7, _BLOCK))  # by three frames that follow one another, and by none
    carried = np.empty((7, _BLOCK))  # 1 / D of t − 1 and t − 2, L[t − 1, t − 2], y of both, margin, y / D
    for first in range(0, dims, _BLOCK):
        stop = min(first + _BLOCK, dims)
        said[:] = 0.0
        said[:, 0] = 1.0  # what is beyond the last feature is solved too, as 0
        carried[:] = 0.0
        carried[5] = np.inf
        lower[frames:] = 0.0
        before, now, after = 3, 3, 0
        _say(said, 0, mean, variance, step[0], first, stop, True, delta, square)
        for t in range(frames):
            before, now, s = now, after, t + 1
            if s == frames:
                after = 3
            elif s == 1 or s == frames - 1 or step[s] != step[t]:
                after = 0
                while after in (now, before):
                    after += 1
                _say(said, after, mean, variance, step[s], first, stop, s == frames - 1, delta, square)
            for m in range(_BLOCK):
                diagonal = said[now, 0, m] + said[before, 1, m] + said[after, 1, m]
                beside = said[before, 2, m] + said[now, 2, m]
                beyond = said[before, 3, m]
                right = said[now, 4, m] + said[before, 6, m] + said[after, 5, m]
                far = beyond * carried[1, m]
                beside -= beyond * carried[2, m]
                near = beside * carried[0, m]
                pivot = diagonal - beyond * far - beside * near
                y = right - near * carried[3, m] - far * carried[4, m]
                inverse = 1.0 / pivot
                carried[5, m] = min(carried[5, m], pivot - _SINGULAR * diagonal)
                carried[1, m] = carried[0, m]
                carried[0, m] = inverse
                carried[2, m] = near
                carried[4, m] = carried[3, m]
                carried[3, m] = y
                carried[6, m] = y * inverse
                lower[t, 0, m] = near
                lower[t, 1, m] = far
            for m in range(first, stop):
                x[t, m] = carried[6, m - first]
        carried[:2] = 0.0  # x of t + 1 and t + 2
        for t in range(frames - 1, -1, -1):
            for m in range(first, stop):
                carried[2, m - first] = x[t, m]
            for m in range(_BLOCK):
                found = (
                    carried[2, m] - lower[t + 1, 0, m] * carried[0, m] - lower[t + 2, 1, m] * carried[1, m]
                )
                carried[1, m] = carried[0, m]
                carried[0, m] = found
            for m in range(first, stop):
                x[t, m] = carried[0, m - first]
        for m in range(first, stop):
            margin[m] = carried[5, m - first]
    return x, margin


@njit(fastmath=_SUMS, error_model="numpy")
def _say(said, slot, mean, variance, i, first, stop, edge, delta, square):  # type: ignore[no-untyped-def]
    """What a frame s with the Gaussians of step i says of R and r.

    0 of R[s, s], 1 of R[s ± 1, s ± 1], 2 of R[s, s − 1] and R[s + 1, s], 3 of R[s + 1, s − 1], 4 of r[s], 5 of
    r[s − 1], 6 of r[s + 1]. At an edge the windows of deltas reach outside.
    """
    a, b, c = delta[2], square[2], square[1]
    if edge:
        a, b, c = 0.0, 0.0, 0.0
    dims = mean.shape[1] // 3
    for m in range(first, stop):
        p, p1, p2 = 1.0 / variance[i, m], 1.0 / variance[i, dims + m], 1.0 / variance[i, 2 * dims + m]
        q, q1, q2 = p * mean[i, m], a * p1 * mean[i, dims + m], p2 * mean[i, 2 * dims + m]
        said[slot, 0, m - first] = p + c * c * p2
        said[slot, 1, m - first] = a * a * p1 + b * b * p2
        said[slot, 2, m - first] = b * c * p2
        said[slot, 3, m - first] = b * b * p2 - a * a * p1
        said[slot, 4, m - first] = q + c * q2
        said[slot, 5, m - first] = b * q2 - q1
        said[slot, 6, m - first] = b * q2 + q1


@njit(fastmath=_SUMS, error_model="numpy")
def wide(mean, variance, step, delta, square):  # type: ignore[no-untyped-def]
    """`trajectory` for windows of any length.

    band[t, k] holds R[t, t − k], then the factor's L[t, t − k], and 1 / D[t] for k = 0.
    """
    frames, dims = len(step), mean.shape[1] // 3
    halves = (len(delta) // 2, len(square) // 2)
    longest = max(halves)
    width = 2 * longest
    band = np.zeros((frames, width + 1, dims))
    x = np.zeros((frames, dims))
    margin = np.full(dims, np.inf)
    precision, weighted = np.empty(dims), np.empty(dims)
    for s in range(frames + longest):
        if s < frames:
            now = step[s]
            for m in range(dims):
                precision[m] = 1.0 / variance[now, m]
                band[s, 0, m] += precision[m]
                x[s, m] += precision[m] * mean[now, m]
            for w in range(2):
                half = halves[w]
                if s >= half and s + half < frames:
                    first = (w + 1) * dims
                    for m in range(dims):
                        precision[m] = 1.0 / variance[now, first + m]
                        weighted[m] = precision[m] * mean[now, first + m]
                    add_row(band, x, precision, weighted, s, delta if w == 0 else square)
        if s >= longest:
            factor_row(band, x, s - longest, width, margin)
    for t in range(frames - 1, -1, -1):
        for m in range(dims):
            x[t, m] *= band[t, 0, m]
        for k in range(1, min(width, frames - 1 - t) + 1):
            for m in range(dims):
                x[t, m] -= band[t + k, k, m] * x[t + k, m]
    return x, margin


@njit(fastmath=_SUMS, error_model="numpy")
def add_row(band, r, precision, weighted, s, window):  # type: ignore[no-untyped-def]
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


@njit(fastmath=_SUMS, error_model="numpy")
def factor_row(band, y, t, width, margin):  # type: ignore[no-untyped-def]
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


@njit(fastmath=_SUMS, error_model="numpy")
def log_density(x, mean, variance, step, delta, square):  # type: ignore[no-untyped-def]
    """Log density of a trajectory x (T, M) and of its deltas in the Gaussians of its frames, per feature (M,)."""
    frames, dims = x.shape
    out, feature = np.zeros(dims), np.empty(dims)
    for t in range(frames):
        i = step[t]
        for w in range(3):
            if w == 0:
                feature[:] = x[t]
            else:
                window = delta if w == 1 else square
                half = len(window) // 2
                if t < half or t + half >= frames:
                    continue
                feature[:] = 0.0
                for j in range(len(window)):
                    for m in range(dims):
                        feature[m] += window[j] * x[t + j - half, m]
            for m in range(dims):
                v = variance[i, w * dims + m]
                if v < np.inf:
                    z = feature[m] - mean[i, w * dims + m]
                    out[m] -= 0.5 * (np.log(2.0 * np.pi * v) + z * z / v)
    return out
