"""Loops of the left-to-right HMM in the log domain: densities, forward-backward, statistics, durations.

Sequences lie end to end in one array; sequence k is `offsets[k]` to `offsets[k + 1]`. `stay` and `leave` are
the logarithms of each state's two transitions, −inf where there is none; every sequence starts in state 0.
With an exit, a sequence ends in the last state and leaves it; without, it may end in any state.
"""

from __future__ import annotations

import numpy as np

from miburi.compiled import SUMS, njit

_NEGLIGIBLE = 40.0  # exp(−40) is below the spacing of numbers at 1
_LOG_ZERO = -746.0  # exp of it is 0


@njit(fastmath=SUMS)
def log_densities(x, mean, variance):  # type: ignore[no-untyped-def]
    """Log density of each frame in each state's Gaussian, (T, N): x (T, D), mean and variance (N, D)."""
    frames, dims = x.shape
    states = len(mean)
    precision = 1.0 / variance
    out = np.empty((frames, states))
    constant = np.empty(states)
    for i in range(states):
        constant[i] = dims * np.log(2.0 * np.pi)
        for d in range(dims):
            constant[i] += np.log(variance[i, d])
    for t in range(frames):
        for i in range(states):
            total = 0.0
            for d in range(dims):
                z = x[t, d] - mean[i, d]
                total += z * z * precision[i, d]
            out[t, i] = -0.5 * (constant[i] + total)
    return out


@njit(fastmath=SUMS)
def moments(x, gamma, centre):  # type: ignore[no-untyped-def]
    """Weighted sums of x − centre and its squares: (N, D) each.

    x (T, D), gamma (T, N), centre (N, D). Sums around the old means lose no digits.
    """
    frames, dims = x.shape
    states = gamma.shape[1]
    first, second = np.zeros((states, dims)), np.zeros((states, dims))
    for t in range(frames):
        for i in range(states):
            weight = gamma[t, i]
            if weight == 0.0:
                continue
            for d in range(dims):
                z = x[t, d] - centre[i, d]
                first[i, d] += weight * z
                second[i, d] += weight * z * z
    return first, second


@njit
def _add(a, b):  # type: ignore[no-untyped-def]
    """log(exp(a) + exp(b))."""
    if a < b:
        a, b = b, a
    if b == -np.inf or a - b > _NEGLIGIBLE:
        return a
    return a + np.log1p(np.exp(b - a))


@njit
def _exp(a):  # type: ignore[no-untyped-def]
    if a < _LOG_ZERO:
        return 0.0
    return np.exp(a)


@njit
def forward(density, offsets, stay, leave):  # type: ignore[no-untyped-def]
    """Log probability of a sequence's frames up to t and of state i at t: α (T, N)."""
    frames, states = density.shape
    alpha = np.empty((frames, states))
    for k in range(len(offsets) - 1):
        start = offsets[k]
        alpha[start, 0] = density[start, 0]
        for i in range(1, states):
            alpha[start, i] = -np.inf
        for t in range(start + 1, offsets[k + 1]):
            alpha[t, 0] = alpha[t - 1, 0] + stay[0] + density[t, 0]
            for i in range(1, states):
                alpha[t, i] = (
                    _add(alpha[t - 1, i] + stay[i], alpha[t - 1, i - 1] + leave[i - 1]) + density[t, i]
                )
    return alpha


@njit
def backward(density, offsets, stay, leave, exits):  # type: ignore[no-untyped-def]
    """Log probability of a sequence's frames after t, and of its end, given state i at t: β (T, N)."""
    frames, states = density.shape
    beta = np.empty((frames, states))
    for k in range(len(offsets) - 1):
        last = offsets[k + 1] - 1
        for i in range(states):
            beta[last, i] = -np.inf if exits else 0.0
        if exits:
            beta[last, states - 1] = leave[states - 1]
        for t in range(last - 1, offsets[k] - 1, -1):
            following = density[t + 1, states - 1] + beta[t + 1, states - 1]
            beta[t, states - 1] = stay[states - 1] + following
            for i in range(states - 2, -1, -1):
                beyond = leave[i] + following
                following = density[t + 1, i] + beta[t + 1, i]
                beta[t, i] = _add(stay[i] + following, beyond)
    return beta


@njit
def posteriors(alpha, beta, offsets):  # type: ignore[no-untyped-def]
    """γ (T, N), log normaliser of each frame (T,), log-likelihood of each sequence (K,)."""
    frames, states = alpha.shape
    gamma, norm, likelihood = np.empty((frames, states)), np.empty(frames), np.empty(len(offsets) - 1)
    for t in range(frames):
        norm[t] = -np.inf
        for i in range(states):
            norm[t] = _add(norm[t], alpha[t, i] + beta[t, i])
        total = 0.0
        for i in range(states):
            gamma[t, i] = _exp(alpha[t, i] + beta[t, i] - norm[t])
            total += gamma[t, i]
        for i in range(states):
            gamma[t, i] /= total
    for k in range(len(offsets) - 1):
        likelihood[k] = norm[offsets[k + 1] - 1]
    return gamma, norm, likelihood


@njit
def expectation(density, offsets, stay, leave, exits):  # type: ignore[no-untyped-def]
    """E step: γ (T, N), expected numbers of stays and of departures of each state (N,), log-likelihood.

    Without an exit, the end of a sequence is no departure.
    """
    states = density.shape[1]
    alpha, beta = forward(density, offsets, stay, leave), backward(density, offsets, stay, leave, exits)
    gamma, norm, likelihood = posteriors(alpha, beta, offsets)
    stays, departures = np.zeros(states), np.zeros(states)
    for k in range(len(offsets) - 1):
        last = offsets[k + 1] - 1
        for t in range(offsets[k], last):
            for i in range(states):
                if gamma[t, i] > 0.0 and gamma[t + 1, i] > 0.0:
                    stays[i] += _exp(alpha[t, i] + stay[i] + density[t + 1, i] + beta[t + 1, i] - norm[t])
        beyond = 1.0 if exits else 0.0
        for i in range(states - 1, -1, -1):  # every state before the one at the end has been left once
            departures[i] += beyond
            beyond += 0.0 if exits else gamma[last, i]
    return gamma, stays, departures, likelihood.sum()


@njit
def exact_durations(density, offsets, stay, leave, exits):  # type: ignore[no-untyped-def]
    """Sums over χ of 1, d and d² for each state, (3, N), χ from α, β, a_ii and the densities.

    `mean` and `square` are those of the time already spent in a state given the frames so far; they are
    weighted by the probability of leaving the state after frame t.
    """
    states = density.shape[1]
    alpha, beta = forward(density, offsets, stay, leave), backward(density, offsets, stay, leave, exits)
    gamma, norm, _ = posteriors(alpha, beta, offsets)
    sums = np.zeros((3, states))
    mean, square = np.empty(states), np.empty(states)
    for k in range(len(offsets) - 1):
        start, last = offsets[k], offsets[k + 1] - 1
        for t in range(start, last + 1):
            for i in range(states):
                stayed = 0.0
                if t > start and alpha[t, i] > -np.inf:
                    stayed = _exp(alpha[t - 1, i] + stay[i] + density[t, i] - alpha[t, i])
                if stayed > 0.0:
                    square[i] = 1.0 + stayed * (square[i] + 2.0 * mean[i])
                    mean[i] = 1.0 + stayed * mean[i]
                else:
                    square[i] = 1.0
                    mean[i] = 1.0
                if t == last:
                    left = gamma[t, i]
                elif i + 1 < states:
                    left = _exp(alpha[t, i] + leave[i] + density[t + 1, i + 1] + beta[t + 1, i + 1] - norm[t])
                else:
                    left = 0.0
                sums[0, i] += left
                sums[1, i] += left * mean[i]
                sums[2, i] += left * square[i]
    return sums


@njit
def product_durations(density, offsets, stay, leave, exits):  # type: ignore[no-untyped-def]
    """Sums over χ of 1, d and d² for each state, (3, N), χ as the product of γ ([H], eq. 9)."""
    states = density.shape[1]
    alpha, beta = forward(density, offsets, stay, leave), backward(density, offsets, stay, leave, exits)
    gamma, _, _ = posteriors(alpha, beta, offsets)
    sums = np.zeros((3, states))
    for k in range(len(offsets) - 1):
        for i in range(states):
            count, mean, square, before = 0.0, 0.0, 0.0, 0.0  # of the runs that reach frame t
            for t in range(offsets[k], offsets[k + 1]):
                g = gamma[t, i]
                begun = 1.0 - before
                square = g * (square + 2.0 * mean + count + begun)
                mean = g * (mean + count + begun)
                count = g * (count + begun)
                ended = 1.0 - gamma[t + 1, i] if t + 1 < offsets[k + 1] else 1.0
                sums[0, i] += ended * count
                sums[1, i] += ended * mean
                sums[2, i] += ended * square
                before = g
    return sums
