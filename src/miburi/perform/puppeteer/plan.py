"""Which limbs are played when: a user has two hands and a clip has four limbs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, minimum_filter1d

from miburi.motion import Floats
from miburi.perform.puppeteer.body import REACH, ROOTS
from miburi.perform.puppeteer.chance import FPS
from miburi.perform.puppeteer.users import Habits

GRASP = 0.09
"""Metres: two hands or two feet of the puppet that stay this close fit into one hand …"""
TOGETHER = 0.35
"""… which holds both only while what they do apart from each other is less than this share of what they
do."""
PHRASE_S = 0.5
"""Shortest piece of a clip that is played in one go."""
JOIN_S = 0.4
"""Seconds in which a limb that is taken is brought to where it is wanted."""
_STILL = 0.04
"""A limb whose path spreads by less than this, in lengths of a leg, does not move."""
_GLARING = 0.6
"""A limb that is out of place by more than this share of its reach is put right by everybody."""
_KEPT = 1.3
"""A limb that is already held is worth more than another that moves as much."""


@dataclass
class Plan:
    """A time line at 60 samples/s: where in the clip each limb and the trunk are, and who is held."""

    clock: list[Floats] = field(default_factory=list)
    """Pieces (n, 5): clip frame that the four limbs and the trunk play."""
    held: list[NDArray[np.bool_]] = field(default_factory=list)
    """Pieces (n, 4)."""
    at: Floats = field(default_factory=lambda: np.zeros(5))

    def add(self, n: int, limbs: Sequence[int], clip: Floats | None = None, *, trunk: bool = False) -> None:
        """n samples in which `limbs` are held and play `clip` (n,) (absent: they wait), the trunk with
        them."""
        clock = np.tile(self.at, (n, 1))
        if clip is not None:
            clock[:, [*limbs, *([4] if trunk else [])]] = clip[:, None]
        held = np.zeros((n, 4), dtype=bool)
        held[:, list(limbs)] = True
        self.clock.append(clock)
        self.held.append(held)
        if n:
            self.at = clock[-1].copy()


def important(shown: Floats, ignore: float) -> NDArray[np.bool_]:
    """Which limbs the user means to move: (4,), from what hands and feet show (T, 4, D)."""
    spread = np.sqrt(shown.var(axis=0).sum(axis=-1))
    meant: NDArray[np.bool_] = spread > max(_STILL, ignore * float(spread.max()))
    return meant


def phrases(shown: Floats) -> list[tuple[int, int]]:
    """Cut a clip (T, L, D) where it is slowest: pieces (first, last frame), each about half a second or
    more."""
    n = len(shown)
    width = round(PHRASE_S * FPS)
    if n < 2 * width:
        return [(0, n - 1)]
    speed = gaussian_filter1d(np.linalg.norm(np.diff(shown, axis=0), axis=-1).sum(axis=-1), 0.05 * FPS)
    slow = np.flatnonzero((speed == minimum_filter1d(speed, 2 * width - 1)) & (speed < speed.mean()))
    cuts = [0]
    for t in slow.tolist():
        if t - cuts[-1] >= width and n - 1 - t >= width:
            cuts.append(t)
    return list(zip(cuts, [*cuts[1:], n - 1], strict=True))


def _grips(places: Floats, wanted: Sequence[int]) -> list[tuple[int, ...]]:
    """What one hand can hold in a phrase: a limb, or a pair of which both ends stay close and move alike."""
    units: list[tuple[int, ...]] = [(k,) for k in wanted]
    for pair in ((0, 1), (2, 3)):
        if not set(pair) <= set(wanted):
            continue
        between = places[:, pair[0]] - places[:, pair[1]]
        travel = np.linalg.norm(places - places[0], axis=-1).max(axis=0)[list(pair)].min()
        own = np.linalg.norm(between - between.mean(axis=0), axis=-1).max()
        if np.median(np.linalg.norm(between, axis=-1)) < GRASP and own < TOGETHER * travel:
            units.append(pair)
    return units


def lead(places: Floats, value: Floats, habits: Habits) -> list[int]:
    """The limbs that the hands hold in a phrase: those that are worth most together.

    places (T, 4, 3): hands and feet in the trunk's frame; value (4,): 0 for limbs that need no hand.
    """
    wanted = [k for k in range(4) if value[k] > 0]
    units = _grips(places, wanted)
    best: tuple[float, list[int]] = (0.0, [])
    for n in range(1, habits.grips + 1):
        for chosen in combinations(units, n):
            limbs = sorted(k for unit in chosen for k in unit)
            if len(set(limbs)) == len(limbs) <= habits.limbs:
                worth = float(value[limbs].sum())
                if worth > best[0]:
                    best = (worth, limbs)
    return best[1]


def _uneven(first: float, last: float, n: int, amount: float, rng: np.random.Generator) -> Floats:
    """From first to last in n samples, faster here and slower there, never backwards."""
    r = np.arange(1, n + 1) / n
    bend = float(np.clip(amount * rng.normal(), -0.6, 0.6))
    return first + (last - first) * (r + bend * np.sin(2 * np.pi * r) / (2 * np.pi))


def _samples(seconds: float) -> int:
    return round(seconds * FPS)


def timeline(
    shown: Floats,
    paths: Floats,
    habits: Habits,
    rng: np.random.Generator,
    off: NDArray[np.bool_] | None = None,
) -> tuple[Floats, NDArray[np.bool_]]:
    """Plan how a clip is played.

    Parameters
    ----------
    shown : (T, 4, D)
        What the clip shows of hands and feet, lengths of a leg: decides which limbs matter and when.
    paths : (T, 4, 3)
        Where the user means to bring hands and feet from shoulders and hips, metres on the puppet.
    off : (4,), optional
        Limbs that are to be put where the clip begins.

    Returns
    -------
    clock : (N, 5)
        Clip frame of each limb and of the trunk.
    held : (N, 4)
        Who is in the user's hands; at most `habits.limbs` at once.
    """
    meant = important(shown, habits.ignore)
    plan = Plan()
    pieces = phrases(shown[:, meant]) if meant.any() else [(0, len(paths) - 1)]
    plan.add(_samples(habits.reach_in_s * rng.uniform(0.3, 0.6)), [])  # the hands come near
    held = _put(plan, paths, off, habits, rng) if off is not None else []
    again = rng.random() < habits.second_pass
    played = np.zeros(4)
    for number, (a, b) in enumerate(pieces):
        travel = meant * np.linalg.norm(shown[a : b + 1] - shown[a], axis=-1).max(axis=0)
        worth = np.where(travel > _STILL, travel, 0.0)
        worth[held] *= _KEPT
        led = lead(paths[a : b + 1] + ROOTS, worth, habits) or held
        if number == 0 and not held:
            plan.add(_samples(habits.reach_in_s * rng.uniform(0.3, 0.5)), led)  # … and take hold
        elif led != held:
            plan.add(_samples(habits.regrip_s * rng.uniform(0.7, 1.3)), [])
        elif rng.random() < habits.pause:
            plan.add(_samples(habits.pause_s * rng.uniform(0.2, 1.0)), led)
        pace = float(np.clip(habits.tempo * np.exp(habits.tempo_error * rng.normal()), 0.5, 2.0))
        n = max(round((b - a) / pace), 1)
        plan.add(n, led, _uneven(a, b, n, habits.tempo_error, rng), trunk=True)
        held = led if again else _afterwards(plan, led, meant, paths, (a, b), habits, rng)
        played[led] += 1
    if again:
        held = _once_more(plan, held, meant & (played < 0.5 * len(pieces)), paths, habits, rng)
    plan.add(_samples(0.25 * min(habits.reach_in_s, 1.0)), held)  # the fingers open
    plan.add(_samples(habits.reach_in_s * rng.uniform(0.3, 0.6)), [])
    return np.concatenate(plan.clock), np.concatenate(plan.held)


def _put(
    plan: Plan, paths: Floats, off: NDArray[np.bool_], habits: Habits, rng: np.random.Generator
) -> list[int]:
    """Put the limbs where the clip begins, as many at a time as the hands can hold; returns who is held then."""
    rest = -REACH[:, None] * np.array([0.0, 1.0, 0.0])
    value = np.where(off, np.linalg.norm(paths[0] - rest, axis=-1), 0.0)
    held: list[int] = []
    while value.any():
        if held:
            plan.add(_samples(habits.regrip_s * rng.uniform(0.7, 1.3)), [])
        held = lead(paths[:1] + ROOTS, value, habits)
        plan.add(_samples(JOIN_S * rng.uniform(1.0, 1.6)), held)
        value[held] = 0.0
    return held


def _once_more(
    plan: Plan,
    held: list[int],
    waiting: NDArray[np.bool_],
    paths: Floats,
    habits: Habits,
    rng: np.random.Generator,
) -> list[int]:
    """The whole clip a second time with the limbs that waited through most of it; returns who is held at the end."""
    last = len(paths) - 1
    travel = np.linalg.norm(paths - paths[:1], axis=-1).max(axis=0) / REACH
    value = np.where(waiting & (travel > habits.care), travel, 0.0)
    if not value.any() or last == 0:
        return held
    led = lead(paths + ROOTS, value, habits)
    n = _samples(habits.regrip_s * rng.uniform(1.4, 2.6))
    plan.add(n, [], np.linspace(last, 0, n), trunk=True)
    plan.at[led] = 0.0
    n = max(round(last / float(np.clip(habits.tempo, 0.5, 2.0))), 1)
    plan.add(n, led, _uneven(0, last, n, habits.tempo_error, rng), trunk=True)
    return led


def _afterwards(
    plan: Plan,
    led: list[int],
    meant: NDArray[np.bool_],
    paths: Floats,
    phrase: tuple[int, int],
    habits: Habits,
    rng: np.random.Generator,
) -> list[int]:
    """Move the limbs that had to wait, or leave them; returns who is held at the end.

    A limb that travelled in the phrase plays it now, up to twice as fast; one that is only in the wrong
    place is put where it belongs.
    """
    a, b = phrase
    travel = np.linalg.norm(paths[a : b + 1] - paths[a], axis=-1).max(axis=0) / REACH
    reached = paths[plan.at[:4].astype(np.intp), np.arange(4)]
    off = np.linalg.norm(paths[b] - reached, axis=-1) / REACH
    missed = np.maximum(travel, off)
    late = [k for k in range(4) if meant[k] and k not in led and missed[k] > habits.care]
    late = [k for k in late if off[k] > _GLARING or rng.random() < habits.patience]
    held = led
    while late:
        value = np.zeros(4)
        value[late] = missed[late]
        held = lead(paths[a : b + 1] + ROOTS, value, habits)
        plan.add(_samples(habits.regrip_s * rng.uniform(0.7, 1.3)), [])
        n = max(round((b - a) / min(2.0, 1.5 * habits.tempo)), _samples(JOIN_S))
        again = max(travel[k] for k in held) > habits.care
        plan.add(n, held, _uneven(a, b, n, habits.tempo_error, rng) if again else np.full(n, float(b)))
        late = [k for k in late if k not in held]
    return held
