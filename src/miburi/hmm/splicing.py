"""Recorded intervals put end to end ([H], fig. 5), and the steps that this leaves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError
from miburi.hmm.synthesis import check_string
from miburi.hmm.windows import Floats, checked_frames


class Spliced(NamedTuple):
    """Frames (T, M) of recorded intervals end to end, and the first frame of each label and T, (P + 1,)."""

    trajectory: Floats
    boundaries: NDArray[np.int64]
    labels: tuple[str, ...]


def splice(intervals: Mapping[str, Sequence[ArrayLike]], string: str | Sequence[str]) -> Spliced:
    """Cut a string's labels from the recordings and put them end to end.

    Parameters
    ----------
    intervals
        Frames (T_k, M) of each label (`by_label` without deltas).
    string
        Labels separated by blanks, or a sequence of them.

    Returns
    -------
    Spliced
        Of each label its interval of median length (the lower median, the first of equal ones), every time
        that the label appears.

    Raises
    ------
    InputError
        A label is unknown or has no interval, or intervals differ in their number of features.
    """
    labels = check_string(string, intervals)
    pieces = {
        label: checked_frames(_middle(intervals[label], label), f"label {label!r}") for label in set(labels)
    }
    chosen = [pieces[label] for label in labels]
    if len({p.shape[1] for p in chosen}) > 1:
        raise InputError(
            f"string {' '.join(labels)!r}: the labels' intervals differ in their number of features"
        )
    boundaries = np.concatenate([[0], np.cumsum([len(p) for p in chosen])]).astype(np.int64)
    return Spliced(np.concatenate(chosen), boundaries, labels)


def _middle(intervals: Sequence[ArrayLike], label: str) -> ArrayLike:
    if not len(intervals):
        raise InputError(f"label {label!r}: there are no intervals")
    sizes = np.array([len(np.asarray(x)) for x in intervals])
    return intervals[int(np.argmax(sizes == np.sort(sizes)[(len(sizes) - 1) // 2]))]


def steps(trajectory: ArrayLike) -> Floats:
    """How far each frame jumps from where the motion on both sides leads, largest over the features.

    Parameters
    ----------
    trajectory : (T, M)

    Returns
    -------
    (T − 1,)
        Of the change v_t from frame t to t + 1: |v_t − (v_{t−1} + v_{t+1}) / 2|, at the ends with the one
        neighbour that there is; in the trajectory's unit. A fast but smooth motion has small steps, a jump
        of h between two pieces that stand still has a step of h.
    """
    x = checked_frames(trajectory, "steps")
    v = np.diff(x, axis=0)
    if len(v) < 2:
        return np.zeros(len(v))
    around = np.concatenate([v[1:2], v, v[-2:-1]])
    jump: Floats = np.abs(v - 0.5 * (around[:-2] + around[2:])).max(axis=1)
    return jump


def largest_step(trajectory: ArrayLike, boundaries: ArrayLike | None = None) -> float:
    """The largest of `steps`, of all frames or at the joins only.

    Parameters
    ----------
    trajectory : (T, M)
    boundaries : (P + 1,), optional
        First frame of each label, and T: only the changes into the first frame of labels 2 … P count.

    Returns
    -------
    float
        In the trajectory's unit; 0 where nothing can step.
    """
    jump = steps(trajectory)
    if boundaries is not None:
        jump = jump[np.asarray(boundaries, dtype=np.int64)[1:-1] - 1]
    return float(jump.max(initial=0.0))
