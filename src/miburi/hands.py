"""Labelled takes of hands, from the artefacts that hold them."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import Match, SequenceMatcher

from miburi import artefacts
from miburi.errors import InputError
from miburi.figures import HAND
from miburi.formats.annotations import read_annotations
from miburi.motion import Floats

Interval = tuple[int, int, str]


def longest_match(
    takes: Sequence[tuple[Floats, Sequence[Interval]]], labels: Sequence[str]
) -> tuple[Floats, list[Interval]]:
    """The recording from where it shows most of a string's labels one after the other.

    Parameters
    ----------
    takes
        As from `labelled_takes`.
    labels
        Of the string.

    Returns
    -------
    angles : (T, 48)
        From the beginning of that run of labels to the end of its take.
    intervals
        Of these frames.
    """

    def run(take: tuple[Floats, Sequence[Interval]]) -> Match:
        shown = [label for _, _, label in take[1]]
        return SequenceMatcher(None, shown, list(labels), autojunk=False).find_longest_match()

    angles, intervals = max(takes, key=lambda take: run(take).size)
    found = run((angles, intervals))
    begin = intervals[found.a][0] if found.size else 0
    after = [(a - begin, b - begin, label) for a, b, label in intervals if a >= begin]
    return angles[begin:], after


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
    intervals = read_intervals(annotations)
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


def read_intervals(annotations: str) -> dict[str, list[Interval]]:
    """Intervals (start, end exclusive, label) of each take, from a corpus's annotations in frames.

    Raises
    ------
    InputError
        The file cannot be read, or lacks the columns `start_frame` and `end_frame`.
    """
    intervals: dict[str, list[Interval]] = {}
    for number, row in enumerate(read_annotations(annotations), 2):
        try:
            span = int(row.more["start_frame"]), int(row.more["end_frame"])
        except (KeyError, ValueError):
            raise InputError(
                f"{annotations}, line {number}: start_frame and end_frame are no whole numbers"
            ) from None
        intervals.setdefault(row.take, []).append((*span, row.keyword))
    return dict(sorted(intervals.items()))


def angle_of(name: str) -> tuple[int, str]:
    """Column of an angle among the 48 of a hand, and its name in words, from "joint_axis" as "middle3_x".

    Raises
    ------
    InputError
        The hand has no such joint or axis.
    """
    joint, _, axis = name.rpartition("_")
    if joint not in HAND.joints or axis not in ("z", "x", "y"):
        raise InputError(
            f"there is no angle {name!r}; expected a joint and an axis, as middle3_x: {', '.join(HAND.joints)}; z, x, y"
        )
    finger, number = joint.rstrip("0123456789"), joint.lstrip("abcdefghijklmnopqrstuvwxyz")
    of = "" if finger == "thumb" else " finger"
    words = "wrist" if not number else f"{finger}{of},\n{('first', 'second', 'third')[int(number) - 1]} joint"
    return 3 * HAND.index(joint) + "zxy".index(axis), words if axis == "x" else f"{words}, {axis.upper()}"
