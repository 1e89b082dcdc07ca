"""What acrobatics, falls and strokes are composed of: single limbs, the root, jumping off and landing."""

from __future__ import annotations

import math

import numpy as np
from scipy.spatial.transform import Rotation

from miburi.perform.bodies.score import SIDES, Score, Vector

WRIST = 0.035  # height of the wrist of a hand that is flat on the floor, metres for a height of 1.75 m
_OPEN = 1e9
_LOOSENED = 0.13  # seconds in which a foot goes from the ground's to its shank's direction


# --- limbs ----------------------------------------------------------------------------------------------


def lift(b: Score, side: str, t: float) -> None:
    """A foot leaves the ground, until `plant`."""
    b.air[side].append((t, _OPEN))


def leg(
    b: Score,
    side: str,
    start: float,
    end: float,
    place: Vector,
    flex: float = 35.0,
    *,
    through: bool = False,
) -> None:
    """Bring a foot that is in the air to a place of its hip's frame (outwards, up, ahead; metres for 1.75 m)."""
    b.move(f"{side}_foot", start, end, place, "hip", through=through)
    ankle, loose = f"{side}_ankle", b.last(f"{side}_ankle").value
    if (
        loose[0] < 1.0
    ):  # soon after the foot has left the ground, as long as shank and ground still agree on it
        first = min(_LOOSENED, 0.7 * (end - start))
        b.move(ankle, start, start + first, (1.0, 0.5 * (loose[1] + flex) if loose[1] else flex))
        start += first
    b.move(ankle, start, end, (1.0, flex))


def legs(
    b: Score, start: float, end: float, place: Vector, flex: float = 35.0, *, through: bool = False
) -> None:
    """Both feet."""
    for side in SIDES:
        leg(b, side, start, end, place, flex, through=through)


def plant(
    b: Score, side: str, start: float, end: float, place: Vector, yaw: float, *, tip: float = 12.0
) -> None:
    """Put a foot on the ground: its ball at a place of the world, the sole at first a little on tiptoe."""
    b.move(f"{side}_foot", start, end, place)
    loose, flex = b.last(f"{side}_ankle").value
    b.move(f"{side}_ankle", max(start, end - _LOOSENED), end, (0.0, flex))
    sole = f"{side}_sole"
    if loose == 1.0:  # unseen while the foot follows its shank
        b.move(sole, start, start + 1e-4, (yaw, tip))
    else:
        b.move(sole, start, end, (yaw, tip))
    b.move(sole, end, end + 0.12, (yaw, 0.0))
    opened = b.air[side].pop()[0]
    b.air[side].append((opened, end))


def tiptoe(b: Score, start: float, end: float, pitch: float, sides: str = "lr", *, rate: float = 0.0) -> None:
    """Lift the heels by rolling over the balls; who jumps off still does at the end, degrees/s."""
    for side in sides:
        sole = f"{side}_sole"
        yaw = b.last(sole).value[0]
        b.move(sole, start, end, (yaw, pitch))
        if rate:
            b.tracks[sole][-1] = b.last(sole)._replace(speed=(0.0, rate))


def hands(
    b: Score, start: float, end: float, value: Vector, frame: str = "arm", *, sides: str = "lr"
) -> None:
    """Both hands to mirrored places, together; round the shoulder rather than through it."""
    for side in sides:
        sweep(b, side, start, end, value, frame)


def sweep(b: Score, side: str, start: float, end: float, value: Vector, frame: str = "arm") -> None:
    """A hand to a place, round the shoulder rather than through it."""
    before = b.last(f"{side}_hand")
    if frame == before.frame == "arm":
        a, z = np.array(before.value), np.array(value)
        far, near = float(np.linalg.norm(a)), float(np.linalg.norm(z))
        if a @ z < 0.35 * far * near:
            way = a / far + z / near + (0.0, 0.0, 0.8 * max(0.0, -(a @ z) / (far * near)))
            middle = 0.5 * (far + near) * way / np.linalg.norm(way)
            half = max(before.t, start) * 0.5 + 0.5 * end
            b.move(
                f"{side}_hand",
                start,
                half,
                tuple(middle.tolist()),
                "arm",
                through=True,
                exact=True,
                even=True,
            )
            start = half
    b.reach(side, start, end, value, frame, arc=0.0, exact=True)


def palms(b: Score, side: str, start: float, end: float, left: float, ahead: float, yaw: float = 0.0) -> None:
    """Put a hand flat on the floor, in the performer's own frame; its fingers point to `yaw` degrees."""
    k = b.who.height / 1.75
    b.reach(side, start, end, (left, WRIST * k, ahead), "stage", arc=0.0, exact=True)
    fingers = b.heading + yaw
    palm = f"{side}_palm"
    b.tracks[palm][-1] = b.last(palm)._replace(value=(b.last(palm).value[0], fingers))
    b.move(palm, max(start, end - 0.25), end, (1.0, fingers))


def unpalm(b: Score, start: float, seconds: float = 0.25) -> None:
    """Hands leave the floor."""
    for side in SIDES:
        b.move(f"{side}_palm", start, start + seconds, (0.0, b.last(f"{side}_palm").value[1]))


def on_hands(
    b: Score,
    middle: Vector,
    turn: Vector,
    trunk: Vector = (0.0, 0.0, 0.0),
    far: float = 0.95,
    upright: float = 0.0,
) -> Vector:
    """Where the root is when straight arms carry: (left, up, ahead) in the performer's own frame, metres.

    Parameters
    ----------
    middle
        Between both wrists, in the same frame.
    turn
        Yaw, pitch and roll of the pelvis against the performer's own frame, degrees.
    trunk
        Pitch, roll, twist of the trunk.
    far
        Of an arm's length, from wrist to shoulder.
    upright
        From 0, arms in one line with the trunk, to 1, arms upright.
    """
    h = b.who.height
    hips = Rotation.from_euler("YXZ", turn, degrees=True)
    place, frame = np.zeros(3), hips
    for share, step in ((0.25, 0.04), (0.4, 0.075), (0.35, 0.075)):
        place = place + frame.apply([0.0, step * h, 0.0])
        frame = frame * Rotation.from_euler(
            "YXZ", [share * trunk[2], share * trunk[0], share * trunk[1]], True
        )
    shoulders = place + frame.apply([0.0, 0.098 * h, 0.0])
    rise = (1 - upright) * frame.apply([0.0, -1.0, 0.0]) + [0.0, upright, 0.0]
    rise /= np.linalg.norm(rise)
    root: Vector = tuple((np.array(middle) + far * b.who.arm * rise - shoulders).tolist())
    return root


def root(
    b: Score, start: float, end: float, place: Vector, *, through: bool = False, even: bool = True
) -> None:
    """Move the pelvis to a place of the performer's own frame, metres above the floor."""
    b.move("pelvis", start, end, b.world(*place), through=through, even=even)


def on_foot(b: Score, lean: float, rise: float = 0.0, ahead: float = 0.0) -> Vector:
    """Where the root is above feet at home, the whole body tilted ahead by degrees about the balls."""
    high = b.who.standing + rise
    a = math.radians(lean)
    return (0.0, high * math.cos(a), 0.25 * b.who.ball_ahead + high * math.sin(a) + ahead)


def crouch(
    b: Score, seconds: float, deep: float, back: float, *, arms: Vector = (0.15, -0.75, -0.45)
) -> None:
    """Bend hips and knees before a jump, arms back."""
    t, k = b.now, b.who.height / 1.75
    b.pelvis(t, t + seconds, 0.0, -deep * k, -back * k)
    b.turn(t, t + seconds, 0.0, 95.0 * deep, 0.0)
    b.trunk(t, t + seconds, 50.0 * deep)
    b.look(t, t + seconds, -60.0 * deep)
    hands(b, t, t + seconds, arms)
    b.now = t + seconds


def land(
    b: Score,
    t: float,
    deep: float = 0.26,
    *,
    arms: Vector = (0.15, -0.35, 0.75),
    pitch: float | None = None,
) -> None:
    """Give way after feet have come down at a time, and stand up.

    `pitch` is the pelvis's, degrees, when the landing has been taken up; absent: the deeper, the further ahead.
    """
    k, down, up = b.who.height / 1.75, b.vary(0.24, 0.01), b.beat(0.55)
    last = b.last("pelvis")
    if last.speed is not None:  # as deep as it takes to stop evenly
        high = b.local(last.value)[1] - b.who.standing
        deep = (0.47 * down * abs(last.speed[1]) - high) / k
    b.pelvis(t, t + down, 0.0, -deep * k, -0.12 * k)
    b.turn(t, t + 1.25 * down, 0.0, 80.0 * deep if pitch is None else pitch, 0.0)
    b.trunk(t, t + 1.25 * down, 45.0 * deep)
    b.look(t, t + down, -30.0)
    hands(b, t - 0.05, t + down + 0.2, arms)
    t += down + 0.04
    b.rise(t, t + up)
    b.relax(t + 0.2, t + 1.5 * up)
    b.now = t + up


def still(b: Score) -> None:
    """Wait until pelvis and feet have come to rest, so that all limbs begin together."""
    tracks = ("pelvis", "turn", "l_foot", "r_foot", "l_sole", "r_sole")
    b.now = max(b.now, *(b.last(track).t for track in tracks))


def under(b: Score, ahead: float) -> None:
    """Go on from a place further ahead."""
    b.x, _, b.z = b.world(0.0, 0.0, ahead)
