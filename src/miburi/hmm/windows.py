"""Static and dynamic features: windows of regression coefficients ([H], eqs. 2 and 3)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError

Floats = NDArray[np.float64]
Half = tuple[int, int]


def windows(half: Half = (1, 1)) -> tuple[Floats, Floats]:
    """Coefficients of the Δ and Δ² windows, from −L to L.

    Parameters
    ----------
    half
        Half lengths L1, L2; each at least 1.

    Returns
    -------
    (2 L1 + 1,), (2 L2 + 1,)
        (−½, 0, ½) and (¼, −½, ¼) for half lengths of 1.

    Notes
    -----
    [H], eqs. 2 and 3. For L2 = 1, eq. 3 is a quarter of the second difference.
    """
    delta, square = _coefficients(*checked_half(half))
    return delta.copy(), square.copy()


@cache
def _coefficients(first: int, second: int) -> tuple[Floats, Floats]:
    i = np.arange(-first, first + 1, dtype=np.float64)
    delta = i / (i**2).sum()
    i = np.arange(-second, second + 1, dtype=np.float64)
    s0, s1, s2 = float(len(i)), (i**2).sum(), (i**4).sum()
    return delta, (s0 * i**2 - s1) / (2 * (s2 * s0 - s1**2))


def checked_half(half: Sequence[int]) -> Half:
    """Half lengths as two whole numbers of at least 1, or an InputError."""
    values = tuple(half)
    if len(values) != 2 or any(int(v) != v or v < 1 for v in values):
        raise InputError(
            f"half lengths of the delta windows are {values}, expected two whole numbers, 1 or more"
        )
    return int(values[0]), int(values[1])


def checked_frames(x: ArrayLike, what: str) -> Floats:
    """Frames as a (T, D) array of finite float64 numbers, T and D at least 1, or an InputError."""
    frames = shaped_frames(x, what)
    bad = np.flatnonzero(~np.isfinite(frames).all(axis=1))
    if len(bad):
        column = int(np.flatnonzero(~np.isfinite(frames[bad[0]]))[0])
        raise InputError(
            f"{what}, frame {bad[0]}, column {column}: found {frames[bad[0], column]}, "
            "expected a finite number"
        )
    return frames


def shaped_frames(x: ArrayLike, what: str) -> Floats:
    """`checked_frames`, any numbers."""
    try:
        frames = np.ascontiguousarray(x, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{what}: found something else than numbers, expected (T, D) of them") from None
    if frames.ndim != 2 or 0 in frames.shape:
        raise InputError(
            f"{what}: found an array of shape {frames.shape}, expected (T, D) with a frame at least"
        )
    return frames


def deltas(x: ArrayLike, half: Half = (1, 1)) -> Floats:
    """Add Δ and Δ² to frames; the first and the last frame are repeated outside.

    Parameters
    ----------
    x : (T, M)
        Frames of a whole recording (an interval's first Δ sees the frame before it: cut afterwards).
    half
        Half lengths L1, L2 of the windows.

    Returns
    -------
    (T, 3 M)
        x, Δx, Δ²x, in x's unit (per frame, per frame²). A constant has deltas of exactly 0.

    Raises
    ------
    InputError
        x is not (T, M), holds NaN or infinity, or a half length is below 1.

    Notes
    -----
    [H], eqs. 2 and 3, and its treatment of the ends.
    """
    frames = checked_frames(x, "deltas")
    delta, square = windows(half)
    t, m = frames.shape
    out = np.zeros((t, 3 * m))
    out[:, :m] = frames
    longest = max(half)
    padded = np.concatenate([frames[:1].repeat(longest, 0), frames, frames[-1:].repeat(longest, 0)])
    # pairs of frames: Δ's window is odd, Δ²'s is even and sums to 0, so that a constant gives 0 without
    # rounding
    for i in range(1, half[0] + 1):
        out[:, m : 2 * m] += delta[half[0] + i] * (
            _shifted(padded, longest + i, t) - _shifted(padded, longest - i, t)
        )
    for i in range(1, half[1] + 1):
        after, before = _shifted(padded, longest + i, t) - frames, frames - _shifted(padded, longest - i, t)
        out[:, 2 * m :] += square[half[1] + i] * (after - before)
    return out


def _shifted(padded: Floats, start: int, frames: int) -> Floats:
    return padded[start : start + frames]


def by_label(
    takes: Sequence[tuple[ArrayLike, Sequence[tuple[int, int, str]]]], half: Half | None = (1, 1)
) -> Mapping[str, list[Floats]]:
    """Cut labelled takes into the intervals of each label.

    Parameters
    ----------
    takes
        Frames (T, M) and intervals (start, end exclusive, label) of each take.
    half
        Half lengths of the windows; deltas are taken of the whole take before it is cut. None: no deltas.

    Returns
    -------
    label → list of (T_k, 3 M)
        Labels in alphabetical order, intervals in the order of the takes. (T_k, M) without deltas.

    Raises
    ------
    InputError
        An interval is empty or lies outside its take.
    """
    cut: dict[str, list[Floats]] = {}
    for number, (x, intervals) in enumerate(takes):
        frames = checked_frames(x, f"take {number}")
        features = frames if half is None else deltas(frames, half)
        for start, end, label in intervals:
            if not 0 <= start < end <= len(features):
                raise InputError(
                    f"take {number}: the interval {label!r} from {start} to {end} "
                    f"lies outside its {len(features)} frames"
                )
            cut.setdefault(label, []).append(features[start:end])
    return dict(sorted(cut.items()))
