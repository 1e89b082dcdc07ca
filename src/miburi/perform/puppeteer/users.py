"""Who plays the puppet: users, their skill and their habits.

Each figure stands beside the sentence of [P] that it models in docs/puppeteer.md. They were fixed from what [P]
says and from common knowledge of hands, before any query of theirs was ranked; the rules of `plan`, `imitation`
and `trunk` were mended after looking at plays of development users. No test user was looked at for either.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from miburi.errors import InputError
from miburi.store import seed

SPLITS = ("development", "test")
STYLES = ("hand", "stage", "strapped")

SKILL = (0.2, 0.8)
"""[P]'s users had no animation skills; none is a master (1) and none is hopeless (0)."""

TEMPO = (0.6, 1.6)
"""A person plays at a pace of their own; with `tempo_error` the pace stays between half and twice the
clip's."""


@dataclass(frozen=True)
class Habits:
    """How a user plays. Most of it zero is a perfect user (`perfect`).

    Lengths are metres on a puppet of 0.33 m, angles are degrees.
    """

    # "Users can move only two limbs at once"; one hand holds the trunk or both are free.
    grips: int
    """Free hands. A hand holds one limb, or both hands or both feet of the puppet while they are close
    together."""
    limbs: int
    """Most limbs that move at once."""
    patience: float
    """Chance that a limb that had to wait is moved afterwards, not left."""
    second_pass: float
    """Chance that limbs that had to wait are not moved after each phrase but play the whole clip in a second
    pass, with the trunk brought back to the beginning."""
    ignore: float
    """A limb that moves less than this share of what the busiest limb does is judged unimportant and left
    still."""
    care: float
    """A limb is moved afterwards only if it missed more than this share of its reach."""
    regrip_s: float
    """Seconds to let go of one limb and to take another."""

    # "Users follow the paths of the hands and feet, not the joint angles", on a body of other proportions.
    landmark: float
    """0: hands are put where they are from the shoulder, by the arm's reach; 1: where they are by the
    trunk."""
    elbow: float
    """How much the place of elbow and knee counts beside that of hand and foot."""

    # "Joint angles differ much", "complex motions are hard": paths differ in size, direction and place.
    amplitude: float
    """This user's bias: logarithm of the size of all paths."""
    amplitude_error: float
    """Spread of the logarithm of the size of a path, one draw for each limb and query."""
    direction_error: float
    """Degrees by which a path is turned."""
    placement_error: float
    """Shares of the reach by which a path is shifted."""
    straight: float
    """A limb's stop is felt: an error of the distance from shoulder or hip counts in full where the limb is bent
    by 60° or more, and by this share where it is straight."""
    complexity: float
    """By how much these three errors grow with each important limb beyond two."""
    blur_s: float
    """Quick detail is lost: the width, in seconds, of the window that smooths the clip."""
    wander: float
    """Slow error of a hand that moves without a guide."""
    tremor: float
    """Physiological tremor, 8 to 12 Hz."""

    # Everybody plays at their own pace.
    tempo: float
    """Clip seconds per second."""
    tempo_error: float
    """Spread of the logarithm of the pace from phrase to phrase, and how uneven it is within one."""
    pause: float
    """Chance of a pause between two phrases."""
    pause_s: float
    """Longest pause."""
    arrange: float
    """Chance that the limbs are put into the clip's first pose before the log begins, not in it."""
    reach_in_s: float
    """Seconds until the hands are on the limbs, and as many after they let go."""
    knock: float
    """How far a limb is pushed when a hand takes or leaves it."""

    # "Physics does not bind the puppet: the user carries it"; "little control of the trunk" on a stage.
    trunk_gain: float
    """Share of the trunk's turning that is played."""
    trunk_limit: float
    """Degrees by which the trunk can be tilted."""
    tilt: float
    """How crooked the trunk is held."""
    drift: float
    """How far the trunk's tilt wanders while it is carried."""
    shake: float
    """Tremor of the hand, or of the body, that carries the trunk."""

    # "Friction holds a pose when it is let go": a property of the puppet.
    stick: float
    """A joint at rest moves when it is pushed by more than this."""
    mess: float
    """How crooked limbs hang that nobody has put anywhere."""


def perfect() -> Habits:
    """Habits of a user who errs in nothing and has a hand for every limb: a yardstick, never a query's
    user."""
    zeros = dict.fromkeys(set(Habits.__dataclass_fields__) - {"grips", "limbs"}, 0.0)
    whole = {
        "elbow": 0.3,
        "tempo": 1.0,
        "straight": 1.0,
        "arrange": 1.0,
        "trunk_gain": 1.0,
        "trunk_limit": 180.0,
    }
    return Habits(grips=4, limbs=4, **(zeros | whole))


# What the three ways of holding the puppet allow. On the hand: the trunk goes where it is carried, one hand
# is left. On a stage: two hands for the limbs, the stand turns and tilts a little. Strapped to the own
# chest: the trunk does what the user's does who must stay on their feet; both hands are free, working half
# blind below the chin.
_GRIPS = {"hand": 1, "stage": 2, "strapped": 2}
_TRUNK_GAIN = {"hand": (1.0, 1.0), "stage": (0.1, 0.4), "strapped": (0.7, 1.0)}
_HOLDING = {
    "hand": {"trunk_limit": 180.0, "tilt": 6.0, "drift": 6.0, "shake": 0.4},
    "stage": {"trunk_limit": 20.0, "tilt": 2.0, "drift": 0.5, "shake": 0.0},
    "strapped": {"trunk_limit": 60.0, "tilt": 6.0, "drift": 3.0, "shake": 0.3},
}
_STRAPPED_CLUMSINESS = 1.3

# What skill changes: the figure of the least skilled and of the most skilled.
_BY_SKILL = {
    "patience": (0.2, 0.8),
    "ignore": (0.5, 0.2),
    "care": (0.3, 0.12),
    "regrip_s": (0.6, 0.3),
    "elbow": (0.05, 0.3),
    "amplitude_error": (0.4, 0.12),  # "amplitude errors of tens of per cent"
    "direction_error": (25.0, 8.0),
    "placement_error": (0.15, 0.04),
    "blur_s": (0.15, 0.05),
    "wander": (0.008, 0.003),
    "tremor": (0.0012, 0.0006),
    "tempo_error": (0.3, 0.12),
    "arrange": (0.4, 0.9),
    "pause": (0.5, 0.15),
    "pause_s": (0.9, 0.4),
    "reach_in_s": (0.9, 0.5),
    "knock": (0.012, 0.005),
    "mess": (8.0, 4.0),
}
_COMPLEXITY = 0.2
_STICK = 2.5
_LANDMARK = 0.6
_SECOND_PASS = 0.4
_STRAIGHT = 0.25
_AMPLITUDE = 0.15


@dataclass(frozen=True)
class User:
    """A simulated user.

    Parameters
    ----------
    name
        Names experiment, split and number.
    split
        "development": settings may be chosen with them; "test": looked at once.
    style
        How the puppet is held: "hand", "stage" or "strapped".
    skill
        0 to 1.
    habits
        Drawn once.
    """

    name: str
    split: str
    style: str
    skill: float
    habits: Habits


def habits(style: str, skill: float, rng: np.random.Generator) -> Habits:
    """The habits of a user who holds the puppet in this way and has this skill.

    The draws do not depend on style and skill, so that the same generator gives the same person at another
    skill.
    """
    gain = _TRUNK_GAIN[style]
    u = rng.random(4)
    bias = float(np.clip(rng.normal(), -2.0, 2.0))
    settings = {k: a + (b - a) * skill for k, (a, b) in _BY_SKILL.items()} | _HOLDING[style]
    if style == "strapped":
        for key in ("direction_error", "placement_error", "wander"):
            settings[key] *= _STRAPPED_CLUMSINESS
    for key in ("tilt", "drift"):
        settings[key] *= 1.5 - skill
    return Habits(
        grips=_GRIPS[style],
        limbs=2,
        landmark=_LANDMARK * float(u[0]),
        amplitude=_AMPLITUDE * bias,
        second_pass=_SECOND_PASS * float(u[3]),
        straight=_STRAIGHT,
        complexity=_COMPLEXITY,
        tempo=float(TEMPO[0] * (TEMPO[1] / TEMPO[0]) ** u[1]),
        trunk_gain=float(gain[0] + (gain[1] - gain[0]) * u[2]),
        stick=_STICK,
        **settings,
    )


def users(experiment: str, split: str, n: int, config_seed: object = 0) -> list[User]:
    """The users of an experiment.

    Parameters
    ----------
    experiment
        The experiment's name: another experiment has other users.
    split
        "development" or "test". The split is part of each name and of what each user is drawn from, so no
        user is in both.
    n
        How many; the three styles take turns.
    config_seed
        Seed of the run.

    Returns
    -------
    list of User
        The first users of a longer list are those of a shorter one.

    Raises
    ------
    InputError
        There is no such split.
    """
    if split not in SPLITS:
        raise InputError(
            f"split {split!r} of the users of {experiment!r}: expected one of {', '.join(SPLITS)}"
        )
    found = []
    turn = int(seed(config_seed, "puppeteer", experiment, split).integers(len(STYLES)))
    for k in range(n):
        name = f"{experiment}-{split}-{k + 1}"
        rng = seed(config_seed, "puppeteer", "user", name)
        style = STYLES[(turn + k) % len(STYLES)]
        skill = float(rng.uniform(*SKILL))
        found.append(User(name, split, style, skill, habits(style, skill, rng)))
    return found
