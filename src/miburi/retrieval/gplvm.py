"""Gaussian process latent variable models of segments (Lawrence 2004), which [P] puts in the place of PCA.

Each value of a frame is a Gaussian process over a latent space of few dimensions, all with one covariance

    k(a, b) = α exp(−|a − b|² / 2) + σ² [a is b].

The length scale is 1, because the scale of the latent points is free. Latent points, α and σ² maximise the
likelihood of the frames; there is no prior on the latent points.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import lapack
from scipy.optimize import minimize

from miburi.compiled import njit
from miburi.motion import Floats
from miburi.retrieval import subspace

# Bounds of α and σ² in m²: σ of a millimetre is what recordings are good for, and keeps K well conditioned.
_SIGNAL = (1e-6, 1e3)
NOISE = (1e-6, 1e2)
# Share of the frames' variance that is noise at the start.
_FIRST_NOISE = 0.05
# Longest step of a latent point in one iteration, in length scales: further away gradients say nothing.
_LONGEST = 1.0
_ENOUGH = 1e-2
# Rounding may take a predictive variance below the noise; it counts as at least this share of it.
_LEAST = 0.5
# Starts are so far from each other, in length scales.
_APART = 0.5
# Points beside the latent points from which projecting may set out; the box reaches a length scale beyond them.
_SPREAD = 64


class Model(NamedTuple):
    """A model and what projecting needs of it.

    N frames of D values, q latent dimensions.
    """

    mean: Floats
    """(D,), of the frames"""
    latent: Floats
    """(N, q)"""
    scale: Floats
    """(2,): α and σ², m²"""
    inverse: Floats
    """(N, 2 N): K⁻¹, and beside it G = A Aᵀ"""
    weights: Floats
    """(N, D): A = K⁻¹ Y, Y the frames without their mean"""
    starts: Floats
    """(M, q): where projecting may set out from: latent points and middles of neighbours, 2 N − 1 in all, where
    the model is sure of itself, and others spread over their box"""
    reached: Floats
    """(M, D): what is predicted there, without the mean"""
    variance: Floats
    """(M,): predictive variance there"""


def negative_log_likelihood(z: Floats, products: Floats, width: int) -> tuple[float, Floats]:
    """−log p(Y | X, α, σ²) and its gradient.

    Parameters
    ----------
    z : (N q + 2,)
        Latent points, log α, log σ².
    products : (N, N)
        Y Yᵀ.
    width
        Values of a frame (D).

    Returns
    -------
    value
        D/2 log|K| + ½ tr(K⁻¹ Y Yᵀ) + N D/2 log 2π (Lawrence 2004, eq. 3).
    gradient : (N q + 2,)
        With respect to `z`.
    """
    n = len(products)
    x = z[:-2].reshape(n, -1)
    signal, noise = np.exp(z[-2:])
    smooth = _covariance(x, x, signal)
    factor, failed = lapack.dpotrf(smooth + noise * np.eye(n), lower=1)
    if failed:
        # rounding has eaten the noise: no step goes here
        return np.inf, np.zeros_like(z)
    inverse = _inverse(factor)
    explained = inverse @ products
    log_determinant = 2 * np.log(np.diagonal(factor)).sum()
    value = 0.5 * (width * log_determinant + np.trace(explained) + n * width * np.log(2 * np.pi))
    slope = 0.5 * (width * inverse - explained @ inverse)
    pull = 2 * slope * smooth
    gradient = np.empty_like(z)
    gradient[:-2] = (pull @ x - pull.sum(axis=1)[:, None] * x).ravel()
    gradient[-2:] = 0.5 * pull.sum(), noise * np.trace(slope)
    return float(value), gradient


def _covariance(a: Floats, b: Floats, signal: float) -> Floats:
    square = np.square(a[:, None] - b[None]).sum(axis=-1)
    found: Floats = signal * np.exp(-0.5 * square)
    return found


def _inverse(factor: Floats) -> Floats:
    """Inverse of L Lᵀ."""
    found = lapack.dpotri(factor, lower=1)[0]
    lower = np.tril(found)
    whole: Floats = lower + np.tril(found, -1).T
    return whole


def fit(x: ArrayLike, dims: int = 2, iterations: int = 100) -> Model:
    """The model of some frames, by maximum likelihood.

    Parameters
    ----------
    x : (N, D)
        Frames, N ≥ 1; repeated ones weigh as often as they are there.
    dims
        Latent dimensions (q).
    iterations
        Of L-BFGS at most, from the principal components, each scaled to variance 1.

    Returns
    -------
    Model
        Frames that do not differ have all their latent points at the origin.
    """
    frames = np.asarray(x, dtype=np.float64)
    mean, basis = subspace.fit(frames, dims)
    centred = frames - mean
    variance = float(np.square(centred).mean())
    latent = centred @ basis.T
    spread = latent.std(axis=0)
    latent /= np.where(spread > 0, spread, 1.0)
    scale = np.clip([variance, _FIRST_NOISE * variance], *np.transpose([_SIGNAL, NOISE]))
    if spread.any() and iterations:
        found = minimize(
            negative_log_likelihood,
            np.concatenate([latent.ravel(), np.log(scale)]),
            (centred @ centred.T, frames.shape[1]),
            method="L-BFGS-B",
            jac=True,
            bounds=[(None, None)] * latent.size + [tuple(np.log(b)) for b in (_SIGNAL, NOISE)],
            options={"maxiter": iterations, "maxcor": 20},
        )
        latent, scale = found.x[:-2].reshape(latent.shape), np.exp(found.x[-2:])
    return model(frames, latent, scale)


def model(x: ArrayLike, latent: Floats, scale: Floats) -> Model:
    """The model of frames (N, D) whose latent points (N, q) and (α, σ²) are known."""
    frames = np.asarray(x, dtype=np.float64)
    mean = frames.mean(axis=0)
    signal, noise = scale
    factor, _ = lapack.dpotrf(_covariance(latent, latent, signal) + noise * np.eye(len(frames)), lower=1)
    inverse = _inverse(factor)
    weights = inverse @ (frames - mean)
    low, high = latent.min(axis=0) - 1.0, latent.max(axis=0) + 1.0
    between = 0.5 * (latent[1:] + latent[:-1])
    starts = np.concatenate([latent, between, low + _spread(latent.shape[1]) * (high - low)])
    k = _covariance(starts, latent, signal)
    return Model(
        mean,
        np.ascontiguousarray(latent),
        np.asarray(scale, dtype=np.float64),
        np.ascontiguousarray(np.hstack([inverse, weights @ weights.T])),
        weights,
        starts,
        k @ weights,
        np.maximum(signal + noise - np.einsum("ij,ij->i", k @ inverse, k), _LEAST * noise),
    )


@cache
def _spread(dims: int) -> Floats:
    """Points that fill the unit cube evenly, (_SPREAD, dims)."""
    from scipy.stats import qmc  # most of a second, which only GP-LVM has to wait for

    found: Floats = qmc.Halton(dims, scramble=False).random(_SPREAD)
    return found


def predict(known: Model, points: ArrayLike) -> tuple[Floats, Floats]:
    """What a model says of latent points (n, q): frames (n, D), and the variance of each (n,), noise included."""
    n = len(known.latent)
    signal, noise = known.scale
    k = _covariance(np.asarray(points, dtype=np.float64), known.latent, signal)
    variance: Floats = signal + noise - np.einsum("ij,ij->i", k @ known.inverse[:, :n], k)
    return known.mean + k @ known.weights, variance


def project(known: Model, x: ArrayLike, starts: int = 2, iterations: int = 20) -> tuple[Floats, Floats]:
    """Latent points of new frames, by maximum likelihood, and what is lost on the way there and back.

    Parameters
    ----------
    x : (n, D)
        Frames.
    starts
        How many of the model's `starts` each frame sets out from: the likeliest near the latent points, the
        likeliest of those that are spread, and then the likeliest of all, each at some distance from those before.
    iterations
        Of BFGS at most, from each start.

    Returns
    -------
    latent : (n, q)
        Where log p(x | latent point) is largest (Lawrence 2004, eq. 8, noise included).
    error : (n,)
        Distance of each frame from what the model predicts there, metres: Err of [P] with GP-LVM.
    """
    away = np.asarray(x, dtype=np.float64) - known.mean
    along = away @ known.weights.T
    square = np.square(away).sum(axis=1)
    # all starts at once: products of matrices, no search
    left = square[:, None] - 2 * (away @ known.reached.T) + np.square(known.reached).sum(axis=1)
    first = 0.5 * (away.shape[1] * np.log(known.variance) + left / known.variance)
    latent: Floats
    latent, _ = _descend(
        first,
        known.starts,
        known.latent,
        known.scale,
        known.inverse,
        along,
        square,
        away.shape[1],
        starts,
        iterations,
    )
    error: Floats = np.sqrt(
        np.square(away - _covariance(latent, known.latent, known.scale[0]) @ known.weights).sum(axis=1)
    )
    return latent, error


@njit
def _value(x, latent, scale, inverse, along, square, width, k, both, gradient):  # type: ignore[no-untyped-def]
    """−log p(frame | x) without its constant; fills gradient (q,); k (N,) and both (2 N,) are scratch."""
    n, q = latent.shape
    for i in range(n):
        gap = 0.0
        for d in range(q):
            gap += (x[d] - latent[i, d]) ** 2
        k[i] = scale[0] * np.exp(-0.5 * gap)
    both[:] = 0.0
    for i in range(n):
        row, here = inverse[i], k[i]
        for j in range(2 * n):
            both[j] += here * row[j]
    variance, error = scale[0] + scale[1], square
    for i in range(n):
        variance -= k[i] * both[i]
        error += k[i] * (both[n + i] - 2.0 * along[i])
    variance = max(variance, _LEAST * scale[1])
    error = max(error, 0.0)
    # d value = by_variance d variance + by_error d error
    by_error = 0.5 / variance
    by_variance = by_error * (width - error / variance)
    gradient[:] = 0.0
    for i in range(n):
        slope = 2.0 * (by_error * (both[n + i] - along[i]) - by_variance * both[i]) * k[i]
        for d in range(q):
            gradient[d] += slope * (latent[i, d] - x[d])
    return 0.5 * width * np.log(variance) + error * by_error


@njit
def _descend(first, points, latent, scale, inverse, along, square, width, starts, iterations):  # type: ignore[no-untyped-def]
    """Best latent point of each frame, (n, q), and its value, (n,), by BFGS from several starts."""
    n, q = latent.shape
    count = len(first)
    out, values = np.empty((count, q)), np.full(count, np.inf)
    k, both = np.empty(n), np.empty(2 * n)
    x, step, there = np.empty(q), np.empty(q), np.empty(q)
    gradient, after = np.empty(q), np.empty(q)
    hessian, y = np.empty((q, q)), np.empty(q)
    left = np.empty(len(points), dtype=np.bool_)
    for f in range(count):
        left[:] = True
        for start in range(starts):
            at = -1
            low = 2 * n - 1 if start == 1 else 0
            high = 2 * n - 1 if start == 0 else len(points)
            for i in range(low, high):
                if left[i] and (at < 0 or first[f, i] < first[f, at]):
                    at = i
            if at < 0:
                continue
            for i in range(len(points)):
                gap = 0.0
                for d in range(q):
                    gap += (points[i, d] - points[at, d]) ** 2
                if gap <= _APART**2:
                    left[i] = False
            for d in range(len(x)):
                x[d] = points[at, d]
            value = _value(x, latent, scale, inverse, along[f], square[f], width, k, both, gradient)
            # hessian: approximate inverse of the second derivatives
            hessian[:] = 0.0
            fresh = True
            for _ in range(iterations):
                if fresh:
                    size = 0.0
                    for d in range(q):
                        size += gradient[d] ** 2
                    for d in range(q):
                        hessian[d, d] = 0.1 * _LONGEST / max(np.sqrt(size), 1e-12)
                slope, length = 0.0, 0.0
                for d in range(q):
                    step[d] = 0.0
                    for e in range(q):
                        step[d] -= hessian[d, e] * gradient[e]
                    slope += step[d] * gradient[d]
                    length += step[d] ** 2
                if length > _LONGEST**2:
                    shrink = _LONGEST / np.sqrt(length)
                    slope *= shrink
                    for d in range(q):
                        step[d] *= shrink
                if slope > -_ENOUGH:
                    break
                part, then, found = 1.0, value, False
                for _ in range(12):
                    for d in range(q):
                        there[d] = x[d] + part * step[d]
                    then = _value(there, latent, scale, inverse, along[f], square[f], width, k, both, after)
                    if then <= value + 1e-4 * part * slope:
                        found = True
                        break
                    # lowest point of the parabola through both values and the slope
                    part *= min(max(-0.5 * part * slope / (then - value - part * slope), 0.1), 0.5)
                if not found:
                    break
                gained = value - then
                dot = 0.0
                for d in range(q):
                    step[d] *= part
                    y[d] = after[d] - gradient[d]
                    dot += step[d] * y[d]
                    x[d] = there[d]
                    gradient[d] = after[d]
                value = then
                if dot > 1e-10:
                    _update(hessian, step, y, dot, fresh)
                    fresh = False
                if gained < _ENOUGH:
                    break
            if value < values[f]:
                values[f] = value
                out[f] = x
    return out, values


@njit
def _update(hessian, step, y, dot, fresh):  # type: ignore[no-untyped-def]
    """BFGS update of an inverse, scaled to the first step where it is fresh (Nocedal and Wright, 6.17, 6.20)."""
    q = len(step)
    if fresh:
        size = 0.0
        for d in range(q):
            size += y[d] ** 2
        for d in range(q):
            hessian[d, d] = dot / size
    product = np.zeros(q)
    inner = 0.0
    for d in range(q):
        for e in range(q):
            product[d] += hessian[d, e] * y[e]
        inner += y[d] * product[d]
    for d in range(q):
        for e in range(q):
            hessian[d, e] += (1.0 + inner / dot) * step[d] * step[e] / dot
            hessian[d, e] -= (product[d] * step[e] + step[d] * product[e]) / dot
