"""The banded system of trajectory generation ([H], eqs. 23 to 25), R x = r, by LDL'.

R = W' U⁻¹ W and r = W' U⁻¹ μ. Gaussians come as a staircase: mean and variance (S, 3 M) of its steps, and step
(T,), the number of each frame's. Rows of windows that reach outside 1..T are left out. Innermost loops run over
features, which lie beside one another.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import SUMS, njit
from miburi.hmm.windows import Floats

_SINGULAR = 1e-13  # a pivot below this share of its diagonal element is rounding
_BLOCK = 48  # features that `_narrow` solves side by side: a hand's; known beforehand, so that loops become vectors
_PART, _AHEAD = 768, 256  # frames that are solved together, and those after them that are known by then
_WHOLE = 4096  # frames up to which a string is solved as a whole: its factor takes 1.2 KB a frame
_SAME = 1e-12  # largest difference, as a share, that frames further ahead may make


def trajectory(
    mean: Floats,
    variance: Floats,
    step: NDArray[np.int64],
    delta: Floats,
    square: Floats,
    definite: bool = True,
) -> tuple[Floats, bool]:
    """Solve for all features; windows delta (2 L1 + 1,) and square (2 L2 + 1,).

    Returns x (T, M), NaN where a feature's system is singular (or, unless `definite` is False, not positive definite),
    and False if a variance is negative. Whatever else no mean or variance may be (NaN, infinite, 0) leaves the first
    frame, which depends on all others, not finite, or gives False.
    """
    dims = mean.shape[1] // 3
    if len(delta) > 3 or len(square) > 3:
        sound = bool((variance > 0.0).all() and np.isfinite(mean).all())  # not all of them are read
        return wide(mean, variance, step, delta, square, definite), sound
    if dims == _BLOCK:
        return _solved(mean, variance, step, definite)
    x, positive = np.empty((len(step), dims)), True
    for first in range(0, dims, _BLOCK):
        solved, above = _solved(_block(mean, first), _block(variance, first), step, definite)
        x[:, first : first + _BLOCK] = solved[:, : dims - first]
        positive = positive and above
    return x, positive


def _block(values: Floats, first: int) -> Floats:
    """Columns of a block of features, filled up with ones."""
    part = values.reshape(len(values), 3, -1)[:, :, first : first + _BLOCK]
    block = np.empty((len(values), 3, _BLOCK))
    block[:, :, : part.shape[2]], block[:, :, part.shape[2] :] = part, 1.0
    return block.reshape(len(values), -1)


def _solved(mean: Floats, variance: Floats, step: NDArray[np.int64], definite: bool) -> tuple[Floats, bool]:
    """A block of features; by parts if it is long, unless frames depend on others further ahead than `_AHEAD`."""
    x = np.empty((len(step) + 2, _BLOCK))  # numpy's own memory comes in large pages
    positive, settled = True, False
    if len(step) > _WHOLE:
        positive, settled = _narrow(mean, variance, step, definite, _PART, x)
    if not settled:
        positive, _ = _narrow(mean, variance, step, definite, len(step), x)
    return x[:-2], positive


@njit(fastmath=SUMS, error_model="numpy")
def _narrow(mean, variance, step, definite, length, out):  # type: ignore[no-untyped-def]
    """`wide` for a block of features and windows (−½, 0, ½) and (¼, −½, ¼), many times faster.

    Frames are read, factored and solved forward once. A part of `length` of them and the `_AHEAD` after it are solved
    backward as if all frames after them were 0. The two frames after the part, on which it hangs, are compared with
    what is found for them later. So memory is that of x, however long the string.

    Writes x to out (T + 2, M), whose last two rows have no meaning. Returns whether no variance is negative, and
    whether frames further ahead than `_AHEAD` make no difference: else x is not the answer.
    """
    frames, x = len(step), out.reshape(-1)
    signs, sign = variance.view(np.int64), 0  # the sign of a number is that of its bits
    # Of frame t at row t − start + 3: L[t, t − 1], L[t + 1, t − 1] and y / D. Nothing is before the first.
    size = 3 * _BLOCK
    kept = np.empty((min(frames, length + _AHEAD) + 4) * size)
    kept[: 3 * size] = 0.0
    said = np.empty(2 * size)  # 1 / v and μ / v of frame s
    # Of frame t = s − 1: R[t, t], R[t, t − 1], R[t, t − 2], R[t + 1, t − 1], r[t], 1 / D[t − 1]; of frame s, what it
    # and those before it say of R[s, s], r[s] and R[s, t] / −2; of it alone, 1 / 4 v1, 1 / 16 v2, its part of r[s + 1].
    w = np.zeros((12, _BLOCK))
    w[6] = 1.0  # a frame before the first, which is 0
    start, before = 0, np.empty(2 * _BLOCK)
    same = 0  # frames before s that say the same
    for s in range(frames + 1):
        i = step[min(s, frames - 1)]
        same = 0 if s < 2 or s >= frames - 1 or i != step[s - 1] else same + 1
        if same == 0:
            mu, v = mean[i], variance[i]
            for m in range(size):
                sign |= signs[i, m]
                said[m] = 1.0 / v[m]
                said[size + m] = mu[m] * said[m]
        if same < 3:  # else R and r are as in the row before
            one = 1.0 if s < frames else 0.0
            half, quarter, sixteenth = (0.5, 0.25, 0.0625) if 0 < s < frames - 1 else (0.0, 0.0, 0.0)
            for m in range(_BLOCK):
                p, p1, p2 = one * said[m], quarter * said[_BLOCK + m], sixteenth * said[2 * _BLOCK + m]
                q, q1 = one * said[size + m], half * said[size + _BLOCK + m]
                q2 = quarter * said[size + 2 * _BLOCK + m]
                w[0, m] = w[6, m] + (p1 + p2)
                w[1, m] = -2.0 * w[8, m]
                w[2, m] = w[3, m]
                w[3, m] = w[10, m] - w[9, m]
                w[4, m] = w[7, m] + (q2 - q1)
                w[6, m] = p + 4.0 * p2 + (w[9, m] + w[10, m])
                w[7, m] = q - 2.0 * q2 + w[11, m]
                w[8, m] = p2 + w[10, m]
                w[9, m], w[10, m], w[11, m] = p1, p2, q1 + q2
        at = (s - start) * size
        rows = kept[at : at + 3 * size]
        for m in range(_BLOCK):
            beyond, far = w[2, m], rows[size + _BLOCK + m]
            beside = w[1, m] - beyond * rows[size + m]
            near = beside * w[5, m]
            pivot = w[0, m] - beside * near - beyond * far
            y = w[4, m] - beside * rows[size + 2 * _BLOCK + m] - beyond * rows[2 * _BLOCK + m]
            rows[2 * size + m] = near
            rows[2 * size + _BLOCK + m] = w[3, m] * w[5, m]
            least = pivot if definite else abs(pivot)
            w[5, m] = 1.0 / pivot if least > _SINGULAR * abs(w[0, m]) else np.nan
            rows[2 * size + 2 * _BLOCK + m] = y * w[5, m]
        if s < frames and s - start < length + _AHEAD:
            continue
        kept[at + 3 * size : at + 4 * size] = 0.0
        x[s * _BLOCK : (s + 2) * _BLOCK] = 0.0
        for t in range(s - 1, start - 1, -1):
            at = (t - start + 3) * size
            rows, found = kept[at : at + 2 * size], x[t * _BLOCK : (t + 3) * _BLOCK]
            for m in range(_BLOCK):
                found[m] = (
                    rows[2 * _BLOCK + m]
                    - rows[size + m] * found[_BLOCK + m]
                    - rows[_BLOCK + size + m] * found[2 * _BLOCK + m]
                )
        found = x[start * _BLOCK : (start + 3) * _BLOCK]
        for m in range(2 * _BLOCK if start else 0):
            size_here = abs(found[m]) + abs(found[m + _BLOCK])
            if not (abs(found[m] - before[m]) <= _SAME * size_here and size_here < np.inf):
                return True, False
        if s < frames:
            start += length
            before[:] = x[start * _BLOCK : (start + 2) * _BLOCK]
            kept[: (_AHEAD + 3) * size] = kept[length * size : (length + _AHEAD + 3) * size]
    return sign >= 0, True


@njit(fastmath=SUMS, error_model="numpy")
def wide(mean, variance, step, delta, square, definite=True):  # type: ignore[no-untyped-def]
    """x of `trajectory`, for windows of any length.

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
    for m in range(dims):
        if definite and not margin[m] > 0.0:
            x[:, m] = np.nan
    return x


@njit(fastmath=SUMS, error_model="numpy")
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


@njit(fastmath=SUMS, error_model="numpy")
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


@njit(fastmath=SUMS, error_model="numpy")
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
