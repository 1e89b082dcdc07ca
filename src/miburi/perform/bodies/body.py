"""From a score to a moving skeleton: curves, then inverse kinematics of legs and arms, all frames at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d
from scipy.spatial.transform import Rotation
from scipy.special import expit

from miburi.kinematics import quaternions, unit
from miburi.motion import Floats, Motion
from miburi.perform.bodies import people
from miburi.perform.bodies.people import Person
from miburi.perform.bodies.score import SIDES, Key, Score

FPS = 60.0
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
    frames: Floats = Rotation.from_euler(order, np.stack(degrees, axis=-1), degrees=True).as_matrix()
    return frames


def _apply(frames: Floats, vectors: Floats) -> Floats:
    """Vectors (T, 3) or (3,) of frames (T, 3, 3) in the world."""
    turned: Floats = np.einsum("tij,tj->ti", frames, np.broadcast_to(vectors, (len(frames), 3)))
    return turned


def _speeds(keys: list[Key]) -> Floats:
    """Speed at each key: none, or where it is passed through, of the way between its neighbours."""
    values = np.array([k.value for k in keys])
    speeds = np.zeros_like(values)
    for i in range(1, len(keys) - 1):
        if keys[i].through and keys[i - 1].frame == keys[i].frame == keys[i + 1].frame:
            speeds[i] = (values[i + 1] - values[i - 1]) / max(keys[i + 1].t - keys[i - 1].t, 1e-3)
    return speeds


def _pass(keys: list[Key], i: int, t: Floats) -> tuple[Floats, Floats, Floats]:
    """Weights (n, 1) of the next key, of the speed here and of the speed there, on the way from key i.

    The quintic without acceleration at both ends: with speeds of zero the minimum-jerk movement.
    """
    span = keys[i + 1].t - keys[i].t
    u = np.clip((t - keys[i].t) / span, 0.0, 1.0)[:, None]
    return (
        u**3 * (10 + u * (6 * u - 15)),
        span * (u - u**3 * (6 + u * (3 * u - 8))),
        span * u**3 * (-4 + u * (7 - 3 * u)),
    )


def curve(keys: list[Key], t: Floats) -> Floats:
    """A track whose keys lie in one frame, at times (T,): (T, D)."""
    values, speeds = np.array([k.value for k in keys]), _speeds(keys)
    result = np.repeat(values[-1:], len(t), axis=0)
    edges = np.searchsorted(t, [k.t for k in keys])
    result[: edges[0]] = values[0]
    for i in range(len(keys) - 1):
        rows = slice(edges[i], edges[i + 1])
        there, begin, finish = _pass(keys, i, t[rows])
        result[rows] = (
            values[i] + there * (values[i + 1] - values[i]) + begin * speeds[i] + finish * speeds[i + 1]
        )
    return result


def _framed(
    keys: list[Key], t: Floats, frames: dict[str, tuple[Floats, Floats]], arcs: Floats, mirror: float
) -> Floats:
    """A track whose keys lie in frames that move, as places in the world (T, 3).

    `frames` holds origins (T, 3) and axes (T, 3, 3), scaled; `mirror` turns outwards into left; `arcs` is the
    frame of the ways' bends.
    """

    def place(k: Key, rows: slice) -> Floats:
        value = np.array(k.value)
        if k.frame == "world":
            return np.repeat(value[None], len(t[rows]), axis=0)
        origin, axes = frames[k.frame]
        moving: Floats = origin[rows] + axes[rows] @ (value * [mirror, 1.0, 1.0])
        return moving

    speeds = _speeds(keys)
    result = place(keys[-1], slice(0, len(t)))
    edges = np.searchsorted(t, [k.t for k in keys])
    for i in range(len(keys) - 1):
        rows = slice(edges[i], edges[i + 1])
        there, begin, finish = _pass(keys, i, t[rows])
        result[rows] = (1 - there) * place(keys[i], rows) + there * place(keys[i + 1], rows)
        for weight, k in ((begin, i), (finish, i + 1)):
            if speeds[k].any():
                axes = frames[keys[k].frame][1][rows] if keys[k].frame != "world" else np.eye(3)
                result[rows] += weight * (
                    axes @ (speeds[k] * [1.0 if keys[k].frame == "world" else mirror, 1.0, 1.0])
                )
        if any(keys[i + 1].arc):
            bend = 16 * there**2 * (1 - there) ** 2
            result[rows] += bend * (arcs[rows] @ (np.array(keys[i + 1].arc) * [mirror, 1.0, 1.0]))
    return result


def _unrest(rng: np.random.Generator, frames: int, width: int, hz: float) -> Floats:
    """Noise (frames, width) of variance one below a frequency."""
    sigma = FPS / (2 * np.pi * hz)
    pad = int(4 * sigma) + 1
    noise = gaussian_filter1d(rng.standard_normal((frames + 2 * pad, width)), sigma, axis=0, mode="nearest")
    result: Floats = noise[pad : pad + frames] * np.sqrt(2 * np.sqrt(np.pi) * sigma)
    return result


def _lower(a: Floats, b: Floats, soft: float = 0.006) -> Floats:
    """The smaller of two, without a corner."""
    return -soft * np.logaddexp(-a / soft, -b / soft)


def _ahead(dip: Floats, seconds: float = 0.1) -> Floats:
    """At least as low as a dip (T,), and in time: the body sinks before its foot lands, not when it does."""
    reach = round(seconds * FPS)
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


def _leg(who: Person, hip: Floats, ankle: Floats, across: Floats) -> tuple[Floats, Floats]:
    """Frames (T, 3, 3) of thigh and shank; `across` is the knee's axis to the left, roughly."""
    direction, along, beside = _bent(who.thigh, who.shank, hip, ankle, REACH)
    pole = unit(np.cross(direction, across), (0.0, 0.0, 1.0))
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
    aside = np.abs(seen[:, 0]) / (0.115 * h)
    level = np.abs(seen[:, 1] + 0.08 * h) - 0.19 * h
    before = expit((1.0 - aside) / 0.06) * expit(-level / (0.012 * h))
    soft = 0.012 * h
    deep = 0.088 * h * np.sqrt(np.clip(1 - aside**2, 0.0, 1.0) + 0.02) - seen[:, 2]
    pushed = soft * np.logaddexp(0.0, deep / soft)
    return hand + _apply(axes, np.stack([np.zeros_like(deep), np.zeros_like(deep), before * pushed], axis=-1))


def _inside(who: Person, chest: tuple[Floats, Floats], place: Floats) -> Floats:
    """How deep a place is in the trunk: 0 outside, 1 at its axis (T,), smooth."""
    origin, axes = chest
    seen = np.einsum("tji,tj->ti", axes, place - origin)
    h = who.height
    r = np.hypot(seen[:, 0] / (0.11 * h), seen[:, 2] / (0.08 * h))
    level = np.abs(seen[:, 1] + 0.08 * h) - 0.17 * h
    depth: Floats = 0.08 * np.logaddexp(0.0, (1.0 - r) / 0.08) * expit(-level / (0.015 * h))
    return depth


def embody(b: Score, rng: np.random.Generator, name: str = "") -> Motion:
    """The motion of a score.

    Slow unrest goes onto pelvis, trunk, head and free hands; a fifth of a millimetre of jitter, as of a
    marker-based capture, onto what the inverse kinematics follows.
    """
    who = b.who
    n = int(np.ceil(b.now * FPS)) + 1
    t = np.arange(n) / FPS
    k = {track: keys for track, keys in b.tracks.items()}
    scale = who.height / 1.75
    sway = who.sway

    pelvis = curve(k["pelvis"], t) + 0.004 * sway * scale * _unrest(rng, n, 3, 0.35) * [1.0, 0.25, 1.0]
    turn = curve(k["turn"], t) + 0.7 * sway * _unrest(rng, n, 3, 0.4)
    trunk = curve(k["trunk"], t) + 1.1 * sway * _unrest(rng, n, 3, 0.45)
    head = curve(k["head"], t) + 1.6 * sway * _unrest(rng, n, 3, 0.5)
    hips = _turn("YXZ", *turn.T)

    soles, ankles, free = {}, {}, {}
    leg = who.thigh + who.shank
    for s in SIDES:
        sole = curve(k[f"{s}_sole"], t)
        soles[s], ankle = _soles(who, sole[:, 0], sole[:, 1])
        free[s] = 1 - _standing(b.air[s], t)
        sign = b.out(s)
        hip = pelvis + _apply(hips, np.array([sign * 0.052 * who.height * who.hips, -who.hip_drop, 0.0]))
        frames = {"hip": (hip - ankle, hips * scale)}  # keys in the hip's frame are the ankle's places
        ground = _framed(k[f"{s}_foot"], t, frames, hips, sign)
        ankles[s] = ground + ankle
        ankles[s][:, 1] += curve(k[f"{s}_lift"], t)[:, 0]
    limit = np.full(n, 1e3)
    for s in SIDES:
        drop = hips @ np.array([b.out(s) * 0.052 * who.height * who.hips, -who.hip_drop, 0.0])
        level = np.linalg.norm((pelvis + drop - ankles[s])[:, [0, 2]], axis=1)
        height = np.sqrt(np.maximum((REACH * leg) ** 2 - level**2, (0.3 * leg) ** 2))
        limit = _lower(limit, ankles[s][:, 1] + height - drop[:, 1] + 1.5 * free[s])
    pelvis[:, 1] -= _ahead(pelvis[:, 1] - _lower(pelvis[:, 1], limit))
    jitter = 2e-4
    pelvis = pelvis + (jitter * _unrest(rng, n, 3, 7.0) + 0.0007 * who.tremor * _unrest(rng, n, 3, 2.5))

    world: dict[str, Floats] = {"Hips": hips}
    skeleton = people.skeleton(who)
    offsets = skeleton.offsets
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
        ankles[s] = ankles[s] + jitter * _unrest(rng, n, 3, 7.0)
        # the knee's axis lies between pelvis and foot, so that the knee points over the toes
        across = unit(0.45 * hips[:, :, 0] + 0.55 * unit(soles[s][:, :, 0]))
        thigh, shank = _leg(who, hip, ankles[s], across)
        knee = hip + _apply(thigh, np.array([0.0, -who.thigh, 0.0]))
        world[f"{long}UpLeg"], world[f"{long}Leg"], world[f"{long}Foot"] = thigh, shank, soles[s]
        pitch = curve(k[f"{s}_sole"], t)[:, 1]
        # toes stay on the ground under a heel that rises, and follow the foot once it is clear of it
        ball = ankles[s][:, 1] + _apply(soles[s], offsets[_J[f"{long}ToeBase"]])[:, 1]
        u = np.clip((ball - people.BALL * who.height) / 0.07, 0.0, 1.0)
        bend = np.maximum(pitch, 0.0) * (1 - 0.75 * u * u * (3 - 2 * u))
        world[f"{long}ToeBase"] = soles[s] @ _turn("X", -bend)
        _upper(b, s, rng, t, skeleton.offsets, at, world, knee, flat, hip)

    local = np.empty((n, len(people.JOINTS), 4))
    for j, joint in enumerate(people.JOINTS):
        p = people.PARENTS[j]
        turned = world[joint] if p < 0 else np.swapaxes(world[people.JOINTS[p]], 1, 2) @ world[joint]
        local[:, j] = quaternions(turned)
    return Motion(skeleton, FPS, pelvis, local, name=name)


def _upper(
    b: Score,
    s: str,
    rng: np.random.Generator,
    t: Floats,
    offsets: NDArray[np.float64],
    at: dict[str, Floats],
    world: dict[str, Floats],
    knee: Floats,
    flat: Floats,
    hip: Floats,
) -> None:
    """Collar bone, arm and hand of one side."""
    who, long, sign, n = b.who, _LONG[s], b.out(s), len(t)
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
    hand = _framed(b.tracks[f"{s}_hand"], t, frames, chest, sign)
    hand = (
        hand
        + (0.006 * who.sway * _unrest(rng, n, 3, 0.6) + 0.0015 * who.tremor * _unrest(rng, n, 3, 3.0)) * scale
    )
    middle = at["Spine2"] + _apply(chest, np.array([0.0, -0.01 * who.height, 0.012 * who.height]))
    hand = _clear(who, (middle, chest), hand)
    # the shoulder goes with the hand: up when it is raised, ahead when it reaches
    seen = np.einsum("tji,tj->ti", chest, hand - rest) / who.arm * [sign, 1.0, 1.0]
    u = np.clip(0.5 + 0.55 * seen[:, 1], 0.0, 1.0)
    raised = 24.0 * u * u * (3 - 2 * u) - 2.0
    ahead = 16.0 * np.tanh(seen[:, 2]) + 10.0 * np.tanh(np.maximum(-seen[:, 0], 0.0))
    collar = chest @ _turn("YZ", -sign * ahead, sign * raised)
    shoulder = girdle + _apply(collar, offsets[_J[f"{long}Arm"]])
    swivel = curve(b.tracks[f"{s}_swivel"], t)[:, 0] + 4.0 * who.sway * _unrest(rng, n, 1, 0.4)[:, 0]
    upper, fore = _arm(who, s, shoulder, hand, chest, swivel)
    elbow = shoulder + sign * who.upper_arm * upper[:, :, 0]
    swivel = swivel + 55.0 * _inside(who, (middle, chest), elbow)  # elbows go round the trunk
    upper, fore = _arm(who, s, shoulder, hand, chest, swivel)
    wrist = curve(b.tracks[f"{s}_wrist"], t) + 2.0 * _unrest(rng, n, 3, 0.8)
    world[f"{long}Shoulder"], world[f"{long}Arm"], world[f"{long}ForeArm"] = collar, upper, fore
    world[f"{long}Hand"] = fore @ _turn("XYZ", wrist[:, 2], -sign * wrist[:, 1], -sign * wrist[:, 0])
