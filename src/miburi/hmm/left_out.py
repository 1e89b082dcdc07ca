"""How well models say of intervals that they were not trained on: which number of states, which covariance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from miburi.hmm import kernels
from miburi.hmm.densities import log_densities
from miburi.hmm.model import Covariance, Model
from miburi.hmm.sequences import joined
from miburi.hmm.training import train
from miburi.hmm.windows import Floats


class LeftOut(NamedTuple):
    """Log-likelihood of intervals that were left out in turn, and how many of them and of their frames counted."""

    label: str
    covariance: str
    states: int
    intervals: int
    frames: int
    log_likelihood: float


def log_likelihood_of(model: Model, sequences: Sequence[ArrayLike]) -> float:
    """Log-likelihood of intervals (T_k, D), all together; those too short to pass through all states do not count."""
    exits = model.exit > 0
    data = joined(sequences, model.states, exits, f"model {model.label!r}")
    variance = model.variance if model.covariance is None else model.covariance
    density = log_densities(data.x, model.mean, variance)
    return float(kernels.expectation(density, data.offsets, *model.logs, exits)[3])


def leave_one_out(
    intervals: Mapping[str, Sequence[Floats]],
    reference: ArrayLike,
    *,
    states: Sequence[int] = range(1, 9),
    covariances: Sequence[Covariance] = ("diagonal", "full"),
    **settings: Any,
) -> list[LeftOut]:
    """Train each label without one of its intervals, and see how likely that one is; with each interval in turn.

    Parameters
    ----------
    intervals
        Observations (T_k, D) of each label.
    reference : (D,)
        Reference variance for the floor. Constant features are left out: their density says nothing.
    states, covariances
        What is compared.
    **settings
        Of `train`, except states and covariance.

    Returns
    -------
    list of LeftOut
        For each label, covariance and number of states. Intervals shorter than the largest number of states count
        for none, so that all numbers are of the same frames; labels with fewer than two long enough ones are absent.

    Notes
    -----
    Densities of degrees and degrees per frame: only differences mean something.
    """
    alive = np.asarray(reference, dtype=np.float64) > 0.0
    floor = np.asarray(reference, dtype=np.float64)[alive]
    found = []
    for label, sequences in intervals.items():
        x = [np.ascontiguousarray(s[:, alive]) for s in sequences]
        scored = [k for k, s in enumerate(x) if len(s) >= max(states)]
        if len(scored) < 2:
            continue
        frames = sum(len(x[k]) for k in scored)
        for covariance in covariances:
            for n in states:
                total = 0.0
                for k in scored:
                    rest = x[:k] + x[k + 1 :]
                    model = train(
                        rest, states=n, covariance=covariance, reference=floor, label=label, **settings
                    )
                    total += log_likelihood_of(model, [x[k]])
                found.append(LeftOut(label, covariance, n, len(scored), frames, total))
    return found
