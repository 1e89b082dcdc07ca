"""Motion from a string of labels ([H], section on generation), and its artefact."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi import store
from miburi.errors import InputError
from miburi.figures import HAND
from miburi.hmm.generation import mlpg
from miburi.hmm.model import Form, Model
from miburi.hmm.timing import frames_per_state
from miburi.hmm.training import train
from miburi.hmm.windows import Floats
from miburi.kinematics import hand_rotations
from miburi.motion import Motion


@dataclass(frozen=True, eq=False)
class Synthesis:
    """A generated trajectory and the Gaussians that it was generated from.

    Parameters
    ----------
    trajectory : (T, M)
        Of a hand: `angles`, M = 48, degrees, joint-major, Z X Y.
    state : (T,) int64
        State of each frame, from 0 in each label.
    label : (T,)
        Label of each frame.
    boundaries : (P + 1,) int64
        First frame of each of the string's P labels, and T.
    mean, variance : (T, 3 M)
        Gaussians of each frame's state (the staircase).
    string
        The labels, separated by blanks.
    fps
        Frames per second; None: not known.
    rho
        Speed: states last m + ρσ² frames.
    """

    trajectory: Floats
    state: NDArray[np.int64]
    label: tuple[str, ...]
    boundaries: NDArray[np.int64]
    mean: Floats
    variance: Floats
    string: str
    fps: float | None = None
    rho: float = 0.0

    def __len__(self) -> int:
        return len(self.trajectory)

    @property
    def labels(self) -> tuple[str, ...]:
        """The string's P labels."""
        return tuple(self.string.split())

    def motion(self, name: str = "") -> Motion:
        """The hand that the trajectory moves, on `figures.HAND`.

        Raises
        ------
        InputError
            The trajectory is not a hand's, or its frame rate is not known.
        """
        return hand_motion(self.trajectory, self.fps, name)

    def save(self, path: str | os.PathLike[str], sources: Mapping[str, str] | None = None) -> None:
        """Write the artefact "miburi/synthesis"."""
        with store.create(path, "synthesis", sources) as file:
            store.put(file, "angles", self.trajectory)
            for name in ("state", "boundaries", "mean", "variance"):
                store.put(file, name, getattr(self, name))
            store.put(file, "label", list(self.label))
            file.attrs["string"] = self.string
            file.attrs["rho"] = self.rho
            if self.fps is not None:
                file.attrs["fps"] = self.fps

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Synthesis:
        """Read the artefact "miburi/synthesis".

        Raises
        ------
        InputError
            The file is missing or damaged, or is another artefact.
        """
        with store.open_checked(path, "synthesis") as file:
            x = store.get(file, "angles", (None, None))
            t, m = x.shape
            if absent := [a for a in ("string", "rho") if a not in file.attrs]:
                raise InputError(f"{path}: the attribute {absent[0]!r} is missing")
            string = str(file.attrs["string"])
            label = store.get_strings(file, "label")
            if len(label) != t:
                raise InputError(f"{path}: /label has {len(label)} entries, expected {t}")
            return cls(
                trajectory=x,
                state=store.get(file, "state", (t,)),
                label=tuple(label),
                boundaries=store.get(file, "boundaries", (len(string.split()) + 1,)),
                mean=store.get(file, "mean", (t, 3 * m)),
                variance=store.get(file, "variance", (t, 3 * m)),
                string=string,
                fps=float(file.attrs["fps"]) if "fps" in file.attrs else None,
                rho=float(file.attrs["rho"]),
            )


def hand_motion(angles: ArrayLike, fps: float | None, name: str = "") -> Motion:
    """The hand that angles (T, 48) describe: degrees, joint-major, Z X Y; at the origin.

    Raises
    ------
    InputError
        The angles are not 48, or the frame rate is not known.
    """
    x = np.asarray(angles, dtype=np.float64)
    if x.ndim != 2 or x.shape[1] != 3 * len(HAND):
        raise InputError(f"a trajectory of shape {x.shape} moves no hand, expected (T, {3 * len(HAND)})")
    if fps is None:
        raise InputError("the frame rate of a trajectory is not known; train the models with fps")
    return Motion(HAND, fps, np.zeros((len(x), 3)), hand_rotations(x), angles=x, name=name)


def check_string(
    string: str | Sequence[str], labels: Sequence[str] | Mapping[str, object]
) -> tuple[str, ...]:
    """The labels of a string, each of them known.

    Parameters
    ----------
    string
        Labels separated by blanks, or a sequence of them.
    labels
        Those that are known.

    Raises
    ------
    InputError
        The string is empty, or a label is unknown; the sentence names it, its place and those that are known.
    """
    found = tuple(string.split()) if isinstance(string, str) else tuple(str(s) for s in string)
    if not found:
        raise InputError("the string of labels is empty")
    for place, label in enumerate(found, 1):
        if label not in labels:
            raise InputError(
                f"string {' '.join(found)!r}: label {place} is {label!r}, "
                f"known are {', '.join(sorted(labels))}"
            )
        if label.split() != [label]:
            raise InputError(f"label {label!r} has a blank in it, which separates the labels of a string")
    return found


def synthesize(
    models: Mapping[str, Model], string: str | Sequence[str], *, rho: float = 0.0, length: int | None = None
) -> Synthesis:
    """Generate the motion of a string of labels.

    Parameters
    ----------
    models
        By label.
    string
        Labels separated by blanks, or a sequence of them.
    rho
        Speed: a state lasts ⌊m + ρσ² + ½⌋ frames, at least one; 0 is [H], eq. 20.
    length
        Frames in all; ρ is found so that the states' durations add up to it.

    Returns
    -------
    Synthesis

    Raises
    ------
    InputError
        A label is unknown, models do not fit together, or the length cannot be had.

    Notes
    -----
    Of a full covariance, generation uses the variances alone.
    """
    labels = check_string(string, models)
    chain = [models[label] for label in labels]
    _check_together(chain)
    frames, rho = frames_per_state(*_durations(chain), rho=rho, length=length)
    states = np.concatenate([np.arange(m.states) for m in chain])
    ends = np.cumsum(frames)[np.cumsum([m.states for m in chain]) - 1]
    boundaries = np.concatenate([[0], ends]).astype(np.int64)
    mean = np.concatenate([m.mean for m in chain]).repeat(frames, axis=0)
    variance = np.concatenate([m.variance for m in chain]).repeat(frames, axis=0)
    return Synthesis(
        trajectory=mlpg(mean, variance, half=chain[0].half),
        state=states.repeat(frames),
        label=tuple(np.array(labels, dtype=object).repeat(np.diff(boundaries)).tolist()),
        boundaries=boundaries,
        mean=mean,
        variance=variance,
        string=" ".join(labels),
        fps=chain[0].fps,
        rho=rho,
    )


def _durations(chain: Sequence[Model]) -> tuple[Floats, Floats]:
    return np.concatenate([m.duration_mean for m in chain]), np.concatenate(
        [m.duration_variance for m in chain]
    )


def _check_together(chain: Sequence[Model]) -> None:
    one = chain[0]
    if one.mean.shape[1] % 3:
        raise InputError(
            f"model {one.label!r} has {one.mean.shape[1]} features, expected static, Δ and Δ² of each"
        )
    for other in chain[1:]:
        for what, a, b in (
            ("features", one.mean.shape[1], other.mean.shape[1]),
            ("half lengths of delta windows", one.half, other.half),
            ("frames per second", one.fps, other.fps),
        ):
            if a != b:
                raise InputError(f"models {one.label!r} and {other.label!r} differ in {what}: {a} and {b}")


def total_length(models: Mapping[str, Model], string: str | Sequence[str], *, rho: float = 0.0) -> int:
    """Frames that a string lasts: the sum of its states' rounded mean durations ([H], eqs. 20 and 21)."""
    frames, _ = frames_per_state(*_durations([models[s] for s in check_string(string, models)]), rho=rho)
    return int(frames.sum())


def lengths(
    intervals: Mapping[str, Sequence[ArrayLike]], string: str | Sequence[str], **settings: object
) -> list[tuple[bool, Form, int]]:
    """How long a string lasts with and without an exit, by exact durations and by products.

    Parameters
    ----------
    intervals
        Observations (T_k, D) of each label.
    string
        Labels separated by blanks, or a sequence of them.
    **settings
        Of `train`, except exit and durations.

    Returns
    -------
    list of (exit, form, frames)
        The four combinations.
    """
    labels = sorted(set(check_string(string, intervals)))
    found: list[tuple[bool, Form, int]] = []
    for exits in (True, False):
        for form in get_args(Form):
            options: dict[str, Any] = {**settings, "exit": exits, "durations": form}
            models = {label: train(intervals[label], label=label, **options) for label in labels}
            found.append((exits, form, total_length(models, string)))
    return found
