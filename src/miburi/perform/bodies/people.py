"""Simulated performers: their proportions and their manner."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from miburi import store
from miburi.motion import Floats, Skeleton

JOINTS = (
    "Hips", "Spine", "Spine1", "Spine2", "Neck", "Head",
    "LeftShoulder", "LeftArm", "LeftForeArm", "LeftHand",
    "RightShoulder", "RightArm", "RightForeArm", "RightHand",
    "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase",
    "RightUpLeg", "RightLeg", "RightFoot", "RightToeBase",
)  # fmt: skip
"""Names of MotionBuilder's convention."""

PARENTS = (-1, 0, 1, 2, 3, 4, 3, 6, 7, 8, 3, 10, 11, 12, 0, 14, 15, 16, 0, 18, 19, 20)

# Drillis and Contini (1966) give each length as a share of the body's height.
_SPINE = (0.04, 0.075, 0.075, 0.085, 0.05)  # hips to spine … neck to head
_HEAD = 0.115
_HIP_DROP = 0.03
_ARM, _FOREARM, HAND = 0.186, 0.146, 0.108
_THIGH, _SHANK = 0.245, 0.246
ANKLE = 0.039
BALL = 0.009  # height of the toe joint
_HEEL_BACK, _BALL_AHEAD, _TOE = 0.037, 0.075, 0.04


class Person(NamedTuple):
    """A performer. Lengths in metres, angles in degrees.

    `girth` is the trunk's against an average one; `age` in years has already had its effect on the rest.
    `tempo` multiplies speeds, `size` amplitudes; `stoop` bends the trunk forward, `carry` holds the elbows
    away, `sway` and `tremor` scale slow and fast unrest.
    """

    name: str
    height: float
    legs: float
    arms: float
    shoulders: float
    hips: float
    tempo: float
    size: float
    left_handed: bool
    stance: float
    toe_out: float
    stoop: float
    carry: float
    sway: float
    tremor: float
    step: float
    girth: float
    age: float

    @property
    def thigh(self) -> float:
        """Hip to knee."""
        return _THIGH * self.height * self.legs

    @property
    def shank(self) -> float:
        """Knee to ankle."""
        return _SHANK * self.height * self.legs

    @property
    def upper_arm(self) -> float:
        """Shoulder to elbow."""
        return _ARM * self.height * self.arms

    @property
    def forearm(self) -> float:
        """Elbow to wrist."""
        return _FOREARM * self.height * self.arms

    @property
    def arm(self) -> float:
        """Shoulder to wrist."""
        return self.upper_arm + self.forearm

    @property
    def hip_drop(self) -> float:
        """How far the hip joints lie below the root."""
        return _HIP_DROP * self.height

    @property
    def ball_ahead(self) -> float:
        """Ankle to toe joint, along the sole."""
        return _BALL_AHEAD * self.height

    @property
    def heel_back(self) -> float:
        """Ankle to heel, along the sole."""
        return _HEEL_BACK * self.height

    @property
    def standing(self) -> float:
        """Height of the root when standing at ease."""
        return ANKLE * self.height + 0.99 * (self.thigh + self.shank) + self.hip_drop


class Role(NamedTuple):
    """What is fixed of a performer of the corpus: metres, share of an average trunk, years, liveliness."""

    height: float
    girth: float
    age: float
    lively: float


CAST: dict[str, Role] = {
    "ash": Role(1.85, 1.0, 24.0, 1.08),  # tall, quick
    "birch": Role(1.62, 1.08, 71.0, 0.92),  # old, stooped, careful
    "cedar": Role(1.50, 0.9, 13.0, 1.12),  # a child
    "elm": Role(1.76, 1.28, 46.0, 0.95),  # heavy
    "fir": Role(1.69, 0.92, 27.0, 1.0),  # trained, upright
    "holly": Role(1.60, 0.95, 34.0, 1.04),
    "rowan": Role(1.78, 1.02, 38.0, 0.98),
    "yew": Role(1.91, 1.12, 58.0, 0.9),  # tall, slow
}
"""Simulated performers of different build, age and manner."""


def person(name: str, seed: int = 0) -> Person:
    """A performer, drawn once from a name: the same name and seed is the same person.

    Who has no role in `CAST` is a grown-up of any build.
    """
    rng = store.seed(seed, "everyday", "performer", name)
    height = float(rng.uniform(1.54, 1.92))
    role = CAST.get(name) or Role(height, float(rng.uniform(0.92, 1.15)), float(rng.uniform(20.0, 60.0)), 1.0)
    old = max(0.0, role.age - 35.0) / 35.0
    return Person(
        name=name,
        height=role.height,
        legs=float(rng.normal(1.0, 0.025)),
        arms=float(rng.normal(1.0, 0.025)),
        shoulders=float(rng.normal(1.0, 0.05)) * (0.75 + 0.25 * role.girth),
        hips=float(rng.normal(1.0, 0.06)) * (0.6 + 0.4 * role.girth),
        tempo=float(np.exp(rng.normal(0.0, 0.09) - 0.17 * old)) * role.lively,
        size=float(np.exp(rng.normal(0.0, 0.08) - 0.12 * old)) * role.lively**0.5,
        left_handed=bool(rng.random() < 0.2),
        stance=float(rng.uniform(0.8, 1.35)),
        toe_out=float(rng.uniform(4.0, 16.0)),
        stoop=float(rng.normal(2.0, 3.0)) + 7.0 * old,
        carry=float(rng.uniform(0.0, 0.07)) + 0.12 * max(0.0, role.girth - 1.0),
        sway=float(np.exp(rng.normal(0.0, 0.25) + 0.25 * old)),
        tremor=float(np.exp(rng.normal(0.0, 0.25) + 0.4 * old)),
        step=float(np.exp(rng.normal(0.0, 0.08) - 0.15 * old)),
        girth=role.girth,
        age=role.age,
    )


def skeleton(who: Person) -> Skeleton:
    """A performer's skeleton: legs and trunk along Y, arms stretched to the sides, metres."""
    h = who.height
    rows: dict[str, tuple[float, float, float]] = {
        "Hips": (0, 0, 0),
        **{j: (0, s * h, 0) for j, s in zip(JOINTS[1:6], _SPINE, strict=True)},
    }
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        rows |= {
            f"{side}Shoulder": (sign * 0.02 * h, 0.062 * h, 0.004 * h),
            f"{side}Arm": (sign * 0.088 * h * who.shoulders, 0.006 * h, -0.004 * h),
            f"{side}ForeArm": (sign * who.upper_arm, 0, 0),
            f"{side}Hand": (sign * who.forearm, 0, 0),
            f"{side}UpLeg": (sign * 0.052 * h * who.hips, -who.hip_drop, 0),
            f"{side}Leg": (0, -who.thigh, 0),
            f"{side}Foot": (0, -who.shank, 0),
            f"{side}ToeBase": (0, -(ANKLE - BALL) * h, who.ball_ahead),
        }
    ends: dict[str, tuple[float, float, float]] = {"Head": (0, _HEAD * h, 0)}
    for side, sign in (("Left", 1.0), ("Right", -1.0)):
        ends |= {
            f"{side}Hand": (sign * HAND * h * who.arms, 0, 0),
            f"{side}ToeBase": (0, -0.5 * BALL * h, _TOE * h),
        }
    return Skeleton(
        JOINTS,
        np.array(PARENTS),
        np.array([rows[j] for j in JOINTS]),
        who.name,
        np.array([JOINTS.index(j) for j in ends]),
        np.array(list(ends.values())),
    )


def tip(who: Person) -> tuple[float, float, float]:
    """Where the tip of the toes is in the foot's frame, toes straight, metres."""
    return (0.0, -(ANKLE - 0.5 * BALL) * who.height, who.ball_ahead + _TOE * who.height)


def shoulder(who: Person) -> Floats:
    """The left shoulder's place in the frame of the uppermost spine joint, collar bone at rest, metres."""
    s = skeleton(who)
    place: Floats = s.offsets[JOINTS.index("LeftShoulder")] + s.offsets[JOINTS.index("LeftArm")]
    return place
