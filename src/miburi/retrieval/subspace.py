"""Subspaces of segments and how far frames and subspaces are from each other ([P], eqs. 1 and 2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import blas, lapack

from miburi.compiled import SUMS, njit
from miburi.motion import Floats
from miburi.retrieval.ranking import longest

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
    frames = np.ascontiguousarray(x, dtype=np.float64)
    mean, centred = _centred(frames)
    # the scatter matrix is small (42 × 42) whatever the segment's length
    scatter = blas.dsyrk(1.0, centred.T, lower=1)
    variance, directions = _principal(scatter, min(dims, len(mean)))
    least = max(len(frames) * _STILL**2, 1e-12 * float(variance[0]))
    return mean, _oriented(directions, variance, least, len(frames) - 1, dims)


@njit
def _centred(frames):  # type: ignore[no-untyped-def]
    """Mean (D,) of frames (n, D), and the frames less their mean."""
    n, width = frames.shape
    mean, out = np.zeros(width), np.empty((n, width))
    for i in range(n):
        for d in range(width):
            mean[d] += frames[i, d]
    for d in range(width):
        mean[d] /= n
    for i in range(n):
        for d in range(width):
            out[i, d] = frames[i, d] - mean[d]
    return mean, out


def _principal(scatter: Floats, dims: int) -> tuple[Floats, Floats]:
    """The largest eigenvalues (dims,) of a symmetric matrix (D, D) and their directions (dims, D), largest first.

    Only what is not above the diagonal is read. LAPACK's parts of `eigh`, for the directions that are wanted only: that
    takes half as long.
    """
    width = len(scatter)
    if width > 1:
        reflected, diagonal, beside, tau, _ = lapack.dsytrd(scatter, lower=1)
        wanted = 2, 0.0, 0.0, width - dims + 1, width
        scratch = np.zeros(width)  # one longer than what it says, as `dstemr` wants it
        scratch[:-1] = beside
        _, variance, directions, wrong = lapack.dstemr(diagonal, scratch, *wanted)
        if not wrong:
            return variance[dims - 1 :: -1], _reflected(reflected, tau, directions, dims)
    variance, directions = np.linalg.eigh(scatter)
    return variance[: -dims - 1 : -1], np.ascontiguousarray(directions[:, : -dims - 1 : -1].T)


@njit(fastmath=SUMS)
def _reflected(reflectors, tau, directions, dims):  # type: ignore[no-untyped-def]
    """The last `dims` columns of directions as rows, last first, by the reflections that `dsytrd` left below."""
    width = len(tau) + 1
    out = np.empty((dims, width))
    for m in range(dims):
        row = out[m]
        for d in range(width):
            row[d] = directions[d, dims - 1 - m]
        for k in range(width - 2, -1, -1):
            column = reflectors[k + 2 :, k]
            along, rest = row[k + 1], row[k + 2 :]
            for d in range(len(rest)):
                along += column[d] * rest[d]
            along *= tau[k]
            row[k + 1] -= along
            for d in range(len(rest)):
                rest[d] -= along * column[d]
    return out


@njit
def _oriented(directions, variance, least, most, dims):  # type: ignore[no-untyped-def]
    """Rows (dims, D): directions of more than the least variance, at most so many, the largest component positive."""
    basis = np.zeros((dims, directions.shape[1]))
    for m in range(min(len(directions), most)):
        if variance[m] > least:
            row, largest = directions[m], 0
            for d in range(len(row)):
                if abs(row[d]) > abs(row[largest]):
                    largest = d
            sign = 1.0 if row[largest] > 0.0 else -1.0
            for d in range(len(row)):
                basis[m, d] = sign * row[d]
    return basis


@njit
def residuals(block, mean, basis, total, scratch):  # type: ignore[no-untyped-def]
    """Fill total[:n] with Err² (eq. 1) of the frames in the columns of block (D, n); scratch (≥ dims + 3, ≥ n)."""
    width, n = block.shape
    dims = len(basis)
    for j in range(n):
        total[j] = 0.0
    for m in range(dims):
        for j in range(n):
            scratch[m, j] = 0.0
    p, q, r = scratch[dims], scratch[dims + 1], scratch[dims + 2]
    d = 0
    while d + 3 <= width:  # three values at a time: sums are read and written a third as often
        row0, row1, row2 = block[d], block[d + 1], block[d + 2]
        mean0, mean1, mean2 = mean[d], mean[d + 1], mean[d + 2]
        for j in range(n):
            x, y, z = row0[j] - mean0, row1[j] - mean1, row2[j] - mean2
            p[j], q[j], r[j] = x, y, z
            total[j] += x * x + y * y + z * z
        for m in range(dims):
            along, a, b, c = scratch[m], basis[m, d], basis[m, d + 1], basis[m, d + 2]
            for j in range(n):
                along[j] += a * p[j] + b * q[j] + c * r[j]
        d += 3
    while d < width:
        row0, mean0 = block[d], mean[d]
        for j in range(n):
            p[j] = row0[j] - mean0
            total[j] += p[j] * p[j]
        for m in range(dims):
            along, a = scratch[m], basis[m, d]
            for j in range(n):
                along[j] += a * p[j]
        d += 1
    for m in range(dims):
        for j in range(n):
            total[j] -= scratch[m, j] * scratch[m, j]


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
    total, scratch, out = np.empty(n), np.empty((dims + 3, n)), np.empty(s)
    for i in range(s):
        residuals(frames, means[i], bases[i], total, scratch)
        out[i] = reduced(total, n, mean_not_max)
    return out


@njit
def samples_to_subspace(blocks, offsets, mean, basis):  # type: ignore[no-untyped-def]
    """max_n Err(Q, x^H_n) for every segment.

    blocks: the segments' frames, each segment as a (D, n_s) block, end to end; offsets (S + 1,): first frame
    of each; mean (D,) and basis (dims, D) of the query; returns (S,).
    """
    s, width, dims = len(offsets) - 1, len(mean), len(basis)
    most = longest(offsets)
    total, scratch, out = np.empty(most), np.empty((dims + 3, most)), np.empty(s)
    for i in range(s):
        n = offsets[i + 1] - offsets[i]
        block = blocks[width * offsets[i] : width * offsets[i + 1]].reshape(width, n)
        residuals(block, mean, basis, total, scratch)
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


@njit
def shared_with(one, basis):  # type: ignore[no-untyped-def]
    """`shared` of one segment (dims, D), to the same bits."""
    out, dot = 0.0, np.empty(len(basis))
    for a in range(len(one)):
        for b in range(len(basis)):
            dot[b] = 0.0
        for d in range(one.shape[1]):
            for b in range(len(basis)):  # sums that do not wait for each other
                dot[b] += one[a, d] * basis[b, d]
        for b in range(len(basis)):
            out += dot[b] * dot[b]
    return out
