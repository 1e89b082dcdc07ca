"""Cutting takes where one motion ends and the next begins (Barbič et al. 2004)."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from miburi.compiled import njit
from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.figures import BODY_JOINTS
from miburi.motion import Floats, Motion

# Variance of a quaternion component below which nothing counts as motion: (0.016)² is about two degrees.
# Without it a person who stands still is a model that every later frame leaves at once.
_NOISE = 2.5e-4
# The same where two neighbouring pieces are compared: poses within about seven degrees are alike.
_ALIKE = 4e-3
# Frames per second that are looked at: motions differ in what is slower than this shows.
_RATE = 30.0
# Seconds on either side of a cut in which neighbours are compared, and the share of the variance that their
# subspaces keep.
_BESIDE, _BESIDE_VARIANCE = 3.0, 0.95

Cuts = NDArray[np.int64]


def pose(motion: Motion, joints: Mapping[str, str] | None = None) -> Floats:
    """What segmentation looks at: rotations of the joints, not where the person stands or faces.

    Parameters
    ----------
    motion
        A take.
    joints
        As in `features`: canonical name → name in this skeleton.

    Returns
    -------
    (T, 4 M) float64
        Quaternions, continuous in sign, of the M joints whose rotation moves one of `figures.BODY_JOINTS` (so
        no wrists, fingers, ankles or head) and that turn at all. What lies at or above the waist counts as
        one, freed of its yaw.
    """
    if len(motion) == 0:
        return np.zeros((0, 0))
    skeleton = motion.skeleton
    found = find_joints(skeleton, joints)
    above = _line(skeleton.parents, found["waist"])
    moves = {j for name in BODY_JOINTS for j in _line(skeleton.parents, found[name])[1:]}.difference(above)
    turn = Rotation.identity(len(motion))
    for j in reversed(above):
        turn = turn * Rotation.from_quat(motion.rotations[:, j])
    q = np.concatenate([_tilt(turn)[:, None], motion.rotations[:, sorted(moves)]], axis=1)
    # q and −q are the same rotation: follow the one nearer to the frame before
    flips = np.einsum("tja,tja->tj", q[1:], q[:-1]) < 0
    q[1:] *= np.cumprod(np.where(flips, -1.0, 1.0), axis=0)[..., None]
    return q[:, np.ptp(q, axis=0).max(axis=1) > 1e-9].reshape(len(q), -1)


def _line(parents: NDArray[np.int32], joint: int) -> list[int]:
    """A joint and all above it, up to the root."""
    line = [joint]
    while parents[line[-1]] >= 0:
        line.append(int(parents[line[-1]]))
    return line


def _tilt(turn: Rotation) -> Floats:
    """How the body has tilted since the first frame, seen from the body, without turns about the vertical."""
    since = (turn * turn[0].inv()).as_quat()
    # swing-twist: the twist about y is (0, y, 0, w) made unit; half a turn about a level axis has none
    twist = since * [0.0, 1.0, 0.0, 1.0]
    twist[np.linalg.norm(twist, axis=1) < 1e-9] = [0.0, 0.0, 0.0, 1.0]
    tilt: Floats = (turn[0].inv() * Rotation.from_quat(twist).inv() * turn).as_quat()
    return tilt


def _main_axes(x: Floats) -> Floats:
    """Poses about their mean, along the principal axes in which they vary by more than half the noise."""
    centred = x - x.mean(axis=0)
    values, vectors = np.linalg.eigh(centred.T @ centred / len(x))
    kept = values > _NOISE / 2
    kept[-1] = True
    return np.ascontiguousarray(centred @ vectors[:, kept][:, ::-1])


@njit
def _sums(x: Floats) -> tuple[Floats, Floats]:
    """Sum of frames (D,) and of their outer products (D, D)."""
    added = np.zeros(x.shape[1])
    for t in range(len(x)):
        for d in range(len(added)):  # numba compiles this in no time, a sum along an axis in seconds
            added[d] += x[t, d]
    return added, x.T @ x


@njit
def _model(added: Floats, squares: Floats, n: int, noise: float, variance: float) -> tuple[Floats, Floats]:
    """PPCA of n frames by their sum and sum of outer products: variances, ascending, along their axes."""
    mean = added / n
    values, vectors = np.linalg.eigh(squares / n - mean[:, None] * mean)
    values = np.maximum(values, 0.0) + noise
    most = variance * values.sum()
    kept, share = 0, 0.0
    while kept < len(values) and (kept == 0 or share < most):
        kept += 1
        share += values[len(values) - kept]
    left = len(values) - kept
    if left > 0:
        # what the subspace leaves out counts as noise of equal size in all its directions
        values[:left] = values[:left].mean()
    return values, vectors


@njit
def _distance(values: Floats, vectors: Floats, mean: Floats, added: Floats, squares: Floats, n: int) -> float:
    """Mean squared Mahalanobis distance of n frames, given as sums, from a model."""
    shift = (added / n)[:, None] * mean
    along = (squares / n - shift - shift.T + mean[:, None] * mean) @ vectors
    h = 0.0
    for i in range(len(values)):
        h += (vectors[:, i] * along[:, i]).sum() / values[i]
    return h


@njit
def _curve(
    x: Floats, start: int, window: int, ahead: int, step: int, variance: float, rise: float, hold: int
) -> tuple[Cuts, Floats, int]:
    """Values of `ppca_curve` and the first cut, −1 for none: a peak `rise` times as high as the valley before
    it that is not passed within `hold` frames. Nothing beyond the cut is looked at; `rise` 0: no cut."""
    room = max(0, (len(x) - ahead - start - window) // step + 1)
    frames, curve = np.empty(room, np.int64), np.empty(room)
    end, count = start + window, 0
    if room == 0:
        return frames, curve, -1
    added, squares = _sums(x[start:end])
    valley, peak, where = np.inf, 0.0, -1
    while end + ahead <= len(x):
        values, vectors = _model(added, squares, end - start, _NOISE, variance)
        seen, seen_squares = _sums(x[end : end + ahead])
        h = _distance(values, vectors, added / (end - start), seen, seen_squares, ahead)
        frames[count], curve[count] = end, h
        count += 1
        if where < 0:
            valley = min(valley, h)
            if rise > 0.0 and h > rise * valley:
                where, peak = end, h
        elif h > peak:
            where, peak = end, h
        elif end - where >= hold:
            return frames[:count], curve[:count], where
        new, new_squares = _sums(x[end : end + step])
        added, squares = added + new, squares + new_squares
        end += step
    # where the take ends soon, a curve that has turned down has had its peak
    return frames[:count], curve[:count], where if where >= 0 and curve[count - 1] < peak else -1


def ppca_curve(
    x: ArrayLike, *, window: int, ahead: int, step: int, variance: float = 0.9, start: int = 0
) -> tuple[Cuts, Floats]:
    """How far the frames ahead are from a growing model of the frames since `start`.

    Parameters
    ----------
    x : (T, D)
        Poses, as from `pose`.
    window, ahead, step
        Frames of the first model, of the look-ahead, and between two values of the curve.
    variance
        Share of the variance that the model's subspace keeps (τ); it fixes the number of dimensions.
    start
        First frame of the model.

    Returns
    -------
    frame : (N,) int64
        Where each look-ahead begins: a cut is proposed there.
    distance : (N,) float64
        H, the mean squared Mahalanobis distance of the frames ahead (Barbič et al. 2004, section 3.2).
    """
    poses = np.ascontiguousarray(x, dtype=np.float64)
    frames, curve, _ = _curve(poses, start, window, ahead, step, variance, 0.0, 0)
    return frames, curve


def _one_way(
    x: Floats, window: int, ahead: int, step: int, variance: float, rise: float, method: str
) -> list[int]:
    """Cuts one after the other, the model beginning anew at each."""
    cuts: list[int] = []
    start = 0
    while True:
        if method == "PPCA":
            cut = int(_curve(x, start, window, ahead, step, variance, rise, ahead // 4)[2])
        else:
            cut = _next_jump(x, start, window, step, variance)
        if cut < 0:
            return cuts
        cuts.append(cut)
        start = cut


@njit
def _surprise(x: Floats, variance: float) -> float:
    """Twice the negative log-likelihood of frames under their own PPCA, without the constant."""
    n = len(x)
    added, squares = _sums(x)
    values, vectors = _model(added, squares, n, _ALIKE, variance)
    surprise: float = n * (_distance(values, vectors, added / n, added, squares, n) + np.log(values).sum())
    return surprise


def difference(x: Floats, start: int, cut: int, end: int, variance: float = _BESIDE_VARIANCE) -> float:
    """How much worse one PPCA explains two neighbouring pieces than one for each does.

    Parameters
    ----------
    x : (T, D)
        Poses.
    start, cut, end
        Frames: the pieces are start ≤ t < cut and cut ≤ t < end.

    Returns
    -------
    float
        Twice the log-likelihood ratio, divided by the number of frames; pieces that are one motion give
        little.
    """
    apart = _surprise(x[start:cut], variance) + _surprise(x[cut:end], variance)
    return float(_surprise(x[start:end], variance) - apart) / (end - start)


def _grouped(cuts: list[int], near: int) -> list[int]:
    """Cuts that lie within less than `near` frames of a group's first are one, at the group's mean."""
    groups: list[list[int]] = []
    for cut in sorted(cuts):
        if groups and cut - groups[-1][0] < near:
            groups[-1].append(cut)
        else:
            groups.append([cut])
    return [round(sum(g) / len(g)) for g in groups]


def _told_apart(x: Floats, cuts: list[int], least: float, beside: int) -> list[int]:
    """Drop cuts, the least first, whose sides differ by less than `least` (`difference`)."""
    found = list(cuts)

    def sides(i: int) -> float:
        start = max(found[i - 1] if i else 0, found[i] - beside)
        end = min(found[i + 1] if i + 1 < len(found) else len(x), found[i] + beside)
        return difference(x, start, found[i], end)

    by = [sides(i) for i in range(len(found))]
    while found:
        i = int(np.argmin(by))
        if by[i] >= least:
            break
        del found[i], by[i]
        for k in range(max(0, i - 1), min(len(found), i + 1)):
            by[k] = sides(k)
    return found


def segment(
    motion: Motion,
    *,
    method: Literal["PPCA", "PCA"] = "PPCA",
    variance: float = 0.9,
    window_s: float = 1.5,
    ahead_s: float = 1.25,
    step_s: float = 1 / 6,
    rise: float = 4.0,
    near_s: float = 2 / 3,
    differ: float = 4.5,
    joints: Mapping[str, str] | None = None,
) -> Cuts:
    """Frames at which a take is cut into single motions.

    Parameters
    ----------
    motion
        A take.
    method
        "PPCA": the distribution of the frames ahead leaves that of the frames since the last cut. "PCA": the
        error of projecting onto the subspace of the first frames rises faster than it did.
    variance
        Share of the variance that the subspace keeps (τ).
    window_s
        Seconds of the first model after a cut.
    ahead_s
        Seconds of the look-ahead.
    step_s
        Seconds between two tests.
    rise
        PPCA: a cut is made at a peak of H that is at least so many times the valley before it (R). The ratio,
        not the difference, because H of a lively and of a quiet motion differ by orders of magnitude.
    near_s
        PPCA looks forwards and backwards in time: a simpler motion that follows a richer one never leaves its
        model, but the richer one leaves that of the simpler. Cuts of either way that are nearer than this are
        one, at their mean.
    differ
        PPCA: a cut is kept where `difference` of the (at most) three seconds on its two sides is at least
        this.
    joints
        As in `features`.

    Returns
    -------
    (C,) int64
        Frames 0 < c < T, increasing, at which new motions begin.

    Raises
    ------
    InputError
        A setting is out of range, or the skeleton lacks a joint.

    Notes
    -----
    About 30 frames per second are looked at, whatever the take's rate. Mean and covariance of the model are
    updated as frames come; each test costs an eigendecomposition of the few directions that the take varies
    in.

    References
    ----------
    J. Barbič et al., Segmenting motion capture data into distinct behaviors, Graphics Interface 2004,
    sections 3.1 and 3.2.
    """
    if method not in ("PPCA", "PCA"):
        raise InputError(f"segmentation method {method!r}, expected 'PPCA' or 'PCA'")
    if not 0 < variance < 1 or not rise > 1:
        raise InputError(
            f"variance {variance} and rise {rise}, expected a share between 0 and 1 and a factor above 1"
        )
    if not min(window_s, ahead_s, step_s) > 0:
        raise InputError("window_s, ahead_s and step_s must be positive")
    if not (near_s >= 0 and differ >= 0):
        raise InputError("near_s and differ must not be negative")
    stride = max(1, round(motion.fps / _RATE))
    fps = motion.fps / stride
    window, ahead, step, near, beside = (
        max(1, round(s * fps)) for s in (window_s, ahead_s, step_s, near_s, _BESIDE)
    )
    x = pose(motion[::stride], joints)
    if x.size == 0:
        return np.zeros(0, dtype=np.int64)
    x = _main_axes(x)
    cuts = _one_way(x, window, ahead, step, variance, rise, method)
    if method == "PPCA":
        back = _one_way(np.ascontiguousarray(x[::-1]), window, ahead, step, variance, rise, method)
        cuts = _grouped(cuts + [len(x) - c for c in back], near)
        cuts = _told_apart(x, cuts, differ, beside)
    return stride * np.array(cuts, dtype=np.int64)


def _next_jump(x: Floats, start: int, window: int, step: int, variance: float) -> int:
    """PCA variant (section 3.1): where the projection error's growth exceeds its mean by three deviations."""
    if start + 2 * window > len(x):
        return -1
    first = x[start : start + window]
    mean = first.mean(axis=0)
    values, vectors = np.linalg.eigh(np.cov(first.T, bias=True).reshape(x.shape[1], -1))
    values = np.maximum(values[::-1], 0.0) + _NOISE
    kept = int(np.searchsorted(np.cumsum(values), variance * values.sum())) + 1
    centred = x[start:] - mean
    along = centred @ vectors[:, ::-1][:, :kept]
    error = np.cumsum((centred**2).sum(axis=1) - (along**2).sum(axis=1))
    lag = max(1, window // 3)
    # growth over `lag` frames that end at or after the first window's end: inside it the error was minimised
    growth = (error[lag:] - error[:-lag])[window - lag :]
    n = np.arange(1, len(growth) + 1)
    average = np.cumsum(growth) / n
    deviation = np.sqrt(np.maximum(np.cumsum(growth**2) / n - average**2, 0.0))
    # a mean and a deviation need as many frames as the subspace did
    tested = np.arange(window, len(growth), step)
    jump = tested[growth[tested] > average[tested - 1] + 3.0 * deviation[tested - 1] + lag * _NOISE]
    return int(start + window + jump[0]) if len(jump) else -1


def pieces(cuts: ArrayLike, frames: int, shortest: int = 1) -> NDArray[np.int64]:
    """The pieces between cuts.

    Parameters
    ----------
    cuts
        Frames at which new motions begin, increasing, 0 < c < `frames`.
    frames
        Length of the take, T.
    shortest
        Frames. As long as a piece is shorter, the shortest one (the first of equals) is joined to the shorter
        of its neighbours (the one before it, if equal): it was probably cut from there.

    Returns
    -------
    (S, 2) int64
        Start (inclusive) and end (exclusive); they cover the take.

    Raises
    ------
    InputError
        Cuts are not increasing or not inside the take.
    """
    inner = np.asarray(cuts, dtype=np.int64).reshape(-1)
    bounds = [0, *inner.tolist(), frames]
    if frames < 1 or any(a >= b for a, b in pairwise(bounds)):
        raise InputError(f"cuts {inner.tolist()} do not increase inside a take of {frames} frames")
    while len(bounds) > 2:
        length = np.diff(bounds)
        i = int(length.argmin())
        if length[i] >= shortest:
            break
        before = length[i - 1] if i > 0 else np.inf
        after = length[i + 1] if i + 1 < len(length) else np.inf
        del bounds[i if before <= after else i + 1]
    return np.stack([bounds[:-1], bounds[1:]], axis=1).astype(np.int64)
