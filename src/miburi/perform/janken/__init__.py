"""The simulated corpus `janken`: a glove wearer who shows rock, paper and scissors ([H]'s experiment).

Nobody wore a glove. The plan costs nothing to know; the rest is imported when it is used.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray

    from miburi.formats.labels import Interval

FPS = 30.0

COUNTS: Mapping[str, tuple[int, int]] = {
    "p": (978, 41),
    "r": (581, 42),
    "s": (758, 41),
    "pr": (377, 20),
    "rp": (269, 20),
    "rs": (234, 20),
    "sr": (373, 20),
    "ps": (357, 20),
    "sp": (270, 21),
}
"""Frames and intervals of each label ([H], table 2)."""

# The one way in which these counts come out of three recordings that alternate and begin and end with a hold:
# 41, 41 and 42 holds, the first two from rock to rock, the third from scissors to paper.
RECORDINGS: Mapping[str, tuple[str, str, int]] = {
    "rock_scissors": ("r", "s", 41),
    "rock_paper": ("r", "p", 41),
    "paper_scissors": ("s", "p", 42),
}
"""By take: the first pose, the second, and how many holds."""

SMALL = 17
"""Holds of each recording of a small corpus."""

WEARER = "wearer"


class Plan(NamedTuple):
    """A take that `write` will write.

    Parameters
    ----------
    take
        Its name.
    wearer
        Whose calibration it needs, `{wearer}.yaml`.
    seconds
        About how long it is: as many mean intervals as it has.
    files
        Names of its files.
    """

    take: str
    wearer: str
    seconds: float
    files: tuple[str, ...]


def plan(seed: int = 0, *, small: bool = False) -> tuple[Plan, ...]:
    """The takes that `write` will write, without simulating anything; the same for every seed."""
    return tuple(
        Plan(
            take,
            WEARER,
            round(sum(COUNTS[n][0] / COUNTS[n][1] for n in alternation(take, small=small)) / FPS, 1),
            (f"{take}.csv", f"{take}.lab"),
        )
        for take in RECORDINGS
    )


def alternation(take: str, *, small: bool = False) -> list[str]:
    """A take's labels, hold, change, hold …: "r rs s sr r" for poses r and s and 3 holds."""
    first, second, holds = RECORDINGS[take]
    poses = [(first, second)[k % 2] for k in range(SMALL if small else holds)]
    labels = [poses[0]]
    for k in range(1, len(poses)):
        labels += [poses[k - 1] + poses[k], poses[k]]
    return labels


def calibration() -> dict[str, dict[str, Any]]:
    """The wearer's calibration: see `miburi.perform.janken.sensors.calibration`."""
    from miburi.perform.janken import sensors

    return sensors.calibration()


def perform(seed: int, *, small: bool = False) -> dict[str, tuple[NDArray[np.int64], list[Interval]]]:
    """Counts and labels of the recordings: see `miburi.perform.janken.wearer.perform`."""
    from miburi.perform.janken import wearer

    return wearer.perform(seed, small=small)


def write(folder: str | os.PathLike[str], seed: int, *, small: bool = False) -> list[Path]:
    """Write the recordings: see `miburi.perform.janken.wearer.write`."""
    from miburi.perform.janken import wearer

    return wearer.write(folder, seed, small=small)


__all__ = [
    "COUNTS",
    "FPS",
    "RECORDINGS",
    "SMALL",
    "Plan",
    "alternation",
    "calibration",
    "perform",
    "plan",
    "write",
]
