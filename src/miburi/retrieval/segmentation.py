"""Cutting takes where one motion ends and the next begins (Barbič et al. 2004)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.figures import BODY_JOINTS
from miburi.motion import Floats, Motion

# Variance of a quaternion component below which nothing counts as motion: (0.016)² is about two degrees.
# Without it a person who stands still is a model that every later frame leaves at once.
_NOISE = 2.5e-4

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


def ppca_curve(
    x: ArrayLike, *, window: int, ahead: int, step: int, variance: float = 0.95, start: int = 0
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
    poses = np.asarray(x, dtype=np.float64)
    curve = list(_growing(poses, start, window, ahead, step, variance))
    return np.array([k for k, _ in curve], dtype=np.int64), np.array([h for _, h in curve])


def _growing(
    x: Floats, start: int, window: int, ahead: int, step: int, variance: float
) -> Iterator[tuple[int, float]]:
    """Values (frame, H) of `ppca_curve` one after the other, while the look-ahead is inside the take."""
    end, n = start + window, window
    if end + ahead > len(x):
        return
    added = x[start:end].sum(axis=0)
    squares = x[start:end].T @ x[start:end]
    while end + ahead <= len(x):
        mean = added / n
        values, vectors = np.linalg.eigh(squares / n - np.outer(mean, mean))
        values = np.maximum(values[::-1], 0.0) + _NOISE
        kept = int(np.searchsorted(np.cumsum(values), variance * values.sum())) + 1
        if kept < len(values):
            # what the subspace leaves out counts as noise of equal size in all its directions
            values[kept:] = values[kept:].mean()
        along = (x[end : end + ahead] - mean) @ vectors[:, ::-1]
        yield end, float((along * along / values).sum() / ahead)
        new = x[end : end + step]
        added += new.sum(axis=0)
        squares += new.T @ new
        end, n = end + step, n + step


def _next_cut(curve: Iterator[tuple[int, float]], rise: float, hold: int) -> int | None:
    """The first peak `rise` times as high as the valley before it that is not passed within `hold` frames."""
    valley, peak, where, distance = np.inf, 0.0, -1, 0.0
    for frame, distance in curve:
        if where < 0:
            valley = min(valley, distance)
            if distance > rise * valley:
                where, peak = frame, distance
        elif distance > peak:
            where, peak = frame, distance
        elif frame - where >= hold:
            return where
    # where the take ends soon, a curve that has turned down has had its peak
    return where if distance < peak else None


def segment(
    motion: Motion,
    *,
    method: Literal["PPCA", "PCA"] = "PPCA",
    variance: float = 0.95,
    window_s: float = 1.5,
    ahead_s: float = 1.25,
    step_s: float = 1 / 12,
    rise: float = 5.0,
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
        Seconds of the first model after a cut; no piece but the last is shorter.
    ahead_s
        Seconds of the look-ahead.
    step_s
        Seconds between two tests.
    rise
        PPCA: a cut is made at a peak of H that is at least so many times the valley before it (R). The ratio,
        not the difference, because H of a lively and of a quiet motion differ by orders of magnitude.
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
    if min(window_s, ahead_s, step_s) <= 0:
        raise InputError("window_s, ahead_s and step_s must be positive")
    window, ahead, step = (max(1, round(s * motion.fps)) for s in (window_s, ahead_s, step_s))
    x = pose(motion, joints)
    if x.size == 0:
        return np.zeros(0, dtype=np.int64)
    # sums of squares lose fewer digits about the take's mean
    x -= x.mean(axis=0)
    cuts: list[int] = []
    start = 0
    while True:
        if method == "PPCA":
            cut = _next_cut(_growing(x, start, window, ahead, step, variance), rise, ahead // 4)
        else:
            cut = _next_jump(x, start, window, step, variance)
        if cut is None:
            return np.array(cuts, dtype=np.int64)
        cuts.append(cut)
        start = cut


def _next_jump(x: Floats, start: int, window: int, step: int, variance: float) -> int | None:
    """PCA variant (section 3.1): where the projection error's growth exceeds its mean by three deviations."""
    if start + 2 * window > len(x):
        return None
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
    return int(start + window + jump[0]) if len(jump) else None


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
