"""Intervals of one label, end to end, and what a model needs to know of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError
from miburi.hmm.windows import Floats, Half, checked_frames, deltas
from miburi.strings import untrainable


class Joined(NamedTuple):
    """Sequences end to end: frames x (T, D); sequence k is x[offsets[k] : offsets[k + 1]]."""

    x: Floats
    offsets: NDArray[np.int64]
    left_out: int


def joined(sequences: Sequence[ArrayLike], states: int, exits: bool, who: str, least: int = 1) -> Joined:
    """Check sequences and put them end to end.

    With an exit, a sequence must be as long as there are states to be able to pass through all of them;
    shorter ones are left out.

    Raises
    ------
    InputError
        There are none, or fewer than `least` that are long enough; frames are not finite, or not as wide as the others.
    """
    if isinstance(sequences, np.ndarray) and sequences.ndim == 2:
        raise InputError(
            f"{who}: found one array of shape {sequences.shape}, expected a list of (T, D) arrays"
        )
    checked = [checked_frames(x, f"{who}, interval {k}") for k, x in enumerate(sequences)]
    if not checked:
        raise InputError(f"{who}: there are no intervals, expected one at least")
    for k, x in enumerate(checked):
        if x.shape[1] != checked[0].shape[1]:
            raise InputError(
                f"{who}, interval {k}: found {x.shape[1]} features, interval 0 has {checked[0].shape[1]}"
            )
    if why := untrainable({"": [len(x) for x in checked]}, states, exits, least):
        raise InputError(f"{who}: {why['']}")
    kept = [x for x in checked if len(x) >= states] if exits else checked
    offsets = np.zeros(len(kept) + 1, dtype=np.int64)
    np.cumsum([len(x) for x in kept], out=offsets[1:])
    return Joined(np.concatenate(kept), offsets, len(checked) - len(kept))


def global_variance(recordings: Sequence[ArrayLike], half: Half | None = (1, 1)) -> Floats:
    """Variance of each feature over all frames of whole recordings, for the variance floor.

    Parameters
    ----------
    recordings
        Frames (T, M) of each.
    half
        Half lengths of the delta windows; None: no deltas.

    Returns
    -------
    (3 M,)
        Of x, Δx, Δ²x; (M,) without deltas. Exactly 0 for a feature that does not vary.
    """
    if not len(recordings):
        raise InputError("global variance: there are no recordings")
    frames = [
        checked_frames(x, f"recording {k}") if half is None else deltas(x, half)
        for k, x in enumerate(recordings)
    ]
    if len({x.shape[1] for x in frames}) > 1:
        raise InputError("global variance: recordings differ in their number of features")
    return spread(np.concatenate(frames))


def spread(x: Floats) -> Floats:
    """Variance of each column; exactly 0 where all values are equal, whatever the rounding of their mean."""
    return np.where(x.min(axis=0) == x.max(axis=0), 0.0, x.var(axis=0))
