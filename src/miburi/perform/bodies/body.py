"""From a score to a moving skeleton: curves, then inverse kinematics of legs and arms, all frames at once."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.spatial.transform import Rotation
from scipy.special import expit

from miburi.kinematics import quaternions, unit
from miburi.motion import Floats, Motion
from miburi.perform.bodies import flight, people
from miburi.perform.bodies.curves import RATE, curve, framed, lower, unrest
from miburi.perform.bodies.people import Person
from miburi.perform.bodies.score import SIDES, Score

_OVER = 0.014  # of the body's height: what wrists keep from the floor
REACH = 0.995  # of a leg's length: knees are never locked
_J = {name: k for k, name in enumerate(people.JOINTS)}
_LONG = {"l": "Left", "r": "Right"}

# Where the elbow points for directions of the hand from the shoulder: (out, up, ahead) → (out, up, ahead).
_ELBOWS = (
    ((0.0, -1.0, 0.0), (0.2, 0.0, -1.0)),
    ((0.0, 0.0, 1.0), (0.5, -1.0, 0.0)),
    ((1.0, 0.0, 0.0), (0.0, -0.8, -0.6)),
    ((0.0, 1.0, 0.0), (1.0, 0.0, 0.5)),
    ((-1.0, 0.0, 0.4), (0.4, -1.0, 0.4)),
    ((0.2, 0.0, -1.0), (1.0, 0.3, 0.0)),
)


def _turn(order: str, *degrees: Floats) -> Floats:
    """Matrices (T, 3, 3) of intrinsic turns."""
    frames: Floats = _about(order[0], degrees[0])
    for axis, angle in zip(order[1:], degrees[1:], strict=True):
        frames = frames @ _about(axis, angle)
    return frames


def _about(axis: str, degrees: Floats) -> Floats:
    """Matrices (T, 3, 3) of turns about one axis."""
    angle = np.radians(degrees)
    c, s = np.cos(angle), np.sin(angle)
    i = "XYZ".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    frames = np.zeros((len(angle), 3, 3))
    frames[:, i, i] = 1.0
    frames[:, j, j] = frames[:, k, k] = c
    frames[:, k, j], frames[:, j, k] = s, -s
    return frames


def _apply(frames: Floats, vectors: Floats) -> Floats:
    """Vectors (T, 3) or (3,) of frames (T, 3, 3) in the world."""
    turned: Floats = np.einsum("tij,tj->ti", frames, np.broadcast_to(vectors, (len(frames), 3)))
    return turned


def _ahead(dip: Floats, seconds: float = 0.1) -> Floats:
    """At least as low as a dip (T,), and in time: the body sinks before its foot lands, not when it does."""
    reach = round(seconds * RATE)
    widest = maximum_filter1d(dip, 2 * reach + 1, mode="nearest")
    result: Floats = gaussian_filter1d(widest, 0.4 * reach, radius=reach, mode="nearest")
    return result


def _standing(air: list[tuple[float, float]], t: Floats, ramp: float = 0.09) -> Floats:
    """1 while a foot stands, 0 while it is in the air, smooth in between (T,)."""
    weight = np.ones_like(t)
    for start, end in air:
        edge = min(ramp, 0.35 * (end - start))
        u = np.clip(np.minimum(t - start, end - t) / edge, 0.0, 1.0)
        weight = np.minimum(weight, 1 - u**3 * (10 + u * (6 * u - 15)))
    return weight


def _soles(who: Person, yaw: Floats, pitch: Floats) -> tuple[Floats, Floats]:
    """The foot's frame (T, 3, 3) and the ankle's place (T, 3) against the ball's place on the ground.

    The heel is lifted about the ball, the toes about the heel, with a short rocker in between.
    """
    h = who.height
    frame = _turn("YX", yaw, pitch)
    u = np.clip((pitch + 5.0) / 10.0, 0.0, 1.0)
    rocker = -(who.ball_ahead + who.heel_back) * (1 - u * u * (3 - 2 * u))  # from the ball back to the heel
    level = _turn("Y", yaw)
    zero = np.zeros_like(rocker)
    pivot = np.stack([zero, people.BALL * h * u, rocker], axis=-1)
    ankle = np.stack([zero, people.ANKLE * h - pivot[:, 1], -who.ball_ahead - rocker], axis=-1)
    return frame, _apply(level, pivot) + _apply(frame, ankle)


def _bent(a: float, b: float, origin: Floats, target: Floats, onset: float) -> tuple[Floats, Floats, Floats]:
    """Two bones towards a target: direction, and how far along and beside it the middle joint lies.

    Beyond `onset` of the full length the target is approached and never reached.
    """
    step = target - origin
    far = np.linalg.norm(step, axis=1) / (a + b)
    rest = 0.9985 - onset
    far = np.where(far > onset, onset + rest * np.tanh((far - onset) / rest), far)
    d = np.maximum(far * (a + b), 1.02 * abs(a - b) + 0.12 * (a + b))
    along = (a * a - b * b + d * d) / (2 * d)
    return unit(step), along, np.sqrt(np.maximum(a * a - along * along, 0.0))


def _leg(
    who: Person, hip: Floats, ankle: Floats, across: Floats, hips: Floats, loose: Floats
) -> tuple[Floats, Floats]:
    """Frames (T, 3, 3) of thigh and shank.

    `across` is the knee's axis to the left, roughly; as far as the leg is `loose` (T,), the knee points where the
    pelvis does once the thigh is swung from hanging to its place without a twist.
    """
    direction, along, beside = _bent(who.thigh, who.shank, hip, ankle, REACH)
    pole = unit(np.cross(direction, across), (0.0, 0.0, 1.0))
    rows = np.flatnonzero(loose > 0)
    if len(rows):
        d, down, ahead = direction[rows], -hips[rows, :, 1], hips[rows, :, 2]
        axis = np.cross(down, d)
        share = 1.0 / np.maximum(1.0 + np.sum(down * d, axis=1, keepdims=True), 0.05)
        swung = ahead + np.cross(axis, ahead) + share * np.cross(axis, np.cross(axis, ahead))
        one = pole[rows]
        two = np.cross(d, one)  # from one pole to the other round the leg, not through it
        angle = np.arctan2(np.sum(two * swung, axis=1), np.sum(one * swung, axis=1)) * loose[rows]
        pole[rows] = np.cos(angle)[:, None] * one + np.sin(angle)[:, None] * two
    knee = hip + along[:, None] * direction + beside[:, None] * pole
    axis = np.cross(pole, direction)
    thigh_y = unit(hip - knee)
    d = np.sqrt(np.maximum(who.shank**2 - beside**2, 0.0)) + along
    shank_y = unit(knee - (hip + d[:, None] * direction))
    return tuple(np.stack([axis, y, np.cross(axis, y)], axis=-1) for y in (thigh_y, shank_y))  # type: ignore[return-value]


def _arm(
    who: Person, side: str, shoulder: Floats, hand: Floats, chest: Floats, swivel: Floats
) -> tuple[Floats, Floats]:
    """Frames (T, 3, 3) of upper arm and forearm."""
    mirror = 1.0 if side == "l" else -1.0
    direction, along, beside = _bent(who.upper_arm, who.forearm, shoulder, hand, 0.965)
    seen = np.einsum("tji,tj->ti", chest, direction) * [mirror, 1.0, 1.0]
    towards = unit(np.array([a for a, _ in _ELBOWS]))
    weight = np.exp(3.5 * seen @ towards.T)
    pole = (weight / weight.sum(axis=1, keepdims=True)) @ unit(np.array([b for _, b in _ELBOWS]))
    pole = _apply(chest, pole * [mirror, 1.0, 1.0])
    pole = unit(pole - np.sum(pole * direction, axis=1, keepdims=True) * direction, (0.0, -1.0, 0.0))
    # outwards: against the clock for the left arm as its owner looks along it
    pole = Rotation.from_rotvec(direction * np.radians(mirror * swivel)[:, None]).apply(pole)
    elbow = shoulder + along[:, None] * direction + beside[:, None] * pole
    d = np.sqrt(np.maximum(who.forearm**2 - beside**2, 0.0)) + along
    hinge = np.cross(pole, direction)
    bones = (unit(elbow - shoulder), unit(shoulder + d[:, None] * direction - elbow))
    return tuple(
        np.stack([mirror * x, -mirror * hinge, np.cross(mirror * x, -mirror * hinge)], axis=-1) for x in bones
    )  # type: ignore[return-value]


def _clear(who: Person, chest: tuple[Floats, Floats], hand: Floats) -> Floats:
    """A hand's place before the trunk rather than in it; the trunk is an elliptic column."""
    origin, axes = chest
    seen = np.einsum("tji,tj->ti", axes, hand - origin)
    h = who.height
    aside = np.abs(seen[:, 0]) / (0.115 * h * who.girth)
    level = np.abs(seen[:, 1] + 0.08 * h) - 0.19 * h
    before = expit((1.0 - aside) / 0.06) * expit(-level / (0.012 * h))
    soft = 0.012 * h
    deep = 0.088 * h * who.girth * np.sqrt(np.clip(1 - aside**2, 0.0, 1.0) + 0.02) - seen[:, 2]
    pushed = soft * np.logaddexp(0.0, deep / soft)
    return hand + _apply(axes, np.stack([np.zeros_like(deep), np.zeros_like(deep), before * pushed], axis=-1))


def _inside(who: Person, chest: tuple[Floats, Floats], place: Floats) -> Floats:
    """How deep a place is in the trunk: 0 outside, 1 at its axis (T,), smooth."""
    origin, axes = chest
    seen = np.einsum("tji,tj->ti", axes, place - origin)
    h = who.height
    r = np.hypot(seen[:, 0] / (0.11 * h * who.girth), seen[:, 2] / (0.08 * h * who.girth))
    level = np.abs(seen[:, 1] + 0.08 * h) - 0.17 * h
    depth: Floats = 0.08 * np.logaddexp(0.0, (1.0 - r) / 0.08) * expit(-level / (0.015 * h))
    return depth


class Body(NamedTuple):
    """Places of the root (T, 3) and frames of all joints in the world (T, 3, 3)."""

    root: Floats
    world: dict[str, Floats]


Noise = Callable[[int, float], Floats]
"""(width, hz) → (T, width)"""


def _off_floor(who: Person, s: str, shoulder: Floats, hand: Floats, chest: Floats, swivel: Floats) -> Floats:
    """By how much more an elbow is turned about its arm's line to stay above the floor (T,), degrees."""
    low = 2 * _OVER * who.height
    rows = np.flatnonzero(np.minimum(shoulder[:, 1], hand[:, 1]) < 0.75 * who.upper_arm)
    extra = np.zeros(len(swivel))
    if not len(rows):
        return extra
    sign = 1.0 if s == "l" else -1.0
    tries = np.arange(-180.0, 181.0, 15.0)
    cost = np.empty((len(tries), len(rows)))
    for n, more in enumerate(tries):
        upper, _ = _arm(who, s, shoulder[rows], hand[rows], chest[rows], swivel[rows] + more)
        high = shoulder[rows, 1] + sign * who.upper_arm * upper[:, 1, 0]
        cost[n] = np.maximum(low - high, 0.0) / (0.02 * who.height) + (more / 75.0) ** 2
    weight = np.exp(-3.0 * (cost - cost.min(axis=0)))
    extra[rows] = (tries[:, None] * weight).sum(axis=0) / weight.sum(axis=0)
    return _slow(extra)


def embody(b: Score, rng: np.random.Generator, name: str = "", fps: float = 2 * RATE) -> Motion:
    """The motion of a score.

    Slow unrest goes onto pelvis, trunk, head and free hands; a fifth of a millimetre of jitter, as of a
    marker-based capture, onto what the inverse kinematics follows.

    Parameters
    ----------
    fps
        `RATE` or twice as much.
    """
    n = int(np.ceil(b.now * RATE)) + 1
    t = np.arange(n) / RATE
    paths = [
        flight.path(b, f, lambda at: pose(b, at, lambda w, hz: np.zeros((len(at), w)))) for f in b.flights
    ]
    body = pose(b, t, lambda width, hz: unrest(rng, n, width, hz), paths)
    local = np.empty((n, len(people.JOINTS), 4))
    for j, joint in enumerate(people.JOINTS):
        p = people.PARENTS[j]
        frames = body.world[joint]
        turned = frames if p < 0 else np.swapaxes(body.world[people.JOINTS[p]], 1, 2) @ frames
        local[:, j] = quaternions(turned)
    local[1:] *= np.cumprod(np.where((local[1:] * local[:-1]).sum(2, keepdims=True) < 0, -1.0, 1.0), axis=0)
    skeleton = people.skeleton(b.who)
    if fps == RATE:
        return Motion(skeleton, fps, body.root, local, name=name)
    local = doubled(local)
    local /= np.linalg.norm(local, axis=2, keepdims=True)
    return Motion(skeleton, fps, doubled(body.root), local, name=name)


def pose(b: Score, t: Floats, noise: Noise, paths: Sequence[flight.Path] = ()) -> Body:
    """The body at times (T,)."""
    who, n = b.who, len(t)
    k = b.tracks
    scale = who.height / 1.75
    sway = who.sway

    pelvis, turn = curve(k["pelvis"], t), curve(k["turn"], t)
    for path in paths:
        rows = slice(*np.searchsorted(t, [path.start, path.end]))
        pelvis[rows], turn[rows] = path.at(t[rows])
    pelvis = pelvis + 0.004 * sway * scale * noise(3, 0.35) * [1.0, 0.25, 1.0]
    turn = turn + 0.7 * sway * noise(3, 0.4)
    trunk = curve(k["trunk"], t) + 1.1 * sway * noise(3, 0.45)
    head = curve(k["head"], t) + 1.6 * sway * noise(3, 0.5)
    hips = _turn("YXZY", *turn.T, curve(k["spin"], t)[:, 0])

    soles, ankles, free, loose = {}, {}, {}, {}
    leg = who.thigh + who.shank
    for s in SIDES:
        sole = curve(k[f"{s}_sole"], t)
        soles[s], ankle = _soles(who, sole[:, 0], sole[:, 1])
        free[s] = 1 - _standing(b.air[s], t)
        loose[s] = curve(k[f"{s}_ankle"], t)
        sign = b.out(s)
        hip = pelvis + _apply(hips, np.array([sign * 0.052 * who.height * who.hips, -who.hip_drop, 0.0]))
        frames = {"hip": (hip - ankle, hips * scale)}  # keys in the hip's frame are the ankle's places
        ground = framed(k[f"{s}_foot"], t, frames, hips, sign)
        ankles[s] = ground + ankle
        ankles[s][:, 1] += curve(k[f"{s}_lift"], t)[:, 0]
    limit = np.full(n, 1e3)
    for s in SIDES:
        drop = hips @ np.array([b.out(s) * 0.052 * who.height * who.hips, -who.hip_drop, 0.0])
        level = np.linalg.norm((pelvis + drop - ankles[s])[:, [0, 2]], axis=1)
        height = np.sqrt(np.maximum((REACH * leg) ** 2 - level**2, (0.3 * leg) ** 2))
        limit = lower(limit, ankles[s][:, 1] + height - drop[:, 1] + 1.5 * free[s])
    dip = pelvis[:, 1] - lower(pelvis[:, 1], limit)
    for flight_ in b.flights:  # legs that are stretched when they leave the ground are drawn after
        dip[slice(*np.searchsorted(t, [flight_.start - 0.03, flight_.end]))] = 0.0
    pelvis[:, 1] -= _ahead(dip)
    jitter = 2e-4
    pelvis = pelvis + (jitter * noise(3, 7.0) + 0.0007 * who.tremor * noise(3, 2.5))

    world: dict[str, Floats] = {"Hips": hips}
    offsets = people.skeleton(who).offsets
    at: dict[str, Floats] = {"Hips": pelvis}
    for parent, joint, share in (
        ("Hips", "Spine", 0.25),
        ("Spine", "Spine1", 0.4),
        ("Spine1", "Spine2", 0.35),
    ):
        at[joint] = at[parent] + _apply(world[parent], offsets[_J[joint]])
        world[joint] = world[parent] @ _turn(
            "YXZ", share * trunk[:, 2], share * trunk[:, 0], share * trunk[:, 1]
        )
    for parent, joint, share in (("Spine2", "Neck", 0.4), ("Neck", "Head", 0.6)):
        at[joint] = at[parent] + _apply(world[parent], offsets[_J[joint]])
        world[joint] = world[parent] @ _turn(
            "YXZ", share * head[:, 2], share * head[:, 0], share * head[:, 1]
        )

    flat = _turn("Y", turn[:, 0])
    for s in SIDES:
        long, sign = _LONG[s], b.out(s)
        hip = pelvis + _apply(hips, offsets[_J[f"{long}UpLeg"]])
        ankles[s] = ankles[s] + jitter * noise(3, 7.0)
        # the knee's axis lies between pelvis and foot, so that the knee points over the toes
        own = 0.55 * (1 - loose[s][:, :1])
        across = unit((1 - own) * hips[:, :, 0] + own * unit(soles[s][:, :, 0]))
        thigh, shank = _leg(who, hip, ankles[s], across, hips, loose[s][:, 0])
        if loose[s].any():
            sole = soles[s]
            for _ in range(2):  # who is in the air does not go through the floor either
                soles[s] = _between(sole, shank @ _turn("X", loose[s][:, 1]), loose[s][:, 0])
                tip = ankles[s][:, 1] + _apply(soles[s], np.array(people.tip(who)))[:, 1]
                ankle = np.minimum(tip, ankles[s][:, 1] - 0.03 * who.height) - 0.002
                ankles[s][:, 1] += np.minimum(loose[s][:, 0] * 4.0, 1.0) * (
                    -lower(-ankle, 0.0 * ankle, 0.004) - ankle
                )
                thigh, shank = _leg(who, hip, ankles[s], across, hips, loose[s][:, 0])
            soles[s] = _between(sole, shank @ _turn("X", loose[s][:, 1]), loose[s][:, 0])
        knee = hip + _apply(thigh, np.array([0.0, -who.thigh, 0.0]))
        world[f"{long}UpLeg"], world[f"{long}Leg"], world[f"{long}Foot"] = thigh, shank, soles[s]
        pitch = curve(k[f"{s}_sole"], t)[:, 1]
        # toes stay on the ground under a heel that rises, and follow the foot once it is clear of it
        ball = ankles[s][:, 1] + _apply(soles[s], offsets[_J[f"{long}ToeBase"]])[:, 1]
        u = np.clip((ball - people.BALL * who.height) / 0.07, 0.0, 1.0)
        bend = np.maximum(pitch, 0.0) * (1 - 0.75 * u * u * (3 - 2 * u)) * (1 - loose[s][:, 0])
        world[f"{long}ToeBase"] = soles[s] @ _turn("X", -bend)
        _upper(b, s, noise, t, offsets, at, world, knee, flat, hip)
    return Body(pelvis, world)


def _between(a: Floats, b: Floats, share: Floats) -> Floats:
    """Frames (T, 3, 3) between two, on the shortest way, or on the longer one where that goes on from before."""
    rows = np.flatnonzero(share > 0)
    result = a.copy()
    if len(rows):
        step = Rotation.from_matrix(np.swapaxes(a[rows], 1, 2) @ b[rows]).as_rotvec()
        angle = np.linalg.norm(step, axis=1)
        for i in np.flatnonzero((angle[1:] > 0.5 * np.pi) & (np.diff(rows) == 1)) + 1:
            long = step[i] * (1 - 2 * np.pi / angle[i])
            if np.linalg.norm(long - step[i - 1]) < np.linalg.norm(step[i] - step[i - 1]):
                step[i] = long
        result[rows] = a[rows] @ Rotation.from_rotvec(step * share[rows, None]).as_matrix()
    return result


def doubled(x: Floats) -> Floats:
    """Rows (T, …) and what lies half-way between them (2 T − 1, …), by Lagrange's polynomial through six."""
    pad = np.concatenate([x[:1], x[:1], x, x[-1:], x[-1:]])
    m = len(x) - 1
    a, b, c, d, e, f = (pad[i : i + m] for i in range(6))
    result = np.empty((2 * len(x) - 1, *x.shape[1:]))
    result[::2] = x
    result[1::2] = (3 * (a + f) - 25 * (b + e) + 150 * (c + d)) / 256
    return result


def _upper(
    b: Score,
    s: str,
    noise: Noise,
    t: Floats,
    offsets: NDArray[np.float64],
    at: dict[str, Floats],
    world: dict[str, Floats],
    knee: Floats,
    flat: Floats,
    hip: Floats,
) -> None:
    """Collar bone, arm and hand of one side."""
    who, long, sign = b.who, _LONG[s], b.out(s)
    scale = who.height / 1.75
    chest = world["Spine2"]
    girdle = at["Spine2"] + _apply(chest, offsets[_J[f"{long}Shoulder"]])
    rest = girdle + _apply(chest, offsets[_J[f"{long}Arm"]])
    frames = {
        "arm": (rest, chest * who.arm),
        "head": (at["Head"], world["Head"] * scale),
        "hip": (hip, world["Hips"] * scale),
        "knee": (knee, flat * scale),
    }
    hand = framed(b.tracks[f"{s}_hand"], t, frames, chest, sign)
    hand = hand + (0.006 * who.sway * noise(3, 0.6) + 0.0015 * who.tremor * noise(3, 3.0)) * scale
    middle = at["Spine2"] + _apply(chest, np.array([0.0, -0.01 * who.height, 0.012 * who.height]))
    hand = _clear(who, (middle, chest), hand)
    hand[:, 1] = -lower(-hand[:, 1], np.full(len(t), -_OVER * who.height), 0.004)
    # the shoulder goes with the hand: up when it is raised, ahead when it reaches
    seen = np.einsum("tji,tj->ti", chest, hand - rest) / who.arm * [sign, 1.0, 1.0]
    u = np.clip(0.5 + 0.55 * seen[:, 1], 0.0, 1.0)
    raised = 24.0 * u * u * (3 - 2 * u) - 2.0
    ahead = 16.0 * np.tanh(seen[:, 2]) + 10.0 * np.tanh(np.maximum(-seen[:, 0], 0.0))
    collar = chest @ _turn("YZ", -sign * ahead, sign * raised)
    shoulder = girdle + _apply(collar, offsets[_J[f"{long}Arm"]])
    swivel = curve(b.tracks[f"{s}_swivel"], t)[:, 0] + 4.0 * who.sway * noise(1, 0.4)[:, 0]
    upper, fore = _arm(who, s, shoulder, hand, chest, swivel)
    elbow = shoulder + sign * who.upper_arm * upper[:, :, 0]
    swivel = swivel + 55.0 * _inside(who, (middle, chest), elbow)  # elbows go round the trunk
    swivel = swivel + _off_floor(who, s, shoulder, hand, chest, swivel)
    upper, fore = _arm(who, s, shoulder, hand, chest, swivel)
    wrist = curve(b.tracks[f"{s}_wrist"], t) + 2.0 * noise(3, 0.8)
    world[f"{long}Shoulder"], world[f"{long}Arm"], world[f"{long}ForeArm"] = collar, upper, fore
    flat = curve(b.tracks[f"{s}_palm"], t)
    free = fore @ _turn("XYZ", wrist[:, 2], -sign * wrist[:, 1], -sign * wrist[:, 0])
    yaw = np.radians(flat[:, 1])
    world[f"{long}Hand"] = _between(free, _level(sign * np.sin(yaw), sign * np.cos(yaw)), flat[:, 0])
    # fingers do not go through the floor; they begin to lie flat before they touch it
    own = world[f"{long}Hand"]
    deep = 0.09 * who.height - (hand[:, 1] + sign * own[:, 1, 0] * people.HAND * who.height * who.arms)
    u = np.clip(deep / (0.13 * who.height), 0.0, 1.0)
    world[f"{long}Hand"] = _between(
        own,
        _level(*(_slow(own[:, [0, 2], 0]) + 0.6 * sign * np.stack([np.sin(yaw), np.cos(yaw)], axis=1)).T),
        u * u * (3 - 2 * u),
    )


def _slow(x: Floats) -> Floats:
    """Rows (T, …) without what is quicker than a tenth of a second."""
    slow: Floats = gaussian_filter1d(x, 0.07 * RATE, axis=0, mode="nearest")
    return slow


def _level(x: Floats, z: Floats) -> Floats:
    """Frames (T, 3, 3) with the second axis upright and the first as near to (x, ·, z) as that allows."""
    first = unit(np.stack([x, np.zeros_like(x), z], axis=-1), (1.0, 0.0, 0.0))
    up = np.broadcast_to([0.0, 1.0, 0.0], first.shape)
    return np.stack([first, up, np.cross(first, up)], axis=-1)
