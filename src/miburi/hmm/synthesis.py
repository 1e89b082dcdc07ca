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
from miburi.hmm import variance as spread
from miburi.hmm.generation import log_likelihood, mlpg, steps_of
from miburi.hmm.model import Form, Model
from miburi.hmm.search import Staircase, joint_durations
from miburi.hmm.timing import frames_per_state
from miburi.hmm.training import train
from miburi.hmm.windows import Floats
from miburi.kinematics import hand_rotations
from miburi.motion import Motion
from miburi.strings import Word, parse


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
        The labels, separated by blanks, with what was said of their lengths.
    fps
        Frames per second; None: not known.
    rho
        Speed: states last m + ρσ² frames.
    alpha
        Weight of the durations ([H], eq. 18); None: infinite, as in eq. 20.
    lost
        Log-likelihood per frame that the trajectory lost against the likeliest one to have the recordings'
        variance; None: it is the likeliest.
    why_not
        Why the global variance, though wanted, was left out; empty: it was not.
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
    alpha: float | None = None
    lost: float | None = None
    why_not: str = ""

    def __len__(self) -> int:
        return len(self.trajectory)

    @property
    def labels(self) -> tuple[str, ...]:
        """The string's P labels."""
        return tuple(self.label[start] for start in self.boundaries[:-1])

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
            file.attrs["why_not"] = self.why_not
            for name in ("fps", "alpha", "lost"):
                if (value := getattr(self, name)) is not None:
                    file.attrs[name] = value

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
                rho=float(file.attrs["rho"]),
                why_not=str(file.attrs.get("why_not", "")),
                **{n: float(file.attrs[n]) for n in ("fps", "alpha", "lost") if n in file.attrs},
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
    """The labels of a string, each of them known, without what is said of their lengths (`strings.parse`)."""
    return tuple(word.label for word in parse(string, labels))


def synthesize(
    models: Mapping[str, Model],
    string: str | Sequence[str],
    *,
    rho: float = 0.0,
    length: int | None = None,
    alpha: float | None = None,
    global_variance: bool = False,
    seed: int | Sequence[int] = 0,
) -> Synthesis:
    """Generate the motion of a string of labels.

    Parameters
    ----------
    models
        By label.
    string
        Labels separated by blanks, or a sequence of them; `r*2` lasts twice as long as r, `r=1.5s` a second and
        a half.
    rho
        Speed: a state lasts ⌊m + ρσ² + ½⌋ frames, at least one; 0 is [H], eq. 20.
    length
        Frames in all; ρ is found so that the states' durations add up to it. Words with a length of their own in
        seconds keep it.
    alpha
        Weight of the durations against the trajectory ([H], eq. 18); durations of the same sum are then searched
        together with it, from eq. 20 on. None: infinite, which is eq. 20.
    global_variance
        The trajectory is to vary over the string as much as recorded intervals do (Toda and Tokuda); it is less
        likely then, `lost` says how much. Left out, with `why_not`, for strings of one or two labels, labels with
        one interval, and full covariances.
    seed
        Of the draw of recorded intervals whose variance is counted.

    Returns
    -------
    Synthesis

    Raises
    ------
    InputError
        A label is unknown, models do not fit together, the length cannot be had, or α is wanted with full
        covariances.
    """
    words = parse(string, models)
    chain = [models[word.label] for word in words]
    _check_together(chain)
    is_full = any(m.covariance is not None for m in chain)
    half = chain[0].half
    lasting, spreads = _durations(chain, words)
    frames, rho = frames_per_state(lasting, spreads, rho=rho, length=length)
    mean = np.concatenate([m.mean for m in chain])
    variance = np.concatenate([m.variance for m in chain])
    if alpha is not None:
        if is_full:
            raise InputError(f"alpha is {alpha}: durations are searched with diagonal covariances only")
        stairs = Staircase(mean, variance, lasting + rho * spreads, spreads)
        frames = joint_durations(stairs, frames, alpha, half=half)
    ends = np.cumsum(frames)[np.cumsum([m.states for m in chain]) - 1]
    boundaries = np.concatenate([[0], ends]).astype(np.int64)
    gaussians = np.concatenate([_covariances(m) for m in chain]) if is_full else variance
    x = mlpg(mean, gaussians, half=half, frames=frames)
    lost, why_not = None, spread.why_not(chain) if global_variance else ""
    if global_variance and not why_not:
        usual, wanted = x, spread.expected_spread(chain, np.diff(boundaries), seed)
        x = spread.with_spread(mean, variance, steps_of(len(mean), frames), wanted, half)
        gone = [log_likelihood(c, mean, variance, half=half, frames=frames) for c in (usual, x)]
        lost = (gone[0] - gone[1]) / len(x)
    labels = np.array([word.label for word in words], dtype=object)
    return Synthesis(
        trajectory=x,
        state=np.concatenate([np.arange(m.states) for m in chain]).repeat(frames),
        label=tuple(labels.repeat(np.diff(boundaries)).tolist()),
        boundaries=boundaries,
        mean=mean.repeat(frames, axis=0),
        variance=variance.repeat(frames, axis=0),
        string=" ".join(word.text for word in words),
        fps=chain[0].fps,
        rho=rho,
        alpha=alpha,
        lost=lost,
        why_not=why_not,
    )


def _covariances(model: Model) -> Floats:
    if model.covariance is not None:
        return model.covariance
    return np.apply_along_axis(np.diag, 1, model.variance)


def _durations(chain: Sequence[Model], words: Sequence[Word]) -> tuple[Floats, Floats]:
    """Mean and variance of the durations of all states; of a word with a length of its own, scaled to it."""
    means, variances = [], []
    for place, (model, word) in enumerate(zip(chain, words, strict=True), 1):
        mean, variance = model.duration_mean * word.factor, model.duration_variance * word.factor**2
        if word.seconds is not None:
            who = f"string {' '.join(w.text for w in words)!r}, label {place}, {word.text!r}"
            mean, variance = _of_seconds(model, word.seconds, who), np.zeros_like(variance)
        means.append(mean)
        variances.append(variance)
    return np.concatenate(means), np.concatenate(variances)


def _of_seconds(model: Model, seconds: float, who: str) -> Floats:
    """Frames of a model's states that last so long together, in proportion to their mean durations."""
    if model.fps is None:
        raise InputError(f"{who}: the frame rate is not known; train the models with fps")
    wanted = int(np.floor(seconds * model.fps + 0.5))
    if wanted < model.states:
        raise InputError(
            f"{who}: {wanted} frames at {model.fps:g} per second, expected {model.states} or more, one for each state"
        )
    share = model.duration_mean * (wanted / model.duration_mean.sum())
    frames, _ = frames_per_state(share, share, length=wanted)
    return frames.astype(np.float64)


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
    words = parse(string, models)
    frames, _ = frames_per_state(*_durations([models[w.label] for w in words], words), rho=rho)
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
