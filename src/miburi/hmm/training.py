"""EM for left-to-right HMMs ([H], eqs. 5 to 8)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple, get_args

import numpy as np
from numpy.typing import ArrayLike

from miburi.errors import InputError
from miburi.hmm import kernels
from miburi.hmm.densities import log_densities, reestimate
from miburi.hmm.model import Covariance, Form, Model
from miburi.hmm.sequences import Joined, global_variance, joined, spread
from miburi.hmm.timing import check_form, duration_moments
from miburi.hmm.windows import Floats, Half, by_label, checked_half

SMALLEST = 1e-12
"""No variance is below this, and a feature whose variance is, counts as constant (a dead sensor)."""
_ROUNDING = 1e-10  # share of a log-likelihood that is rounding


class _Parameters(NamedTuple):
    mean: Floats
    variance: Floats  # (N, D), or (N, D, D) where the covariance is full
    stay: Floats
    leave: Floats


def train(
    sequences: Sequence[ArrayLike],
    *,
    states: int = 3,
    covariance: Covariance = "diagonal",
    exit: bool = True,
    iterations: int = 20,
    tolerance: float = 1e-4,
    floor: float = 0.01,
    reference: ArrayLike | None = None,
    durations: Form = "exact",
    least_intervals: int = 1,
    half: Half = (1, 1),
    label: str = "",
    fps: float | None = None,
) -> Model:
    """Train a label's HMM on all of its intervals.

    Parameters
    ----------
    sequences : list of (T_k, D)
        Observations of each interval.
    states
        N; left to right, no skips, one Gaussian each.
    covariance
        "diagonal" or "full".
    exit
        The last state has an exit, so that every interval passes through all states (as in HTK). False: an
        interval may end in any state (as printed).
    iterations
        Of EM, at most.
    tolerance
        EM has converged when the log-likelihood per frame gains less. Below 0: all iterations are run.
    floor
        No variance falls below this share of the reference variance. Of a full covariance, none does in any
        direction.
    reference : (D,), optional
        Reference variance of each feature (`global_variance` of the recordings); absent: that of the
        sequences.
    durations
        Form of the state durations: "exact" or "product" (`durations`).
    least_intervals
        A label with fewer intervals that are long enough is refused.
    half
        Half lengths of the delta windows that the observations were made with; kept for generation.
    label, fps
        Kept in the model; the label also begins messages.

    Returns
    -------
    Model
        Intervals shorter than N are left out (with an exit), `left_out` counts them.

    Raises
    ------
    InputError
        No interval is long enough, a number is not finite, or a setting is out of its range.

    Notes
    -----
    The start is a uniform segmentation: each interval is cut into N pieces of equal length. A floored
    variance is the likeliest one above the floor, so the likelihood never falls.
    """
    who = f"label {label!r}" if label else "train"
    _check(who, states, covariance, iterations, tolerance, floor, durations)
    half = checked_half(half)
    data = joined(sequences, states, exit, who, least_intervals)
    varies = _reference(reference, data.x, who)
    floors = np.maximum(floor * varies, SMALLEST)
    start = _start(data, states, covariance, exit, floors)
    found, trace, converged = _em(data, start, floors, exit, iterations, tolerance)
    mean, variance, stay, leave = found
    density = log_densities(data.x, mean, variance)
    lasting, spreads = duration_moments(data, density, *_logs(found), exit, durations, who)
    is_full = variance.ndim == 3
    return Model(
        label=label,
        mean=mean,
        variance=np.einsum("idd->id", variance).copy() if is_full else variance,
        transitions=np.diag(stay) + np.diag(leave[:-1], 1),
        exit=float(leave[-1]),
        duration_mean=lasting,
        duration_variance=spreads,
        log_likelihood=np.array(trace),
        intervals=len(data.offsets) - 1,
        frames=len(data.x),
        half=half,
        form=durations,
        covariance=variance if is_full else None,
        fps=fps,
        converged=converged,
        left_out=data.left_out,
        constant=int((varies <= SMALLEST).sum()),
        **_interval_moments(data),
    )


def train_labels(
    takes: Sequence[tuple[ArrayLike, Sequence[tuple[int, int, str]]]],
    labels: Iterable[str],
    *,
    half: Half = (1, 1),
    fps: float | None = None,
    **settings: Any,
) -> dict[str, Model]:
    """The model of each label, trained on all of its intervals in a corpus.

    Parameters
    ----------
    takes
        Frames (T, M) and intervals (start, end exclusive, label) of each take.
    labels
        Of which models are wanted; one that comes again is trained once.
    half, fps
        As for `train`.
    **settings
        Further settings of `train`.

    Returns
    -------
    label → model
        The reference variance is that of all frames of all takes.

    Raises
    ------
    InputError
        No interval has such a label, or what `train` refuses.
    """
    half = checked_half(half)
    intervals = by_label(takes, half)
    reference = global_variance([x for x, _ in takes], half)
    models: dict[str, Model] = {}
    for label in dict.fromkeys(labels):
        if label not in intervals:
            raise InputError(f"no interval has the label {label!r}; there are {', '.join(intervals)}")
        found = intervals[label]
        models[label] = train(found, label=label, half=half, fps=fps, reference=reference, **settings)
    return models


def _interval_moments(data: Joined) -> dict[str, Floats]:
    """Means of the static features and of their squares in each interval, where features have deltas."""
    if data.x.shape[1] % 3:
        return {}
    static, count = data.x[:, : data.x.shape[1] // 3], np.diff(data.offsets)[:, None]
    starts = data.offsets[:-1]
    return {
        "interval_mean": np.add.reduceat(static, starts) / count,
        "interval_square": np.add.reduceat(static**2, starts) / count,
    }


def _check(
    who: str, states: int, covariance: str, iterations: int, tolerance: float, floor: float, form: str
) -> None:
    for name, value, least in (("states", states, 1), ("iterations", iterations, 0)):
        if int(value) != value or value < least:
            raise InputError(f"{who}: {name} is {value}, expected a whole number, {least} or more")
    if covariance not in get_args(Covariance):
        raise InputError(f"{who}: covariance is {covariance!r}, expected {' or '.join(get_args(Covariance))}")
    if np.isnan(tolerance):
        raise InputError(f"{who}: tolerance is {tolerance}, expected a number")
    if not (np.isfinite(floor) and floor >= 0):
        raise InputError(f"{who}: floor is {floor}, expected a number, 0 or more")
    check_form(form, who)


def _reference(reference: ArrayLike | None, x: Floats, who: str) -> Floats:
    if reference is None:
        return spread(x)
    varies = np.asarray(reference, dtype=np.float64)
    if varies.shape != x.shape[1:] or not (np.isfinite(varies) & (varies >= 0)).all():
        raise InputError(
            f"{who}: reference variances of shape {varies.shape}, expected {x.shape[1]} numbers, 0 or more"
        )
    return varies


def _em(
    data: Joined, start: _Parameters, floors: Floats, exits: bool, iterations: int, tolerance: float
) -> tuple[_Parameters, list[float], bool]:
    """Parameters, log-likelihood of the start and after each iteration, and whether EM converged."""
    now = start
    trace: list[float] = []
    while True:
        gamma, stays, departures, likelihood = kernels.expectation(
            log_densities(data.x, now.mean, now.variance), data.offsets, *_logs(now), exits
        )
        trace.append(float(likelihood))
        if len(trace) > 1:
            gain = trace[-1] - trace[-2]
            if -_ROUNDING * abs(trace[-1]) <= gain < tolerance * len(data.x):
                return now, trace, True
        if len(trace) > iterations:
            return now, trace, False
        mean, variance = reestimate(data.x, gamma, now.mean, now.variance, floors)
        now = _Parameters(mean, variance, *_transitions(stays, departures, now))


def _logs(parameters: _Parameters) -> tuple[Floats, Floats]:
    with np.errstate(divide="ignore"):
        return np.log(parameters.stay), np.log(parameters.leave)


def _transitions(stays: Floats, departures: Floats, old: _Parameters) -> tuple[Floats, Floats]:
    """[H], eq. 5; a state that is never followed by anything keeps its transitions."""
    total = stays + departures
    known = total > 0.0
    total = np.where(known, total, 1.0)
    return np.where(known, stays / total, old.stay), np.where(known, departures / total, old.leave)


def _start(data: Joined, states: int, covariance: Covariance, exits: bool, floors: Floats) -> _Parameters:
    """Gaussians and transitions of a uniform segmentation."""
    lengths = np.diff(data.offsets)
    t = np.arange(len(data.x)) - np.repeat(data.offsets[:-1], lengths)
    length = np.repeat(lengths, lengths)
    # an interval shorter than N (which only a model without an exit takes) goes through its first states
    state = np.where(length >= states, t * states // length, t)
    gamma = np.zeros((len(data.x), states))
    gamma[np.arange(len(data.x)), state] = 1.0
    left = np.ones(len(data.x), dtype=np.bool_)  # frames at which a state is left
    left[:-1] = state[1:] != state[:-1]
    left[data.offsets[1:] - 1] = exits
    over = np.zeros(len(data.x), dtype=np.bool_)  # frames that nothing follows
    over[data.offsets[1:] - 1] = not exits
    departures = gamma[left].sum(axis=0)
    stays = gamma[~left & ~over].sum(axis=0)
    dims = data.x.shape[1]
    centre = np.tile(data.x.mean(axis=0), (states, 1))
    shape = (states, dims, dims) if covariance == "full" else (states, dims)
    mean, variance = reestimate(data.x, gamma, centre, np.zeros(shape), floors)
    never = _Parameters(mean, variance, np.ones(states), np.zeros(states))
    return _Parameters(mean, variance, *_transitions(stays, departures, never))
