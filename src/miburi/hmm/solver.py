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
_PART = 512  # frames of which L is kept
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
    """`wide` for windows of half length 1, a few times faster: a frame's work is one loop.

    L is kept for a part of the frames only. What the next part needs is carried on; all but the last are factored
    once more, backwards, when their turn comes. So memory is that of x, and L stays in the caches.
    """
    frames, dims = len(step), mean.shape[1] // 3
    x, margin = np.empty((frames, dims)), np.empty(dims)
    parts = (frames - 1) // _PART + 1
    lower = np.empty((min(frames, _PART) + 2, 2, _BLOCK))  # L[t, t − 1] and L[t, t − 2]
    said = np.zeros((4, 7, _BLOCK))  # by three frames that follow one another, and by none
    # In one array, so that no loop has to ask whether two of them overlap: 1 / D of t − 1 and t − 2, L[t − 1, t − 2], y
    # of both, margin, y / D; of t, R[t, t], R[t, t − 1], R[t, t − 2] and r[t]; x of t + 1 and t + 2.
    w = np.empty((13, _BLOCK))
    kept = np.empty((parts, 5, _BLOCK))
    for first in range(0, dims, _BLOCK):
        stop = min(first + _BLOCK, dims)
        said[:] = 0.0
        said[:, 0] = 1.0  # what is beyond the last feature is solved too, as 0
        w[:] = 0.0
        w[5] = np.inf
        lower[:] = 0.0
        for turn in range(2 * parts - 1):
            part = turn if turn < parts else 2 * parts - 2 - turn
            keep = turn >= parts - 1
            start, end = part * _PART, min(frames, (part + 1) * _PART)
            if turn < parts:
                kept[part] = w[:5]
            else:
                w[:5] = kept[part]
                lower[_PART:] = lower[:2]
            now, after, changed = 3, 0, True
            if start:
                now = 1
                _say(said, 1, mean, variance, step[start - 1], first, stop, start == 1, delta, square)
            edge = start == 0 or start == frames - 1
            _say(said, 0, mean, variance, step[start], first, stop, edge, delta, square)
            before = now
            for t in range(start, end):
                changed = changed or now != after or before != now
                before, now, s = now, after, t + 1
                if s == frames:
                    after = 3
                elif s == 1 or s == frames - 1 or step[s] != step[t]:
                    after = 0
                    while after in (now, before):
                        after += 1
                    _say(said, after, mean, variance, step[s], first, stop, s == frames - 1, delta, square)
                if changed or now != after or before != now:
                    for m in range(_BLOCK):
                        w[7, m] = said[now, 0, m] + said[before, 1, m] + said[after, 1, m]
                        w[8, m] = said[before, 2, m] + said[now, 2, m]
                        w[9, m] = said[before, 3, m]
                        w[10, m] = said[now, 4, m] + said[before, 6, m] + said[after, 5, m]
                    changed = False
                i = t - start if keep else 0
                for m in range(_BLOCK):
                    beyond = w[9, m]
                    far = beyond * w[1, m]
                    beside = w[8, m] - beyond * w[2, m]
                    near = beside * w[0, m]
                    pivot = w[7, m] - beyond * far - beside * near
                    y = w[10, m] - near * w[3, m] - far * w[4, m]
                    inverse = 1.0 / pivot
                    w[5, m] = min(w[5, m], pivot - _SINGULAR * w[7, m])
                    w[1, m] = w[0, m]
                    w[0, m] = inverse
                    w[2, m] = near
                    w[4, m] = w[3, m]
                    w[3, m] = y
                    w[6, m] = y * inverse
                    lower[i, 0, m] = near
                    lower[i, 1, m] = far
                if keep:
                    row = x[t, first:stop]
                    for m in range(len(row)):
                        row[m] = w[6, m]
            if not keep:
                continue
            for t in range(end - 1, start - 1, -1):
                i = t - start
                row = x[t, first:stop]
                for m in range(len(row)):
                    w[6, m] = row[m]
                for m in range(_BLOCK):
                    found = w[6, m] - lower[i + 1, 0, m] * w[11, m] - lower[i + 2, 1, m] * w[12, m]
                    w[12, m] = w[11, m]
                    w[11, m] = found
                for m in range(len(row)):
                    row[m] = w[11, m]
        for m in range(first, stop):
            margin[m] = w[5, m - first]
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
    # slices, because an index that might be negative keeps loops from becoming vectors
    v, v1, v2 = (
        variance[i, first:stop],
        variance[i, dims + first : dims + stop],
        variance[i, 2 * dims + first :],
    )
    mu, mu1, mu2 = mean[i, first:stop], mean[i, dims + first : dims + stop], mean[i, 2 * dims + first :]
    out = said[slot]
    for m in range(len(v)):
        p, p1, p2 = 1.0 / v[m], 1.0 / v1[m], 1.0 / v2[m]
        q, q1, q2 = p * mu[m], a * p1 * mu1[m], p2 * mu2[m]
        out[0, m] = p + c * c * p2
        out[1, m] = a * a * p1 + b * b * p2
        out[2, m] = b * c * p2
        out[3, m] = b * b * p2 - a * a * p1
        out[4, m] = q + c * q2
        out[5, m] = b * q2 - q1
        out[6, m] = b * q2 + q1


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
                for m in range(dims):
                    feature[m] = x[t, m]
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
