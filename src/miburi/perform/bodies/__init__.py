"""The simulated corpus `everyday`: people who perform [P]'s keywords, by inverse kinematics of what a
choreographer would fix: pelvis, feet on the ground, hands, trunk and gaze.

Nobody was recorded. The plan costs nothing to know; the rest is imported when it is used.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TYPE_CHECKING

from miburi.perform.bodies.programme import KEYWORDS, OTHERS, PERFORMERS, Clip, Plan, plan

if TYPE_CHECKING:
    from miburi.formats.annotations import Annotation
    from miburi.motion import Motion


def perform(entry: Plan, seed: int) -> tuple[Motion, list[Annotation]]:
    """Perform one take: see `miburi.perform.bodies.take.perform`."""
    from miburi.perform.bodies import take

    return take.perform(entry, seed)


def imagine(keyword: str, performer_seed: int | str) -> Motion:
    """A keyword by somebody who is not in the corpus: see `miburi.perform.bodies.take.imagine`."""
    from miburi.perform.bodies import take

    return take.imagine(keyword, performer_seed)


def annotate(entries: Iterable[Plan], seed: int) -> list[Annotation]:
    """What is done when: see `miburi.perform.bodies.take.annotate`."""
    from miburi.perform.bodies import take

    return take.annotate(entries, seed)


def write(
    folder: str | os.PathLike[str], seed: int, takes: Iterable[str] | None = None, small: bool = False
) -> None:
    """Perform and write takes: see `miburi.perform.bodies.take.write`."""
    from miburi.perform.bodies import take

    take.write(folder, seed, takes, small)


__all__ = [
    "KEYWORDS",
    "OTHERS",
    "PERFORMERS",
    "Clip",
    "Plan",
    "annotate",
    "imagine",
    "perform",
    "plan",
    "write",
]
