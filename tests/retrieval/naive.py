"""The equations of [P] written out, with their loops: what the kernels must equal."""

import numpy as np
from scipy.stats import multivariate_normal, norm


def subspace(x, dims):
    """Mean and principal directions by a singular value decomposition; as many as the frames vary in."""
    mean = x.mean(axis=0)
    _, s, v = np.linalg.svd(x - mean, full_matrices=False)
    rank = int(np.sum(s / np.sqrt(len(x)) > 1e-6))
    return mean, v[: min(dims, rank)]


def err(mean, basis, x):
    """Eq. (1)."""
    return np.linalg.norm(x - (basis.T @ (basis @ (x - mean)) + mean))


def sm(segment, query, dims, reduction=max):
    mean, basis = subspace(segment, dims)
    return reduction([err(mean, basis, x) for x in query])


def dspm(segment, query, dims, segment_frames, query_frames):
    """Eq. (2) over the frames drawn from each side."""
    h, q = subspace(segment, dims), subspace(query, dims)
    return max(max(err(*h, x) for x in query_frames), max(err(*q, x) for x in segment_frames))


def histogram(x):
    """Eq. (3), normalised."""
    path = np.zeros(x.shape[1])
    for n in range(len(x) - 1):
        for k in range(x.shape[1]):
            path[k] += abs(x[n + 1, k] - x[n, k])
    return path / path.sum() if path.sum() else path


def coefficient(p, q):
    """Eq. (4), the root over both factors."""
    return sum(np.sqrt(a * b) for a, b in zip(p, q, strict=True))


def dtw(x, y):
    """Dynamic time warping by its recursion."""
    best = np.full((len(x) + 1, len(y) + 1), np.inf)
    best[0, 0] = 0
    for i in range(len(x)):
        for j in range(len(y)):
            before = min(best[i, j], best[i, j + 1], best[i + 1, j])
            best[i + 1, j + 1] = np.sum((x[i] - y[j]) ** 2) + before
    return np.sqrt(best[-1, -1])


def gplvm_log_likelihood(latent, signal, noise, frames):
    """Each value of the frames is a Gaussian vector with one covariance (Lawrence 2004, eq. 3), by its density."""
    n = len(latent)
    k = np.zeros((n, n))
    for i in range(n):
        for j in range(n):
            k[i, j] = signal * np.exp(-0.5 * np.sum((latent[i] - latent[j]) ** 2)) + noise * (i == j)
    return sum(multivariate_normal(np.zeros(n), k).logpdf(column) for column in frames.T)


def gplvm_surprise(point, frame, latent, signal, noise, mean, frames):
    """−log density of a frame at a latent point, and its distance from what is predicted there.

    The joint Gaussian of the training frames and the new one, conditioned on the former.
    """
    every = np.vstack([latent, point])
    n = len(latent)
    joint = signal * np.exp(-0.5 * ((every[:, None] - every) ** 2).sum(-1)) + noise * np.eye(n + 1)
    gain = np.linalg.solve(joint[:n, :n], joint[:n, n])
    predicted, variance = mean + gain @ (frames - mean), joint[n, n] - gain @ joint[:n, n]
    density = sum(norm(p, np.sqrt(variance)).logpdf(v) for p, v in zip(predicted, frame, strict=True))
    return -density, np.linalg.norm(frame - predicted)
