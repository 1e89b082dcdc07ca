"""Who performs what in which take: decided before anything moves, with nothing imported that takes time."""

from __future__ import annotations

import random
from itertools import pairwise
from typing import NamedTuple

EVERYDAY = (
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

TRAINED = (
    "hand stand kicks",
    "backflip",
    "cartwheel",
    "spins",
    "handstands",
    "somersault",
    "jump kick",
    "front hand flip",
    "rug pull fall",
    "Russian dance",
    "breast stroke",
    "free style",
    "back stroke",
    "fly style",
)
"""What experiment 2 adds; not everybody can do it."""

KEYWORDS = EVERYDAY + TRAINED
"""The keywords of [P]'s table 3."""

_FREE = (
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
    "run",
    "turn",
    "catch",
    "look around",
    "wave both arms",
    "arm circles",
    "side bend",
    "lunge",
    "knee raise",
    "jump",
    "toe touch",
    "point by left hand",
    "lie down",
    "sit on chair",
)
OTHERS = (*_FREE[:-1], "sit down", "stand up", "go down 2 steps", "get up")
"""What else the performers do; the last four follow from other motions (who sits or lies must rise)."""

PERFORMERS = ("ash", "birch", "cedar", "elm", "fir", "holly", "rowan", "yew")
"""The performers of the corpus; no person has these names. `people.CAST` describes them."""

_ABLE = ("ash", "cedar", "fir", "holly", "rowan")  # who can do what not everybody can
_HEAVY = ("birch", "elm", "yew")
_UNFIT = frozenset({"run", "jump", "jumping jacks", "lie down"})  # what those leave to others
_TAKES = 9  # of each performer
_SHARE = 4  # performers of each keyword
_TIMES = 3  # each of them
_OTHER = 21  # other motions of each performer
_HALVED = 0.12  # of the takes: at 60 frames/s under a header that says 120
_RESTING = 0.15  # of the takes: begin with a rest pose

# Seconds that a motion takes, with its way there and back: first figure once, second for each repetition.
# Fitted to 48 performances of each; a test holds them to what is performed.
SECONDS: dict[str, tuple[float, float]] = {
    "right punch": (2.7, 0.92),
    "squats": (1.9, 2.03),
    "wash window 1": (2.1, 1.64),
    "wash window 2": (2.5, 1.62),
    "side twists": (2.8, 1.89),
    "climb 2 steps": (5.6, 0.0),
    "point by right hand": (0.4, 1.66),
    "sit on high stool": (5.6, 0.0),
    "sit and swing legs": (4.3, 0.55),
    "hand on chin": (6.2, 0.0),
    "drink soda": (1.5, 2.75),
    "hand stand kicks": (1.8, 1.39),
    "backflip": (3.0, 0.0),
    "cartwheel": (3.7, 0.0),
    "spins": (0.7, 2.19),
    "handstands": (6.5, 0.0),
    "somersault": (3.6, 0.0),
    "jump kick": (4.5, 0.0),
    "front hand flip": (4.1, 0.0),
    "rug pull fall": (5.3, 0.0),
    "Russian dance": (2.4, 0.44),
    "breast stroke": (3.9, 1.62),
    "free style": (4.1, 1.3),
    "back stroke": (4.1, 1.4),
    "fly style": (4.0, 1.31),
    "lie down": (6.9, 0.0),
    "walk": (0.7, 0.62),
    "wave": (1.2, 0.56),
    "throw": (3.0, 0.0),
    "kick": (-0.1, 1.57),
    "bow": (2.3, 0.0),
    "pick up": (3.0, 0.0),
    "clap": (1.1, 0.41),
    "reach up": (-0.2, 2.76),
    "left punch": (2.5, 0.96),
    "phone call": (4.5, 0.0),
    "scratch head": (1.6, 0.35),
    "mop floor": (3.3, 1.2),
    "jumping jacks": (0.2, 1.2),
    "stretch": (3.5, 2.42),
    "run": (1.4, 0.35),
    "turn": (2.5, 0.0),
    "catch": (1.9, 0.0),
    "look around": (1.7, 1.49),
    "wave both arms": (1.5, 0.78),
    "arm circles": (1.0, 1.21),
    "side bend": (2.0, 2.17),
    "lunge": (0.2, 2.58),
    "knee raise": (-0.1, 1.18),
    "jump": (0.3, 1.96),
    "toe touch": (0.4, 2.19),
    "point by left hand": (0.4, 1.64),
    "sit on chair": (4.9, 0.0),
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
    "hand stand kicks": (2, 4),
    "spins": (1, 3),
    "Russian dance": (5, 9),
    "breast stroke": (2, 4),
    "free style": (2, 4),
    "back stroke": (2, 4),
    "fly style": (2, 4),
    "run": (4, 7),
    "look around": (1, 3),
    "wave both arms": (2, 4),
    "arm circles": (2, 4),
    "side bend": (2, 3),
    "lunge": (2, 3),
    "knee raise": (3, 6),
    "jump": (1, 3),
    "toe touch": (1, 3),
    "point by left hand": (1, 3),
}


class Clip(NamedTuple):
    """A motion within a take: its keyword, how often it is repeated, a number that seeds how it is done."""

    keyword: str
    repetitions: int
    variant: int


class Plan(NamedTuple):
    """A take to perform; `seconds` is an estimate, `keywords` are in the order in which they come.

    `fps` is the true rate, 60 or 120, whatever the file's header says; `rest`: the file begins with a rest pose.
    """

    take: str
    performer: str
    seconds: float
    keywords: tuple[str, ...]
    clips: tuple[Clip, ...]
    fps: float
    rest: bool


def plan(seed: int, small: bool = False) -> list[Plan]:
    """The takes of the corpus.

    Parameters
    ----------
    seed
        The config's seed.
    small
        Two performers, each keyword of experiment 1 and some others once by each, few repetitions.

    Returns
    -------
    list
        In the order of the takes' names, `{performer}_{nn}`.
    """
    rng = random.Random(f"everyday/{seed}/{small}")
    if small:
        takes = 3
        wanted = {"ash": [*EVERYDAY, "backflip"], "birch": [*EVERYDAY, "walk"]}
    else:
        takes = _TAKES
        wanted = {}
        for i, p in enumerate(PERFORMERS):
            does = [k for k in _FREE if p not in _HEAVY or k not in _UNFIT]
            wanted[p] = [does[(5 * i + k) % len(does)] for k in range(_OTHER)]
        for number, keyword in enumerate(EVERYDAY):
            for k in range(_SHARE):  # each performer has about as much to do as any other
                wanted[_everyday(number, k)] += [keyword] * _TIMES
        for number, keyword in enumerate(TRAINED):
            for k in range(_SHARE):
                wanted[_ABLE[(number + k) % len(_ABLE)]] += [keyword] * _TIMES
    return [
        _take(f"{performer}_{number + 1:02d}", performer, part, rng, small)
        for performer in wanted
        for number, part in enumerate(_dealt(wanted[performer], takes, rng))
    ]


def _everyday(number: int, k: int) -> str:
    """The k-th performer of an everyday keyword: most are done by those who do nothing else."""
    return _HEAVY[(number + k) % len(_HEAVY)] if k < 2 else _ABLE[(2 * number + k) % len(_ABLE)]


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
    seconds = 0.3 + sum(0.8 + SECONDS[c.keyword][0] + SECONDS[c.keyword][1] * c.repetitions for c in clips)
    fps = 60.0 if rng.random() < _HALVED else 120.0
    rest = rng.random() < _RESTING
    return Plan(name, performer, round(seconds, 1), tuple(keywords), tuple(clips), fps, rest)
