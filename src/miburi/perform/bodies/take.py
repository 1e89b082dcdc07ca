"""Takes of the corpus: several motions in a row, each as its own score has it, and what was done when."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path

import numpy as np

from miburi import formats, store
from miburi.errors import InputError
from miburi.formats.annotations import Annotation
from miburi.motion import Motion
from miburi.perform.bodies import acrobatics, actions, dances, extras, floor, gestures, others, steps, strokes
from miburi.perform.bodies.body import embody
from miburi.perform.bodies.curves import RATE
from miburi.perform.bodies.people import person
from miburi.perform.bodies.programme import KEYWORDS, REPETITIONS, Clip, Plan, plan
from miburi.perform.bodies.score import Score

Done = list[tuple[str, float, float]]
_OTHER_HAND = 0.15  # of the motions that either hand could do


def _single(keyword: str, motion: Callable[[Score, int], gestures.Span]) -> Callable[[Score, int], Done]:
    return lambda b, times: [(keyword, *motion(b, times))]


def _climb(b: Score, times: int) -> Done:
    done = [("climb 2 steps", *actions.climb(b))]
    actions.idle(b, b.beat(0.5, 0.3))
    return [*done, ("go down 2 steps", *actions.descend(b))]


def _seated(b: Score, keyword: str, motion: Callable[[], gestures.Span], seat: float, hands: str) -> Done:
    actions.keep_feet(b)
    done = [("sit down", *actions.sit(b, seat, hands=hands))]
    actions.idle(b, b.beat(0.3, 0.3))
    done.append((keyword, *motion()))
    return [*done, ("stand up", *actions.stand_up(b))]


def _swing(b: Score, times: int) -> Done:
    keyword = "sit and swing legs"
    seat = float(b.rng.uniform(0.36, 0.44))
    return _seated(b, keyword, lambda: actions.swing_legs(b, times), seat, "edge")


def _chin(b: Score, times: int) -> Done:
    keyword = "hand on chin"
    if b.way("thinks", "standing", "standing", "seated") == "standing":
        return [(keyword, *gestures.chin(b))]
    return _seated(b, keyword, lambda: actions.chin_seated(b), b.vary(0.27, 0.01), "knee")


def _rug(b: Score, times: int) -> Done:
    fall = ("rug pull fall", *floor.rug_pull(b))
    return [fall, ("get up", *floor.get_up(b))]


def _lie(b: Score, times: int) -> Done:
    lie = ("lie down", *floor.lie_down(b))
    return [lie, ("get up", *floor.get_up(b))]


def _chair(b: Score, times: int) -> Done:
    actions.keep_feet(b)
    done = [
        ("sit down", *actions.sit(b, float(b.rng.uniform(0.25, 0.28)), hands=b.way("chair", "knee", "edge")))
    ]
    actions.idle(b, b.beat(1.5, 0.5))
    return [*done, ("stand up", *actions.stand_up(b))]


MOTIONS: Mapping[str, Callable[[Score, int], Done]] = {
    "right punch": _single("right punch", gestures.punch),
    "squats": _single("squats", actions.squats),
    "wash window 1": _single("wash window 1", lambda b, n: gestures.wash(b, n, False)),
    "wash window 2": _single("wash window 2", lambda b, n: gestures.wash(b, n, True)),
    "side twists": _single("side twists", actions.twists),
    "climb 2 steps": _climb,
    "point by right hand": _single("point by right hand", gestures.point),
    "sit on high stool": _single("sit on high stool", lambda b, n: actions.stool(b)),
    "sit and swing legs": _swing,
    "hand on chin": _chin,
    "drink soda": _single("drink soda", gestures.drink),
    "hand stand kicks": _single("hand stand kicks", acrobatics.hand_stand_kicks),
    "backflip": _single("backflip", lambda b, n: acrobatics.backflip(b)),
    "cartwheel": _single("cartwheel", lambda b, n: acrobatics.cartwheel(b)),
    "spins": _single("spins", dances.spins),
    "handstands": _single("handstands", lambda b, n: acrobatics.handstand(b)),
    "somersault": _single("somersault", lambda b, n: floor.somersault(b)),
    "jump kick": _single("jump kick", lambda b, n: acrobatics.jump_kick(b)),
    "front hand flip": _single("front hand flip", lambda b, n: acrobatics.hand_flip(b)),
    "rug pull fall": _rug,
    "Russian dance": _single("Russian dance", dances.russian),
    "breast stroke": _single("breast stroke", strokes.breast),
    "free style": _single("free style", lambda b, n: strokes.crawl(b, n, False)),
    "back stroke": _single("back stroke", lambda b, n: strokes.crawl(b, n, True)),
    "fly style": _single("fly style", strokes.fly),
    "lie down": _lie,
    "walk": _single("walk", actions.walk),
    "wave": _single("wave", gestures.wave),
    "throw": _single("throw", lambda b, n: gestures.throw(b)),
    "kick": _single("kick", actions.kick),
    "bow": _single("bow", lambda b, n: extras.bow(b)),
    "pick up": _single("pick up", lambda b, n: actions.pick_up(b)),
    "clap": _single("clap", gestures.clap),
    "reach up": _single("reach up", extras.reach_up),
    "left punch": _single("left punch", lambda b, n: gestures.punch(b, n, "l")),
    "phone call": _single("phone call", lambda b, n: extras.phone(b)),
    "scratch head": _single("scratch head", extras.scratch),
    "mop floor": _single("mop floor", extras.mop),
    "jumping jacks": _single("jumping jacks", extras.jacks),
    "stretch": _single("stretch", extras.stretch),
    "run": _single("run", others.run),
    "turn": _single("turn", others.turn),
    "catch": _single("catch", others.catch),
    "look around": _single("look around", others.look_around),
    "wave both arms": _single("wave both arms", others.wave_both),
    "arm circles": _single("arm circles", others.arm_circles),
    "side bend": _single("side bend", others.side_bend),
    "lunge": _single("lunge", others.lunge),
    "knee raise": _single("knee raise", others.knee_raise),
    "jump": _single("jump", others.jump),
    "toe touch": _single("toe touch", others.toe_touch),
    "point by left hand": _single("point by left hand", lambda b, n: gestures.point(b, n, "l")),
    "sit on chair": _chair,
}
"""Keyword → what adds it to a score: (score, repetitions) → [(keyword, start, end) …]."""


def compose(entry: Plan, seed: int) -> tuple[Score, Done]:
    """The score of a take and what is done when, seconds."""
    who = person(entry.performer, seed)
    b = Score(who, store.seed(seed, "everyday", entry.take))
    b.now = float(b.rng.uniform(0.2, 0.5))
    done: Done = []
    for number, clip in enumerate(entry.clips):
        b.rng = store.seed(seed, "everyday", entry.take, number, clip.variant)
        b.hand = _hand(b)
        if number:
            _between(b)
        done += MOTIONS[clip.keyword](b, clip.repetitions)
    b.now += float(b.rng.uniform(0.2, 0.5))
    return b, done


def _hand(b: Score) -> str:
    """The hand of a motion that either could do: mostly the one that its performer prefers."""
    return "rl"[int(b.who.left_handed != (b.rng.random() < _OTHER_HAND))]


def _between(b: Score) -> None:
    """What people do between two motions: wait a moment, now and then turn."""
    actions.idle(b, float(b.rng.uniform(0.15, 0.6)))
    if b.rng.random() < 0.25:
        steps.turn_round(b, float(b.rng.choice([-1.0, 1.0]) * b.rng.uniform(25.0, 120.0)))


def perform(entry: Plan, seed: int) -> tuple[Motion, list[Annotation]]:
    """Perform one take.

    Parameters
    ----------
    entry
        One of `plan`'s.
    seed
        The config's seed; takes do not depend on each other.

    Returns
    -------
    motion
        Metres, at the take's true rate, without its rest pose.
    annotations
        As `annotate` gives them.
    """
    b, done = compose(entry, seed)
    motion = embody(b, store.seed(seed, "everyday", entry.take, "unrest"), entry.take, entry.fps)
    return motion, _rows(entry, b, done)


def annotate(entries: Iterable[Plan], seed: int) -> list[Annotation]:
    """What is done when, of some takes.

    Returns
    -------
    list
        In the order of the takes and of time; seconds of the true rate, from the first frame after a rest pose.
        Further columns: `performer`, and `recording`, which says "simulated".
    """
    rows: list[Annotation] = []
    for entry in entries:
        rows += _rows(entry, *compose(entry, seed))
    return rows


def _rows(entry: Plan, b: Score, done: Done) -> list[Annotation]:
    more = {"performer": entry.performer, "recording": "simulated"}
    last = np.ceil(b.now * RATE) / RATE
    return [
        Annotation(entry.take, round(start, 3), round(min(end, last), 3), keyword, more)
        for keyword, start, end in done
    ]


def imagine(keyword: str, performer_seed: int | str) -> Motion:
    """A keyword as somebody performs it who is not in the corpus ([P], protocol 2).

    Only the annotated part, from the performer's first to last frame of the keyword.

    Raises
    ------
    InputError
        There is no such keyword.
    """
    if keyword not in MOTIONS:
        raise InputError(f"keyword {keyword!r} is not performed; there are {', '.join(MOTIONS)}")
    rng = store.seed(performer_seed, "imagine", keyword)
    low, high = REPETITIONS.get(keyword, (1, 1))
    clip = Clip(keyword, int(rng.integers(low, high + 1)), int(rng.integers(2**31)))
    name = f"imagined_{performer_seed}"
    entry = Plan(f"{name}_{keyword.replace(' ', '_')}", name, 0.0, (keyword,), (clip,), 120.0, False)
    b, done = compose(entry, 0)
    motion = embody(b, store.seed(performer_seed, "imagine", keyword, "unrest"), entry.take)
    start, end = next((s, e) for k, s, e in done if k == keyword)
    return motion[int(np.floor(start * motion.fps)) : int(np.ceil(end * motion.fps)) + 1]


def write(
    folder: str | os.PathLike[str], seed: int, takes: Iterable[str] | None = None, small: bool = False
) -> None:
    """Perform and write `{take}.bvh`.

    As in the CMU database, the header of every file says 120 frames/s, also where every second frame only was
    kept, and some files begin with a rest pose.

    Parameters
    ----------
    takes
        Names of those to write; absent: all.

    Raises
    ------
    InputError
        A take is not in the plan.
    """
    entries = {p.take: p for p in plan(seed, small)}
    names = list(entries) if takes is None else sorted(takes)
    for name in names:
        if name not in entries:
            raise InputError(f"take {name!r} is not in the corpus; it has {', '.join(entries)}")
    for name in names:
        motion, _ = perform(entries[name], seed)
        root, rotations = motion.root, motion.rotations
        if entries[name].rest:
            root = np.concatenate([root[:1], root])
            rotations = np.concatenate([np.tile([0.0, 0.0, 0.0, 1.0], (1, rotations.shape[1], 1)), rotations])
        formats.write(
            Path(folder) / f"{name}.bvh", Motion(motion.skeleton, 120.0, root, rotations, name=name)
        )


__all__ = ["KEYWORDS", "MOTIONS", "annotate", "compose", "imagine", "perform", "write"]
