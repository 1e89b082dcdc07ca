"""The equations of [H] written out, with their loops: what the kernels must equal."""

from itertools import pairwise

import numpy as np
from scipy.special import logsumexp
from scipy.stats import multivariate_normal


def delta_window(half):
    """Eq. (2)."""
    return [i / sum(j**2 for j in range(-half, half + 1)) for i in range(-half, half + 1)]


def square_window(half):
    """Eq. (3)."""
    window = range(-half, half + 1)
    s0, s1, s2 = (sum(j**power for j in window) for power in (0, 2, 4))
    return [(s0 * i**2 - s1) / (2 * (s2 * s0 - s1**2)) for i in window]


def deltas(x, half):
    """x, Δx, Δ²x with the first and the last frame repeated outside."""
    out = []
    for t in range(len(x)):
        rows = [x[t]]
        for length, window in zip(half, (delta_window(half[0]), square_window(half[1])), strict=True):
            frames = [min(max(t + i, 0), len(x) - 1) for i in range(-length, length + 1)]
            rows.append(sum(c * x[f] for c, f in zip(window, frames, strict=True)))
        out.append(np.concatenate(rows))
    return np.array(out)


def log_densities(x, mean, variance):
    covariances = [np.diag(v) if np.ndim(v) == 1 else v for v in variance]
    return np.array(
        [
            [multivariate_normal.logpdf(frame, m, c) for m, c in zip(mean, covariances, strict=True)]
            for frame in x
        ]
    )


def paths(frames, states, exits):
    """All ways through the states: from the first one, in steps of 0 or 1; with an exit, to the last one."""
    found = [[0]]
    for _ in range(frames - 1):
        found = [[*p, n] for p in found for n in (p[-1], p[-1] + 1) if n < states]
    return [p for p in found if not exits or p[-1] == states - 1]


def joint(path, density, stay, leave, exits):
    """Log probability of a path and the frames."""
    total = sum(density[t, i] for t, i in enumerate(path))
    for i, n in pairwise(path):
        total += stay[i] if i == n else leave[i]
    return total + (leave[path[-1]] if exits else 0.0)


def posterior(density, stay, leave, exits):
    """Every path with its probability given the frames, and the log-likelihood."""
    ways = paths(*density.shape, exits)
    logs = np.array([joint(p, density, stay, leave, exits) for p in ways])
    total = logsumexp(logs)
    return list(zip(ways, np.exp(logs - total), strict=True)), total


def expectation(densities, stay, leave, exits):
    """γ, expected stays and departures of each state, log-likelihood, by enumeration of paths."""
    states = densities[0].shape[1]
    gammas, stays, departures, likelihood = [], np.zeros(states), np.zeros(states), 0.0
    for density in densities:
        ways, total = posterior(density, stay, leave, exits)
        likelihood += total
        gamma = np.zeros(density.shape)
        for path, p in ways:
            for t, i in enumerate(path):
                gamma[t, i] += p
            for i, n in pairwise(path):
                (stays if i == n else departures)[i] += p
            if exits:
                departures[path[-1]] += p
        gammas.append(gamma)
    return np.concatenate(gammas), stays, departures, likelihood


def exact_sums(densities, stay, leave, exits):
    """Sums over χ of 1, d and d², χ by enumeration of paths."""
    sums = np.zeros((3, densities[0].shape[1]))
    for density in densities:
        for path, p in posterior(density, stay, leave, exits)[0]:
            for i in set(path):
                d = path.count(i)
                sums[:, i] += p * np.array([1, d, d**2])
    return sums


def product_sums(gammas):
    """Eq. (9), its upper bound t1, summed as eqs. (10) and (11) want it."""
    states = gammas[0].shape[1]
    sums = np.zeros((3, states))
    for gamma in gammas:
        frames = len(gamma)
        padded = np.vstack([np.zeros(states), gamma, np.zeros(states)])  # γ of frames 0 and T + 1
        for i in range(states):
            for t0 in range(1, frames + 1):
                for t1 in range(t0, frames + 1):
                    chi = (1 - padded[t0 - 1, i]) * (1 - padded[t1 + 1, i])
                    for t in range(t0, t1 + 1):
                        chi *= padded[t, i]
                    d = t1 - t0 + 1
                    sums[:, i] += chi * np.array([1, d, d**2])
    return sums


def window_matrix(frames, half):
    """W of eq. (23) for one feature, (3 T, T): static, Δ, Δ²; rows that reach outside are zero."""
    rows = []
    for window in ([1.0], delta_window(half[0]), square_window(half[1])):
        length = len(window) // 2
        for t in range(frames):
            row = np.zeros(frames)
            if t - length >= 0 and t + length < frames:
                row[t - length : t + length + 1] = window
            rows.append(row)
    return np.array(rows)


def mlpg(mean, variance, half):
    """Eqs. (23) to (25), one dense system per feature."""
    frames, features = mean.shape[0], mean.shape[1] // 3
    w = window_matrix(frames, half)
    out = np.empty((frames, features))
    for m in range(features):
        precision = np.diag(1.0 / variance[:, m::features].T.ravel())
        mu = mean[:, m::features].T.ravel()
        out[:, m] = np.linalg.solve(w.T @ precision @ w, w.T @ precision @ mu)
    return out


def rows_of_frame(frames, t, half):
    """Rows of W that lie within the frames at t: which window (0, 1, 2) and its coefficients over all frames."""
    w = window_matrix(frames, half)
    return [(k, w[k * frames + t]) for k in range(3) if w[k * frames + t].any()]


def full_parts(mean, covariance, half):
    """For each frame, W's rows over all features together (n, T M), their means and their covariance."""
    frames, dims = mean.shape[0], mean.shape[1] // 3
    for t in range(frames):
        rows, chosen = [], []
        for k, row in rows_of_frame(frames, t, half):
            for m in range(dims):
                all_features = np.zeros((frames, dims))
                all_features[:, m] = row
                rows.append(all_features.ravel())
                chosen.append(k * dims + m)
        yield np.array(rows), mean[t][chosen], covariance[t][np.ix_(chosen, chosen)]


def full_mlpg(mean, covariance, half):
    """Eqs. (23) to (25) with full covariances, one dense system."""
    frames, dims = mean.shape[0], mean.shape[1] // 3
    left, right = np.zeros((frames * dims, frames * dims)), np.zeros(frames * dims)
    for w, mu, u in full_parts(mean, covariance, half):
        left += w.T @ np.linalg.inv(u) @ w
        right += w.T @ np.linalg.inv(u) @ mu
    return np.linalg.solve(left, right).reshape(frames, dims)


def log_likelihood(x, mean, covariance, half):
    """Log density of a trajectory and its deltas, frame after frame."""
    return sum(
        multivariate_normal.logpdf(w @ x.ravel(), mu, u) for w, mu, u in full_parts(mean, covariance, half)
    )
