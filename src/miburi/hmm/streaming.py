"""Trajectories while their Gaussians still come in: each frame a bounded delay after them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.hmm import solver
from miburi.hmm.generation import mlpg
from miburi.hmm.model import Model
from miburi.hmm.timing import frames_per_state
from miburi.hmm.windows import Floats, Half, windows

Step = tuple[Floats, Floats, int]
"""Mean and variance (3 M,) of a state, and how many frames it lasts."""


def stream(steps: Iterable[Step], delay: int, *, half: Half = (1, 1)) -> Iterator[Floats]:
    """Frames of the trajectory of Gaussians that come in one after another.

    Parameters
    ----------
    steps
        States in their order. Each is asked for only when the frames before are given out, up to the delay.
    delay
        Frames that are known ahead of the frame that is given out.
    half
        Half lengths L1, L2 of the delta windows.

    Yields
    ------
    (M,)
        Frame t of `mlpg` of the Gaussians of the frames 0 to t + delay: with a delay as long as the string, `mlpg`
        itself. O((delay + L²) L M) a frame, whatever has gone before.

    Raises
    ------
    InputError
        The delay is below 0, or steps differ in their features.
    """
    if int(delay) != delay or delay < 0:
        raise InputError(f"delay is {delay}, expected a whole number of frames, 0 or more")
    delta, square = windows(half)
    width = 2 * max(half)
    band = right = raw = raw_right = gaussians = np.zeros(0)
    count = 0
    for mean, variance, frames in steps:
        now = np.array([mean, variance], dtype=np.float64)
        if not count:
            if now.shape[1] % 3:
                raise InputError(f"stream: a mean of {now.shape[1]} values, expected 3 M")
            dims, kept = now.shape[1] // 3, delay + 1 + 2 * width
            band, right = np.zeros((kept, width + 1, dims)), np.zeros((kept, dims))
            raw, raw_right = np.zeros((width + 1, width + 1, dims)), np.zeros((width + 1, dims))
            gaussians = np.zeros((width + 1, 2, 3 * dims))
        if now.shape != gaussians.shape[1:]:
            raise InputError(
                f"stream: a mean of {now.shape[1]} values, expected {gaussians.shape[-1]} as before"
            )
        for _ in range(frames):
            gaussians[:-1], gaussians[-1] = gaussians[1:].copy(), now
            _push(gaussians, count, delta, square, raw, raw_right, band, right)
            count += 1
            if count > delay:
                yield _back(band, right, delay)[0]
    if count:
        yield from _back(band, right, min(delay, count) - 1)


@njit
def _copy(band, right, i, to_band, to_right, j):  # type: ignore[no-untyped-def]
    """Row i of one system to row j of another, in loops: numba takes six seconds to compile what assigns arrays."""
    for m in range(right.shape[1]):
        to_right[j, m] = right[i, m]
        for k in range(band.shape[1]):
            to_band[j, k, m] = band[i, k, m]


@njit
def _push(gaussians, count, delta, square, raw, raw_right, band, right):  # type: ignore[no-untyped-def]
    """Take in the last of the Gaussians, which is frame `count`'s.

    raw holds rows of R that may still grow, those of the last frames; band and right the factor as `wide` has it,
    as if the string ended here: its last rows are made anew each time.
    """
    width, dims = raw.shape[1] - 1, raw.shape[2]
    for k in range(width):
        _copy(raw, raw_right, k + 1, raw, raw_right, k)
    raw[width], raw_right[width] = 0.0, 0.0
    for k in range(len(band) - 1):
        _copy(band, right, k + 1, band, right, k)
    precision, weighted = np.empty(dims), np.empty(dims)
    for w in range(3):
        half = 0 if w == 0 else len(delta if w == 1 else square) // 2
        if count < 2 * half:
            continue
        at = width - half
        for m in range(dims):
            precision[m] = 1.0 / gaussians[at, 1, w * dims + m]
            weighted[m] = precision[m] * gaussians[at, 0, w * dims + m]
        if w == 0:
            for m in range(dims):
                raw[width, 0, m] += precision[m]
                raw_right[width, m] += weighted[m]
        else:
            solver.add_row(raw, raw_right, precision, weighted, at, delta if w == 1 else square)
    margin = np.empty(dims)
    for k in range(max(0, width - count), width + 1):
        t = len(band) - 1 - width + k
        _copy(raw, raw_right, k, band, right, t)
        solver.factor_row(band, right, t, width, margin)


@njit
def _back(band, right, delay):  # type: ignore[no-untyped-def]
    """The last delay + 1 frames of the trajectory, if the string ended here."""
    width, last = band.shape[1] - 1, len(band) - 1
    x = np.empty((delay + 1, right.shape[1]))
    for n in range(delay, -1, -1):
        t = last - delay + n
        for m in range(x.shape[1]):
            x[n, m] = right[t, m] * band[t, 0, m]
            for k in range(1, min(width, delay - n) + 1):
                x[n, m] -= band[t + k, k, m] * x[n + k, m]
    return x


def stream_labels(
    models: Mapping[str, Model], labels: Iterable[str], delay: int, *, rho: float = 0.0
) -> Iterator[Floats]:
    """Frames (M,) of labels that come in one after another, as `stream`; durations as in `synthesize`."""
    first: list[Model] = []

    def steps() -> Iterator[Step]:
        for place, label in enumerate(labels, 1):
            if label not in models:
                raise InputError(f"label {place} is {label!r}, known are {', '.join(sorted(models))}")
            model = models[label]
            first.append(model)
            if model.half != first[0].half:
                raise InputError(
                    f"models {first[0].label!r} and {label!r} differ in half lengths of delta windows"
                )
            frames, _ = frames_per_state(model.duration_mean, model.duration_variance, rho=rho)
            yield from zip(model.mean, model.variance, frames.tolist(), strict=True)

    ahead = steps()
    opening = list(islice(ahead, 1))  # the first model says how long the windows are

    def all_steps() -> Iterator[Step]:
        yield from opening
        yield from ahead

    if opening:
        yield from stream(all_steps(), delay, half=first[0].half)


class DelayError(NamedTuple):
    """How far a stream is from `mlpg`: largest and root mean square difference, in the trajectory's unit."""

    delay: int
    largest: float
    rms: float


def delay_errors(
    mean: ArrayLike, variance: ArrayLike, delays: Sequence[int], *, half: Half = (1, 1)
) -> list[DelayError]:
    """Differences between the stream and the batch answer of the same Gaussians (T, 3 M), for each delay."""
    mu, v = np.asarray(mean, dtype=np.float64), np.asarray(variance, dtype=np.float64)
    batch = mlpg(mu, v, half=half)
    found = []
    for delay in delays:
        x = np.array(list(stream(zip(mu, v, [1] * len(mu), strict=True), delay, half=half)))
        found.append(
            DelayError(delay, float(np.abs(x - batch).max()), float(np.sqrt(np.square(x - batch).mean())))
        )
    return found
