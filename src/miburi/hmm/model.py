"""A label's HMM and its artefact."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.errors import InputError
from miburi.hmm.windows import Half, checked_half

Floats = NDArray[np.float64]
Covariance = Literal["diagonal", "full"]
Form = Literal["exact", "product"]


@dataclass(frozen=True, eq=False)
class Model:
    """A left-to-right HMM without skips, one Gaussian per state ([H], section on the model).

    Parameters
    ----------
    label
        What it shows.
    mean : (N, D)
        Of each state.
    variance : (N, D)
        Of each state; of a full covariance, its diagonal.
    transitions : (N, N)
        Probabilities of staying (diagonal) and of going on (beside it).
    exit
        Probability of leaving the last state; 0: the model has no exit and an interval may end in any state.
    duration_mean, duration_variance : (N,)
        Of the time spent in each state, frames and frames².
    log_likelihood : (iterations + 1,)
        Of all intervals: of the start, then after each iteration.
    intervals, frames
        What it was trained on.
    half
        Half lengths L1, L2 of the delta windows.
    form
        How the durations were found.
    covariance : (N, D, D), optional
        Where it is full.
    fps
        Frames per second of the recordings; None: not known.
    converged
        The last iteration gained less than the tolerance.
    left_out
        Intervals that were too short to pass through all states.
    constant
        Number of features that do not vary (a dead sensor).
    interval_mean, interval_square : (K, M), optional
        Mean of each static feature, and of its square, in each interval; of features with deltas.
    """

    label: str
    mean: Floats
    variance: Floats
    transitions: Floats
    exit: float
    duration_mean: Floats
    duration_variance: Floats
    log_likelihood: Floats
    intervals: int
    frames: int
    half: Half = (1, 1)
    form: Form = "exact"
    covariance: Floats | None = None
    fps: float | None = None
    converged: bool = False
    left_out: int = 0
    constant: int = 0
    interval_mean: Floats | None = None
    interval_square: Floats | None = None

    @property
    def states(self) -> int:
        """N."""
        return len(self.mean)

    @property
    def logs(self) -> tuple[Floats, Floats]:
        """Logarithms of the probabilities of staying in each state and of leaving it, (N,) each."""
        leaving = np.append(np.diagonal(self.transitions, 1), self.exit)
        with np.errstate(divide="ignore"):
            return np.log(np.diagonal(self.transitions)), np.log(leaving)

    def save(self, path: str | os.PathLike[str], sources: Mapping[str, str] | None = None) -> None:
        """Write the artefact "miburi/models"."""
        with store.create(path, "models", sources) as file:
            store.put(file, "mean", self.mean)
            if self.covariance is None:
                store.put(file, "variance", self.variance)
            else:
                store.put(file, "covariance", self.covariance)
            for name in ("transitions", "duration_mean", "duration_variance", "log_likelihood"):
                store.put(file, name, getattr(self, name))
            store.put(file, "exit", np.float64(self.exit))
            if self.interval_mean is not None and self.interval_square is not None:
                store.put(file, "interval_mean", self.interval_mean)
                store.put(file, "interval_square", self.interval_square)
            for name in ("label", "states", "intervals", "frames", "form", "left_out", "constant"):
                file.attrs[name] = getattr(self, name)
            file.attrs["converged"] = np.bool_(self.converged)
            file.attrs["windows"] = np.array(self.half, dtype=np.int64)
            if self.fps is not None:
                file.attrs["fps"] = self.fps

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Model:
        """Read the artefact "miburi/models".

        Raises
        ------
        InputError
            The file is missing or damaged, or is another artefact.
        """
        with store.open_checked(path, "models") as file:
            mean = store.get(file, "mean", (None, None))
            n, d = mean.shape
            full = store.get(file, "covariance", (n, d, d)) if "covariance" in file else None
            wanted = ("label", "form", "intervals", "frames", "windows", "left_out", "constant", "converged")
            absent = [a for a in wanted if a not in file.attrs]
            if absent:
                raise InputError(f"{path}: the attribute {absent[0]!r} is missing")
            attrs = file.attrs
            known = "interval_mean" in file
            moments = int(attrs["intervals"]), d // 3
            form = str(attrs["form"])
            if form not in get_args(Form):
                raise InputError(
                    f"{path}: the attribute 'form' is {form!r}, expected {' or '.join(get_args(Form))}"
                )
            return cls(
                label=str(attrs["label"]),
                mean=mean,
                variance=store.get(file, "variance", (n, d))
                if full is None
                else np.einsum("idd->id", full).copy(),
                transitions=store.get(file, "transitions", (n, n)),
                exit=float(store.get(file, "exit", ())),
                duration_mean=store.get(file, "duration_mean", (n,)),
                duration_variance=store.get(file, "duration_variance", (n,)),
                log_likelihood=store.get(file, "log_likelihood", (None,)),
                intervals=int(attrs["intervals"]),
                frames=int(attrs["frames"]),
                half=checked_half(attrs["windows"]),
                form="product" if form == "product" else "exact",
                covariance=full,
                fps=float(attrs["fps"]) if "fps" in attrs else None,
                converged=bool(attrs["converged"]),
                left_out=int(attrs["left_out"]),
                constant=int(attrs["constant"]),
                interval_mean=store.get(file, "interval_mean", moments) if known else None,
                interval_square=store.get(file, "interval_square", moments) if known else None,
            )
