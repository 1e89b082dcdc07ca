"""Strings of labels: their grammar, and which label may follow which.

A string is a row of words separated by blanks. A word is a label; `r*2` lasts twice as long as r does in the
recordings, `r*0.5` half as long, `r=1.5s` a second and a half.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from miburi.errors import InputError

Takes = Sequence[Sequence[tuple[int, int, str]]]
"""Intervals (start, end exclusive, label) of each take."""

_WORD = re.compile(r"(?P<label>.+?)(?:\*(?P<factor>\d+(?:\.\d+)?)|=(?P<seconds>\d+(?:\.\d+)?)s)")


class Word(NamedTuple):
    """A label of a string, as written, and how long it lasts: `factor` times its own length, or `seconds`."""

    text: str
    label: str
    factor: float = 1.0
    seconds: float | None = None


class Succession(NamedTuple):
    """A label that followed another in the recordings without a gap, and how often."""

    label: str
    follower: str
    times: int


def label_of(word: str) -> str:
    """The label of a word, which may say how long it lasts."""
    match = _WORD.fullmatch(word)
    return match["label"] if match else word


def parse(
    string: str | Sequence[str],
    labels: Sequence[str] | Mapping[str, object],
    successions: Sequence[Succession] | None = None,
) -> tuple[Word, ...]:
    """The words of a string, each of a known label.

    Parameters
    ----------
    string
        Words separated by blanks, or a sequence of them.
    labels
        Those that are known. A word that is one of them is that label, whatever signs are in it.
    successions
        What the recordings show; absent: any label may follow any.

    Raises
    ------
    InputError
        The string is empty, a label is unknown, a duration is 0, or a label follows another that it follows in
        no recording; the sentence names the word, its place in the string and what there is.
    """
    texts = tuple(string.split()) if isinstance(string, str) else tuple(str(s) for s in string)
    if not texts:
        raise InputError("the string of labels is empty")
    who = f"string {' '.join(texts)!r}"
    words = tuple(_word(text, place, labels, who) for place, text in enumerate(texts, 1))
    if successions is not None:
        _check_pairs(words, successions, who)
    return words


def _word(text: str, place: int, labels: Sequence[str] | Mapping[str, object], who: str) -> Word:
    if text in labels and text.split() != [text]:
        raise InputError(f"label {text!r} has a blank in it, which separates the labels of a string")
    if text in labels:
        return Word(text, text)
    match = _WORD.fullmatch(text)
    label = match["label"] if match else text
    if label not in labels:
        said = f"{label!r}" if label == text else f"{label!r} (of {text!r})"
        raise InputError(f"{who}: label {place} is {said}, known are {', '.join(sorted(labels))}")
    assert match is not None
    factor = float(match["factor"] or 1.0)
    seconds = None if match["seconds"] is None else float(match["seconds"])
    if factor == 0.0 or seconds == 0.0:
        raise InputError(f"{who}: label {place} is {text!r}, expected it to last longer than 0")
    return Word(text, label, factor, seconds)


def _check_pairs(words: Sequence[Word], successions: Sequence[Succession], who: str) -> None:
    after: dict[str, list[str]] = {}
    for pair in successions:
        after.setdefault(pair.label, []).append(pair.follower)
    for place, (one, other) in enumerate(pairwise(words), 1):
        there = after.get(one.label, [])
        if other.label not in there:
            known = f"after it come {', '.join(sorted(there))}" if there else "nothing comes after it"
            raise InputError(
                f"{who}: labels {place} and {place + 1} are {one.label!r} and {other.label!r}, which "
                f"follow each other in no recording; {known}"
            )


def successions(takes: Takes) -> list[Succession]:
    """Which label follows which in the recordings, and how often; by label and follower.

    An interval follows another that ends where it begins.
    """
    counts: Counter[tuple[str, str]] = Counter()
    for intervals in takes:
        ordered = sorted(intervals)
        for (_, end, label), (start, _, follower) in pairwise(ordered):
            if start == end:
                counts[label, follower] += 1
    return [Succession(*pair, counts[pair]) for pair in sorted(counts)]


def draw(
    pairs: Sequence[Succession], count: int, seed: int | Sequence[int], first: str = ""
) -> tuple[str, ...]:
    """A string at random in which each label follows the one before as in the recordings.

    Parameters
    ----------
    pairs
        `successions` of the recordings.
    count
        Labels in the string.
    seed
        Of the draw.
    first
        The first label; empty: drawn as often as the recordings go on from it.

    Returns
    -------
    count labels
        Followers are drawn as often as the recordings show them, among those from which the string can still
        become long enough.

    Raises
    ------
    InputError
        No succession of labels is so long.
    """
    follows: dict[str, dict[str, int]] = {}
    for label, follower, n in pairs:
        follows.setdefault(label, {})[follower] = n
    names = sorted({*follows, *(p.follower for p in pairs)})
    longest = {label: 1 for label in names}  # labels of a string that begins with this one, up to count
    for _ in range(count - 1):
        longest = {s: 1 + max((longest[f] for f in follows.get(s, {})), default=0) for s in names}
    rng = np.random.default_rng(seed)
    found: list[str] = []
    while len(found) < count:
        weights = follows.get(found[-1], {}) if found else {s: sum(f.values()) for s, f in follows.items()}
        if not found and first:
            weights = {first: 1} if first in names else {}
        open_ = {s: n for s, n in sorted(weights.items()) if longest[s] >= count - len(found)}
        if not open_ and not found and count == 1:
            open_ = dict.fromkeys(names, 1)
        if not open_:
            whence = f" from {first!r}" if first else ""
            raise InputError(
                f"a string of {count} labels: the recordings' successions{whence} are not that long"
            )
        p = np.array(list(open_.values()), dtype=np.float64)
        found.append(list(open_)[int(rng.choice(len(p), p=p / p.sum()))])
    return tuple(found)


def untrainable(
    lengths: Mapping[str, Sequence[int]], states: int, exits: bool, least: int = 1
) -> dict[str, str]:
    """Labels that cannot be trained, each with why and what helps.

    Parameters
    ----------
    lengths
        Frames of each interval of each label.
    states
        N of the models.
    exits
        Models have an exit, so that an interval must last a frame for each state.
    least
        Intervals that a label must have.
    """
    found = {}
    for label, frames in lengths.items():
        fit = [n for n in frames if n >= states] if exits else list(frames)
        longest = max(frames, default=0)
        if longest < states:
            found[label] = (
                f"the longest of {len(frames)} intervals has {longest} frames, expected {states} or more, one for "
                "each state; record more of it, or train fewer states"
            )
        elif len(fit) < least:
            found[label] = (
                f"{len(fit)} of {len(frames)} intervals are long enough for {states} states, expected {least} or more; "
                "record more of it, or lower train.least_intervals"
            )
    return found
