"""Subspaces of segments and how far frames and subspaces are from each other ([P], eqs. 1 and 2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from miburi.compiled import njit
from miburi.motion import Floats

# A direction in which frames differ by less (root of the mean square, metres) is rounding of float32, not
# motion.
_STILL = 1e-6


def fit(x: ArrayLike, dims: int) -> tuple[Floats, Floats]:
    """Mean and principal directions of a segment.

    Parameters
    ----------
    x : (n, D)
        Frames, n ≥ 1.
    dims
        Number of directions.

    Returns
    -------
    mean : (D,) float64
    basis : (dims, D) float64
        Orthonormal rows, largest variance first, each with its largest component positive. Frames that vary
        in fewer directions (n ≤ `dims`, or a pose held still) leave the last rows zero: such a row projects
        nothing.
    """
    frames = np.asarray(x, dtype=np.float64)
    mean = frames.mean(axis=0)
    basis = np.zeros((dims, frames.shape[1]))
    centred = frames - mean
    # the scatter matrix is small (42 × 42) whatever the segment's length
    variance, directions = np.linalg.eigh(centred.T @ centred / len(frames))
    rank = min(dims, int(np.sum(variance > max(_STILL**2, 1e-12 * variance[-1]))), len(frames) - 1)
    rows = directions[:, ::-1][:, :rank].T
    largest = np.abs(rows).argmax(axis=1)
    basis[:rank] = rows * np.sign(rows[np.arange(rank), largest])[:, None]
    return mean, basis


@njit
def residuals(block, mean, basis, total, along):  # type: ignore[no-untyped-def]
    """Fill total[:n] with Err² (eq. 1) of the frames in the columns of block (D, n)."""
    width, n = block.shape
    dims = basis.shape[0]
    for j in range(n):
        total[j] = 0.0
    for m in range(dims):
        for j in range(n):
            along[m, j] = 0.0
    for d in range(width):
        centre = mean[d]
        row = block[d]
        for j in range(n):
            v = row[j] - centre
            total[j] += v * v
        for m in range(dims):
            b = basis[m, d]
            for j in range(n):
                along[m, j] += b * (row[j] - centre)
    for m in range(dims):
        for j in range(n):
            total[j] -= along[m, j] * along[m, j]


@njit
def reduced(total, n, mean_not_max):  # type: ignore[no-untyped-def]
    """Largest or mean Err of the first n squares; rounding below zero is zero."""
    worst, added = 0.0, 0.0
    for j in range(n):
        worst = max(worst, total[j])
        added += np.sqrt(max(total[j], 0.0))
    return added / n if mean_not_max else np.sqrt(worst)


@njit
def frames_to_subspaces(frames, means, bases, mean_not_max):  # type: ignore[no-untyped-def]
    """Err(H_s, x_n) over the query's frames for every segment s.

    frames (D, n); means (S, D); bases (S, dims, D); returns (S,): the largest, or the mean.
    """
    s, dims, n = len(means), bases.shape[1], frames.shape[1]
    total, along, out = np.empty(n), np.empty((dims, n)), np.empty(s)
    for i in range(s):
        residuals(frames, means[i], bases[i], total, along)
        out[i] = reduced(total, n, mean_not_max)
    return out


@njit
def samples_to_subspace(blocks, offsets, mean, basis):  # type: ignore[no-untyped-def]
    """max_n Err(Q, x^H_n) for every segment.

    blocks: the segments' frames, each segment as a (D, n_s) block, end to end; offsets (S + 1,): first frame
    of each; mean (D,) and basis (dims, D) of the query; returns (S,).
    """
    s, width, dims = len(offsets) - 1, len(mean), len(basis)
    longest = 0
    for i in range(s):
        longest = max(longest, offsets[i + 1] - offsets[i])
    total, along, out = np.empty(longest), np.empty((dims, longest)), np.empty(s)
    for i in range(s):
        n = offsets[i + 1] - offsets[i]
        block = blocks[width * offsets[i] : width * offsets[i + 1]].reshape(width, n)
        residuals(block, mean, basis, total, along)
        out[i] = reduced(total, n, False)
    return out


@njit
def shared(bases, basis):  # type: ignore[no-untyped-def]
    """Σ cos² of the canonical angles between each segment's subspace and the query's.

    bases (dims, D, S), segments side by side; basis (dims, D); orthonormal or zero rows; returns (S,). The
    sum of the squared singular values of H Qᵀ is the sum of its squared entries, so no decomposition is
    needed.
    """
    dims, width, s = bases.shape
    out = np.zeros(s)
    lanes = 128
    dot = np.empty((len(basis), lanes))
    for first in range(0, s, lanes):
        n = min(lanes, s - first)
        for a in range(dims):
            dot[:] = 0.0
            for d in range(width):
                # slices, not first + j: the compiler sees that indices are not negative and runs lanes in
                # parallel
                here = bases[a, d, first : first + n]
                for b in range(len(basis)):
                    q, line = basis[b, d], dot[b]
                    for j in range(n):
                        line[j] += here[j] * q
            for b in range(len(basis)):
                for j in range(n):
                    out[first + j] += dot[b, j] * dot[b, j]
    return out
