"""A score: where pelvis, trunk, head, hands and feet are at which time, as a choreographer writes it down.

Between two keys every track makes a minimum-jerk pass (Flash and Hogan 1985); a key that is passed
`through` keeps the speed of its neighbourhood. A hand's key may lie in the frame of its own shoulder, the
head, a knee or the hip, or stand still in the world; on its way between keys of different frames it follows
both, so that a hand finds the mouth of a head that nods.
"""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from miburi.perform.bodies.people import Person

SIDES = ("l", "r")
GRAVITY = 9.81
Vector = tuple[float, ...]
_OWN_WAY = 0.6  # of the times that there are several ways


class Key(NamedTuple):
    """A value that a track has at a time.

    `arc` bends the way to it: metres, in the frame of the trunk. A key that is passed `through` and `even` lies on
    a smooth curve of several; `speed` and `bend` (acceleration) are given where physics knows them.
    """

    t: float
    value: Vector
    frame: str = "world"
    through: bool = False
    arc: Vector = (0.0, 0.0, 0.0)
    even: bool = False
    speed: Vector | None = None
    bend: Vector | None = None


class Flight(NamedTuple):
    """The body is in the air from one time to another, seconds; `turn` and `pelvis` have keys at both."""

    start: float
    end: float


REST: dict[str, Vector] = {
    "turn": (0.0, 0.0, 0.0),  # pelvis: yaw, pitch, roll, degrees (yaw against the heading)
    "trunk": (0.0, 0.0, 0.0),  # chest against pelvis: pitch, roll, twist
    "head": (0.0, 0.0, 0.0),  # head against chest: pitch, roll, yaw
    "spin": (0.0,),  # pelvis about its own long axis, to the left
    "ankle": (0.0, 0.0),  # how far the foot follows its shank rather than the ground; sole against the shank
    "palm": (0.0, 0.0),  # how far the hand lies flat on the floor; where its fingers point, degrees
    "swivel": (0.0,),  # elbow about the line from shoulder to wrist, outwards
    "wrist": (0.0, 0.0, 0.0),  # flexion, towards the thumb, roll
}


@dataclass
class Score:
    """What one performer does in one take, in the order of time.

    `now` is the time reached; `x`, `z` and `heading` (degrees, to the left) are where the performer's own
    frame stands (x to the left, y up, z ahead), `floor` the height under the feet; `hand` is
    the side that acts where either could.
    """

    who: Person
    rng: np.random.Generator
    now: float = 0.0
    x: float = 0.0
    z: float = 0.0
    heading: float = 0.0
    floor: float = 0.0
    hand: str = "r"
    tracks: dict[str, list[Key]] = field(default_factory=dict)
    home_feet: dict[str, Vector] = field(default_factory=dict)
    air: dict[str, list[tuple[float, float]]] = field(default_factory=lambda: {"l": [], "r": []})
    flights: list[Flight] = field(default_factory=list)
    revolved: list[float] = field(default_factory=lambda: [0.0, 0.0])  # pitch and roll of somersaults so far

    def __post_init__(self) -> None:
        who = self.who
        self.tracks["pelvis"] = [Key(0.0, self.world(0.0, who.standing, 0.25 * who.ball_ahead))]
        self.tracks["turn"] = [Key(0.0, (self.heading, self.rest_pitch, 0.0))]
        self.tracks["spin"] = [Key(0.0, (0.0,))]
        self.tracks["trunk"] = [Key(0.0, self.trunk_rest)]
        self.tracks["head"] = [Key(0.0, self.head_rest)]
        for side in SIDES:
            self.tracks[f"{side}_hand"] = [Key(0.0, self.hand_rest, "arm")]
            self.tracks[f"{side}_swivel"] = [Key(0.0, (0.0,))]
            self.tracks[f"{side}_palm"] = [Key(0.0, (0.0, self.heading))]
            self.tracks[f"{side}_wrist"] = [Key(0.0, (8.0, 0.0, 0.0))]
            self.tracks[f"{side}_foot"] = [Key(0.0, self.world(*self.stance(side)))]
            self.tracks[f"{side}_sole"] = [Key(0.0, (self.heading + self.out(side) * who.toe_out, 0.0))]
            self.tracks[f"{side}_lift"] = [Key(0.0, (0.0,))]
            self.tracks[f"{side}_ankle"] = [Key(0.0, (0.0, 0.0))]

    # --- the performer's own frame -------------------------------------------------------------------

    @property
    def rest_pitch(self) -> float:
        """The pelvis's pitch when standing, degrees."""
        return 0.3 * self.who.stoop

    @property
    def trunk_rest(self) -> Vector:
        """The trunk when standing."""
        return (0.9 * self.who.stoop, 0.0, 0.0)

    @property
    def head_rest(self) -> Vector:
        """The head when standing looks ahead."""
        return (3.0 - 1.0 * self.who.stoop, 0.0, 0.0)

    @property
    def hand_rest(self) -> Vector:
        """A hanging hand (outwards, up, ahead of its shoulder, in arm lengths)."""
        return (0.08 + self.who.carry, -0.985 + 0.25 * self.who.carry, 0.09)

    @staticmethod
    def out(side: str) -> float:
        """+1 to the left, −1 to the right: the sign of outwards."""
        return 1.0 if side == "l" else -1.0

    def other(self, side: str) -> str:
        """The other side."""
        return "r" if side == "l" else "l"

    def stance(self, side: str, wide: float = 1.0, ahead: float = 0.0) -> Vector:
        """Where the ball of a foot stands at ease: left, up, ahead, metres."""
        half = 0.055 * self.who.height * self.who.stance * wide
        return (self.out(side) * half, 0.0, self.who.ball_ahead + ahead)

    def world(self, left: float, up: float, ahead: float) -> Vector:
        """A place of the performer's own frame in the world."""
        c, s = math.cos(math.radians(self.heading)), math.sin(math.radians(self.heading))
        return (self.x + c * left + s * ahead, self.floor + up, self.z - s * left + c * ahead)

    def local(self, place: Vector) -> Vector:
        """A place of the world in the performer's own frame."""
        c, s = math.cos(math.radians(self.heading)), math.sin(math.radians(self.heading))
        dx, dz = place[0] - self.x, place[2] - self.z
        return (c * dx - s * dz, place[1] - self.floor, s * dx + c * dz)

    def settle(self) -> None:
        """Put the own frame under the feet as they stand now, facing between them."""
        left, right = self.tracks["l_foot"][-1].value, self.tracks["r_foot"][-1].value
        self.floor = min(left[1], right[1])
        yaws = [self.tracks[f"{s}_sole"][-1].value[0] - self.out(s) * self.who.toe_out for s in SIDES]
        self.heading = float(np.mean(yaws))
        self.x = self.z = 0.0
        middle = self.local(tuple(np.mean([left, right], axis=0).tolist()))
        self.x, _, self.z = (
            a - b
            for a, b in zip(
                self.world(middle[0], 0.0, middle[2]), self.world(0.0, 0.0, self.who.ball_ahead), strict=True
            )
        )

    # --- writing ------------------------------------------------------------------------------------

    def beat(self, seconds: float, spread: float = 0.08) -> float:
        """A duration at the performer's tempo, never twice the same."""
        return seconds / self.who.tempo * math.exp(self.rng.normal(0.0, spread))

    def vary(self, value: float, spread: float) -> float:
        """A figure, never twice the same."""
        return value + float(self.rng.normal(0.0, spread))

    def way(self, what: str, *ways: str) -> str:
        """One of several ways of doing something: mostly the performer's own, which depends on their name."""
        own = int.from_bytes(hashlib.sha256(f"{self.who.name}/{what}".encode()).digest()[:4], "big")
        pick = own if self.rng.random() < _OWN_WAY else int(self.rng.integers(2**31))
        return ways[pick % len(ways)]

    def last(self, track: str) -> Key:
        """A track's last key."""
        return self.tracks[track][-1]

    def move(
        self,
        track: str,
        start: float,
        end: float,
        value: Vector,
        frame: str = "world",
        *,
        through: bool = False,
        arc: Vector = (0.0, 0.0, 0.0),
        exact: bool = False,
        even: bool = False,
    ) -> None:
        """Go to a value between two times; until then the track stays where it is.

        Unless it is `exact`, upper limbs and trunk begin and end a little early or late, and hands arrive a
        little off.
        """
        free = track in ("trunk", "head") or track.endswith(("_hand", "_swivel", "_wrist"))
        span = end - start
        if free and not exact:
            start += float(np.clip(self.rng.normal(0.0, 0.04), -0.09, 0.09)) * span
            end += float(np.clip(self.rng.normal(0.0, 0.05), -0.12, 0.12)) * span
            if track.endswith("_hand"):
                spread = 0.025 if frame == "arm" else 0.008
                value = tuple(v + float(self.rng.normal(0.0, spread)) for v in value)
        keys = self.tracks[track]
        before = keys[-1]
        if before.t < start and not (before.through and start - before.t < 1e-6):
            rest = before._replace(through=False, speed=None, bend=None)
            keys[-1] = before if before.speed is not None else rest
            keys.append(rest._replace(t=start, arc=(0.0, 0.0, 0.0)))
        # who is late starts late, and does not hurry much
        end = max(end, keys[-1].t + (1.0 if exact else 0.8) * span)
        keys.append(Key(end, value, frame, through, arc, even))

    def turn(
        self,
        start: float,
        end: float,
        yaw: float,
        pitch: float,
        roll: float,
        *,
        through: bool = False,
        even: bool = False,
    ) -> None:
        """Turn the pelvis: degrees against the heading; pitch on top of the posture's own."""
        pitch += self.rest_pitch + self.revolved[0]
        self.move(
            "turn",
            start,
            end,
            (self.heading + yaw, pitch, roll + self.revolved[1]),
            through=through,
            even=even,
        )

    def trunk(
        self,
        start: float,
        end: float,
        pitch: float,
        roll: float = 0.0,
        twist: float = 0.0,
        *,
        through: bool = False,
    ) -> None:
        """Bend and twist the trunk: degrees on top of the posture's own."""
        self.move("trunk", start, end, (self.trunk_rest[0] + pitch, roll, twist), through=through)

    def look(self, start: float, end: float, pitch: float = 0.0, yaw: float = 0.0, roll: float = 0.0) -> None:
        """Turn the head against the chest: degrees on top of the posture's own."""
        self.move("head", start, end, (self.head_rest[0] + pitch, roll, yaw))

    def pelvis(
        self,
        start: float,
        end: float,
        left: float,
        rise: float,
        ahead: float,
        *,
        through: bool = False,
        even: bool = False,
    ) -> None:
        """Move the root: metres, against where it is when the performer stands at ease."""
        who = self.who
        place = self.world(left, who.standing + rise, 0.25 * who.ball_ahead + ahead)
        self.move("pelvis", start, end, place, through=through, even=even)

    def fly(self, end: float, place: Vector, yaw: float, pitch: float, roll: float) -> None:
        """Leave the ground now, where the tracks of the pelvis and its turn have their last keys, and come down.

        Parameters
        ----------
        place
            Where the root is then, in the world, metres.
        yaw, pitch, roll
            As in `turn`.
        """
        start = self.last("pelvis").t
        span = end - start
        whole, gravity = self.last("pelvis"), (0.0, -GRAVITY, 0.0)
        even = [(b - a) / span for a, b in zip(whole.value, place, strict=True)]
        up, down = ((even[0], even[1] + sign * 0.5 * GRAVITY * span, even[2]) for sign in (1.0, -1.0))
        self.tracks["pelvis"][-1] = whole._replace(speed=up, bend=gravity)
        self.tracks["pelvis"].append(Key(end, place, speed=down, bend=gravity))
        was = self.last("turn")
        if was.t < start:
            self.tracks["turn"].append(was._replace(t=start))
        was = self.last("turn")
        turned = (self.heading + yaw, pitch + self.rest_pitch + self.revolved[0], roll + self.revolved[1])
        rate = tuple((b - a) / span for a, b in zip(was.value, turned, strict=True))
        self.tracks["turn"][-1] = was._replace(t=start, speed=rate)
        self.tracks["turn"].append(Key(end, turned, speed=rate))
        self.flights.append(Flight(start, end))

    def reach(
        self,
        side: str,
        start: float,
        end: float,
        value: Vector,
        frame: str = "arm",
        *,
        through: bool = False,
        arc: float | None = None,
        exact: bool = False,
    ) -> None:
        """Bring a hand to a place; by itself it swings a little outwards and forwards on a long way.

        Frames: "arm" (outwards, up, ahead of its own shoulder, arm lengths), "head", "hip", "knee" (outwards,
        up, ahead of the head's, own hip's or own knee's joint, metres for a height of 1.75 m), "stage" (left,
        up, ahead in the performer's own frame now, metres).
        """
        if frame == "stage":
            value, frame = self.world(value[0], value[1], value[2]), "world"
        before = self.last(f"{side}_hand")
        if arc is None:
            far = math.dist(before.value, value) if before.frame == frame == "arm" else 0.8
            arc = 0.0 if through or before.through else 0.07 * min(far, 1.0) if frame != "world" else 0.0
        bulge = (0.4 * arc, 0.0, arc)
        self.move(f"{side}_hand", start, end, value, frame, through=through, arc=bulge, exact=exact)

    def relax(self, start: float, end: float, sides: str = "lr") -> None:
        """Let hands sink to the sides."""
        for side in sides:
            late = float(self.rng.uniform(0.0, 0.12)) * (end - start)
            self.reach(side, start + late, end + late, self.hand_rest, arc=0.05)
            self.move(f"{side}_swivel", start, end, (0.0,))
            self.move(f"{side}_wrist", start, end, (8.0, 0.0, 0.0))

    def rise(self, start: float, end: float) -> None:
        """Pelvis, trunk and head as when standing at ease."""
        self.pelvis(start, end, 0.0, 0.0, 0.0)
        self.turn(start, end, 0.0, 0.0, 0.0)
        self.trunk(start, end, 0.0)
        self.look(start, end)
