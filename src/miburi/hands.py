"""Labelled takes of hands, from the artefacts that hold them."""

from __future__ import annotations

from collections.abc import Sequence

from miburi import artefacts
from miburi.errors import InputError
from miburi.formats.annotations import read_annotations
from miburi.motion import Floats

Interval = tuple[int, int, str]


def labelled_takes(
    motions: Sequence[str], annotations: str
) -> tuple[list[tuple[Floats, list[Interval]]], float]:
    """Angles of takes with their intervals, and the rate that they share.

    Parameters
    ----------
    motions
        Paths of motion artefacts.
    annotations
        Path of the corpus's annotations, with the columns `start_frame` and `end_frame`.

    Returns
    -------
    takes
        Angles (T, 48), degrees, and intervals (start, end exclusive, label), in the order of the takes' names.
    fps
        Frames per second.

    Raises
    ------
    InputError
        A take is no hand's, or takes differ in their rates.
    """
    intervals: dict[str, list[Interval]] = {}
    for row in read_annotations(annotations):
        span = int(row.more["start_frame"]), int(row.more["end_frame"])
        intervals.setdefault(row.take, []).append((*span, row.keyword))
    takes: dict[str, Floats] = {}
    rates: dict[float, str] = {}
    for path in motions:
        for name, motion in artefacts.read_motions(path).items():
            if motion.angles is None:
                raise InputError(f"{path}: the take {name!r} has no joint angles, so it is no hand's")
            takes[name] = motion.angles
            rates.setdefault(motion.fps, name)
    if len(rates) != 1:
        found = ", ".join(f"{take!r} has {fps:g}" for fps, take in rates.items()) or "there are no takes"
        raise InputError(f"takes of one corpus of hands need the same frames per second: {found}")
    return [(takes[name], intervals.get(name, [])) for name in sorted(takes)], next(iter(rates))
