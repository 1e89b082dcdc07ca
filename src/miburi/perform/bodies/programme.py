"""Who performs what in which take: decided before anything moves, with nothing imported that takes time."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import NamedTuple

KEYWORDS = (
    "right punch",
    "squats",
    "wash window 1",
    "wash window 2",
    "side twists",
    "climb 2 steps",
    "point by right hand",
    "sit on high stool",
    "sit and swing legs",
    "hand on chin",
    "drink soda",
)
"""The keywords of [P]'s experiment 1."""

OTHERS = (
    "walk",
    "wave",
    "throw",
    "kick",
    "bow",
    "pick up",
    "clap",
    "reach up",
    "left punch",
    "phone call",
    "scratch head",
    "mop floor",
    "jumping jacks",
    "stretch",
    "sit down",
    "stand up",
    "go down 2 steps",
)
"""What else the performers do; the last three follow from keywords (who sits must rise)."""

PERFORMERS = ("ash", "birch", "cedar", "elm", "fir", "holly")
"""The performers of the corpus; no person has these names."""

_TAKES = 7  # of each performer
_SHARE = 4  # performers of each keyword
_TIMES = 2  # each of them
_FREE = 10  # other motions of each performer

# Seconds that a motion takes, with its way there and back: first figure once, second for each repetition.
# Fitted to some 60 performances of each; a test holds them to what is performed.
SECONDS = {
    "right punch": (2.3, 0.99),
    "squats": (1.7, 2.17),
    "wash window 1": (2.1, 1.63),
    "wash window 2": (2.9, 1.34),
    "side twists": (2.0, 1.93),
    "climb 2 steps": (5.3, 0.0),
    "point by right hand": (0.4, 1.47),
    "sit on high stool": (5.0, 0.0),
    "sit and swing legs": (3.7, 0.61),
    "hand on chin": (6.0, 0.0),
    "drink soda": (1.2, 2.73),
    "walk": (1.0, 0.54),
    "wave": (0.9, 0.62),
    "throw": (3.0, 0.0),
    "kick": (0.0, 1.45),
    "bow": (2.2, 0.0),
    "pick up": (2.9, 0.0),
    "clap": (0.8, 0.44),
    "reach up": (0.0, 2.52),
    "left punch": (2.5, 0.9),
    "phone call": (4.2, 0.0),
    "scratch head": (1.7, 0.23),
    "mop floor": (3.5, 1.03),
    "jumping jacks": (1.0, 0.95),
    "stretch": (4.3, 1.6),
}
REPETITIONS = {
    "right punch": (2, 4),
    "squats": (2, 4),
    "wash window 1": (3, 6),
    "wash window 2": (3, 6),
    "side twists": (3, 5),
    "point by right hand": (1, 3),
    "sit and swing legs": (4, 8),
    "drink soda": (1, 2),
    "walk": (4, 8),
    "wave": (2, 5),
    "kick": (1, 2),
    "bow": (1, 1),
    "clap": (4, 8),
    "reach up": (1, 2),
    "left punch": (1, 3),
    "scratch head": (3, 6),
    "mop floor": (2, 4),
    "jumping jacks": (3, 5),
    "stretch": (1, 2),
}


class Clip(NamedTuple):
    """A motion within a take: its keyword, how often it is repeated, a number that seeds how it is done."""

    keyword: str
    repetitions: int
    variant: int


class Plan(NamedTuple):
    """A take to perform; `seconds` is an estimate, `keywords` are in the order in which they come."""

    take: str
    performer: str
    seconds: float
    keywords: tuple[str, ...]
    clips: tuple[Clip, ...]


def plan(seed: int, small: bool = False) -> list[Plan]:
    """The takes of the corpus.

    Parameters
    ----------
    seed
        The config's seed.
    small
        Two performers, each keyword once by each, few repetitions.

    Returns
    -------
    list
        In the order of the takes' names, `{performer}_{nn}`.
    """
    rng = random.Random(f"everyday/{seed}/{small}")
    free = [k for k in OTHERS if k in SECONDS]
    performers = PERFORMERS[:2] if small else PERFORMERS
    if small:
        takes = 3
        wanted = {p: list(KEYWORDS) for p in performers}
    else:
        takes = _TAKES
        wanted = {p: [free[(3 * i + k) % len(free)] for k in range(_FREE)] for i, p in enumerate(performers)}
        for number, keyword in enumerate(KEYWORDS):
            for k in range(_SHARE):  # each performer has about as much to do as any other
                wanted[performers[(number + k) % len(performers)]] += [keyword] * _TIMES
    return [
        _take(f"{performer}_{number + 1:02d}", performer, part, rng, small)
        for performer in performers
        for number, part in enumerate(_dealt(wanted[performer], takes, rng))
    ]


def _dealt(keywords: list[str], takes: int, rng: random.Random) -> list[list[str]]:
    """Shuffle keywords into takes of about the same length, so that equal ones never follow each other."""
    while True:
        rng.shuffle(keywords)
        parts = [keywords[k::takes] for k in range(takes)]
        if all(a != b for part in parts for a, b in pairwise(part)):
            return parts


def _take(name: str, performer: str, keywords: list[str], rng: random.Random, small: bool) -> Plan:
    clips = []
    for keyword in keywords:
        low, high = REPETITIONS.get(keyword, (1, 1))
        low, high = (max(low - 1, 1), low) if small else (low, high)
        clips.append(Clip(keyword, rng.randint(low, high), rng.randrange(2**31)))
    seconds = (
        0.3
        + 0.8 * len(clips)
        + sum(SECONDS[c.keyword][0] + SECONDS[c.keyword][1] * c.repetitions for c in clips)
    )
    return Plan(name, performer, round(seconds, 1), tuple(keywords), tuple(clips))
