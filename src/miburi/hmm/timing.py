"""How long a state lasts: statistics of durations, and the frames that each state gets."""

from __future__ import annotations

from collections.abc import Sequence
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError
from miburi.hmm import kernels
from miburi.hmm.densities import log_densities
from miburi.hmm.model import Form, Model
from miburi.hmm.sequences import Joined, joined
from miburi.hmm.windows import Floats

LONGEST = 1_000_000
"""Frames of a string at most: nine hours at 30 frames/s."""


def durations(model: Model, sequences: Sequence[ArrayLike], *, form: Form = "exact") -> tuple[Floats, Floats]:
    """Mean and variance of the time spent in each state.

    Parameters
    ----------
    model
        Of the label.
    sequences : list of (T_k, D)
        Its intervals.
    form
        "exact": χ, the probability of being in a state from exactly t0 to t1, from transitions and
        densities. With an exit, the means add up to the mean length of the intervals.
        "product": χ as the product of state probabilities ([H], eq. 9, its upper bound t1).

    Returns
    -------
    mean, variance : (N,)
        Frames, frames² ([H], eqs. 10 and 11). 0 for a state that no interval reaches, which only a model
        without an exit can have.

    Raises
    ------
    InputError
        The sequences do not fit the model.
    """
    who = f"durations of {model.label!r}"
    exits = model.exit > 0
    data = joined(sequences, model.states, exits, who)
    if data.x.shape[1] != model.mean.shape[1]:
        raise InputError(f"{who}: found {data.x.shape[1]} features, the model has {model.mean.shape[1]}")
    variance = model.variance if model.covariance is None else model.covariance
    return duration_moments(data, log_densities(data.x, model.mean, variance), *model.logs, exits, form, who)


def duration_moments(
    data: Joined, density: Floats, stay: Floats, leave: Floats, exits: bool, form: Form, who: str
) -> tuple[Floats, Floats]:
    """As `durations`, from log densities (T, N) and the logarithms of transitions (N,)."""
    check_form(form, who)
    kernel = kernels.exact_durations if form == "exact" else kernels.product_durations
    count, total, squares = kernel(density, data.offsets, stay, leave, exits)
    if not np.isfinite(total).all():
        raise InputError(
            f"{who}: an interval cannot come from the model, whose transitions do not allow its length"
        )
    reached = count > 0.0
    count = np.where(reached, count, 1.0)
    mean = np.where(reached, total / count, 0.0)
    return mean, np.where(reached, np.maximum(squares / count - mean**2, 0.0), 0.0)


def check_form(form: str, who: str) -> None:
    """InputError if there is no such form of durations."""
    if form not in get_args(Form):
        raise InputError(f"{who}: durations are {form!r}, expected {' or '.join(get_args(Form))}")


def frames_per_state(
    mean: Floats, variance: Floats, *, rho: float = 0.0, length: int | None = None
) -> tuple[NDArray[np.int64], float]:
    """Frames that each state of a string gets.

    Parameters
    ----------
    mean, variance : (S,)
        Of the durations of all states of the string.
    rho
        Speed: a state lasts m + ρσ² frames; above 0 slower, below 0 faster.
    length
        Frames in all, instead of ρ.

    Returns
    -------
    frames : (S,)
        ⌊m + ρσ² + ½⌋, at least 1 ([H], eq. 20 is ρ = 0).
    rho
        As given, or as found for the length.

    Raises
    ------
    InputError
        The length cannot be had, or is beyond a million frames.
    """
    if length is None:
        if not np.isfinite(rho):
            raise InputError(f"rho is {rho}, expected a finite number")
        wanted = np.maximum(1.0, np.floor(mean + rho * variance + 0.5))
        _check_length(wanted.sum())
        return wanted.astype(np.int64), float(rho)
    if rho != 0.0:
        raise InputError(f"rho is {rho} and length {length}: expected one of the two")
    if length != int(length):
        raise InputError(f"length is {length}, expected a whole number of frames")
    _check_length(length)
    natural, _ = frames_per_state(mean, variance)
    if natural.sum() == length:
        return natural, 0.0
    exact, rho = _to_length(mean, variance, length)
    whole = np.maximum(1, np.floor(exact).astype(np.int64))
    # largest remainders, the first of equal ones; sorting is stable
    missing = length - int(whole.sum())
    whole[np.argsort(-(exact - whole), kind="stable")[:missing]] += 1
    return whole, rho


def _check_length(total: float) -> None:
    if total > LONGEST:
        raise InputError(f"the string would last {total:.6g} frames, expected {LONGEST} at most")


def _to_length(mean: Floats, variance: Floats, length: int) -> tuple[Floats, float]:
    """Durations max(1, m + ρσ²) that add up to the length, and ρ."""
    if length < len(mean):
        raise InputError(
            f"length is {length}, expected {len(mean)} or more: a frame for each state of the string"
        )
    moves = variance > 0.0  # states that are neither fixed nor as short as can be
    exact = np.maximum(1.0, mean)
    rho = 0.0
    while exact.sum() != length:
        if not moves.any():
            raise InputError(
                f"length is {length}, expected {exact.sum():.6g}: no other duration varies in the recordings"
            )
        rest = length - exact[~moves].sum()
        rho = (rest - mean[moves].sum()) / variance[moves].sum()
        exact = np.where(moves, mean + rho * variance, exact)
        short = moves & (exact < 1.0)
        if not short.any():
            break
        exact[short] = 1.0  # the others get shorter still, so these stay short
        moves &= ~short
    return exact, float(rho)
