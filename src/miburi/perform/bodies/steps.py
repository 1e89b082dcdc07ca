"""Feet: steps on the spot, walking, stairs. A foot that stands is not moved; it rolls over heel and ball."""

from __future__ import annotations

import math

from miburi.perform.bodies.score import SIDES, Score, Vector


def swing(
    b: Score,
    side: str,
    start: float,
    end: float,
    place: Vector,
    yaw: float,
    *,
    lift: float = 0.05,
    leave: float = 22.0,
    arrive: float = -6.0,
) -> None:
    """Lift a foot and put its ball down elsewhere.

    Parameters
    ----------
    place
        In the world, metres.
    yaw
        Of the toes, degrees, in the world.
    lift
        How high above the higher of both places, metres.
    leave, arrive
        Pitch of the sole when the foot leaves and when it arrives, degrees; positive: the heel is up.
    """
    span = end - start
    before = b.last(f"{side}_foot").value
    b.air[side].append((start, end))
    b.move(f"{side}_foot", start, end, place)
    top = lift + max(before[1], place[1]) - 0.5 * (before[1] + place[1])
    b.move(f"{side}_lift", start, start + 0.5 * span, (top,))
    b.move(f"{side}_lift", start + 0.5 * span, end, (0.0,))
    was = b.last(f"{side}_sole").value[0]
    sole = f"{side}_sole"
    b.move(sole, start - 0.35 * span, start + 0.12 * span, (0.9 * was + 0.1 * yaw, leave), through=True)
    b.move(sole, start + 0.12 * span, end, (yaw, arrive), through=abs(arrive) < 1.0)
    if abs(arrive) >= 1.0:
        b.move(sole, end, end + 0.3 * span, (yaw, 0.0))


def stand(
    b: Score, left: Vector, right: Vector, *, yaws: tuple[float, float] = (0.0, 0.0), seconds: float = 0.42
) -> None:
    """Step to a stance, one foot after the other; feet that are nearly there stay.

    Parameters
    ----------
    left, right
        Where the balls of the feet go, in the performer's own frame, metres.
    yaws
        Of left and right toes against the heading, degrees, on top of the performer's own.
    """
    places = {"l": b.world(*left), "r": b.world(*right)}
    yaw = {"l": b.heading + b.who.toe_out + yaws[0], "r": b.heading - b.who.toe_out + yaws[1]}
    order = SIDES if b.rng.random() < 0.5 else SIDES[::-1]
    for side in order:
        foot, sole = b.last(f"{side}_foot").value, b.last(f"{side}_sole").value
        if math.dist(foot, places[side]) < 0.035 and abs(sole[0] - yaw[side]) < 9.0:
            continue
        other = b.local(b.last(f"{b.other(side)}_foot").value)
        t = b.now
        span = b.beat(seconds * (0.85 + 1.2 * min(math.dist(foot, places[side]), 0.5)))
        here = b.local(b.last("pelvis").value)
        b.pelvis(
            t - 0.08,
            t + 0.5 * span,
            0.35 * here[0] + 0.65 * other[0],
            -0.006,
            0.5 * (here[2] + _root(b, other)),
        )
        swing(b, side, t + 0.3 * span, t + span, places[side], yaw[side], lift=0.035)
        target = b.local(places[side])
        b.pelvis(
            t + 0.5 * span,
            t + 1.2 * span,
            0.5 * (other[0] + target[0]),
            0.0,
            0.5 * (_root(b, other) + _root(b, target)),
        )
        b.now = t + 1.05 * span


def _root(b: Score, foot: Vector) -> float:
    """How far ahead a root above a foot would be (own frame; as `Score.pelvis` counts it)."""
    return foot[2] - b.who.ball_ahead


def home(b: Score) -> None:
    """Step back to standing at ease, around the middle of where the feet are."""
    b.settle()
    stand(b, b.stance("l"), b.stance("r"))
    end = b.now + b.beat(0.35)
    b.rise(b.now - 0.15, end)
    b.now = end - 0.05


def turn_round(b: Score, degrees: float) -> None:
    """Turn on the spot by small steps; eyes first, then trunk and pelvis."""
    count = max(1, math.ceil(abs(degrees) / 55.0))
    t = b.now
    b.look(t, t + b.beat(0.35), yaw=max(-50.0, min(50.0, 0.6 * degrees)))
    for _ in range(count):
        b.heading += degrees / count
        t = b.now
        first = SIDES if degrees > 0 else SIDES[::-1]
        for side in first:
            t = b.now
            span = b.beat(0.4)
            b.turn(t - 0.05, t + 1.2 * span, -0.5 * degrees / count if side == first[0] else 0.0, 1.0, 0.0)
            lean = 0.6 * b.stance(b.other(side))[0]
            b.pelvis(t, t + 0.45 * span, lean, -0.006, 0.0)
            where = b.world(*b.stance(side))
            swing(
                b, side, t + 0.15 * span, t + span, where, b.heading + b.out(side) * b.who.toe_out, lift=0.04
            )
            b.now = t + 1.02 * span
    t = b.now
    b.rise(t - 0.05, t + b.beat(0.35))
    b.now = t + 0.1


def walk(
    b: Score,
    count: int,
    *,
    length: float = 0.0,
    turn: float = 0.0,
    rise: tuple[float, ...] = (),
    seconds: float = 0.58,
    arms: float = 1.0,
) -> None:
    """Walk some steps and come to a stand with the feet side by side.

    Parameters
    ----------
    count
        Steps, the closing one not counted.
    length
        Metres of a step; 0: the performer's own.
    turn
        Degrees to the left over all steps.
    rise
        Metres that each step goes up (down: negative); absent: level.
    seconds
        Of a step at tempo 1.
    arms
        How far the arms swing.
    """
    who = b.who
    length = length or 0.385 * who.height * who.step
    half = 0.045 * who.height * min(who.stance, 1.15)
    side = b.other(b.hand) if b.rng.random() < 0.6 else b.hand
    beats = [b.beat(seconds, 0.035) for _ in range(count + 1)]
    t = b.now
    climbing = bool(rise)
    middle = [0.0, 0.0]  # where the walk's line is, in the world
    place = b.world(0.0, 0.0, 0.0)
    middle[0], middle[1], level = place[0], place[2], 0.0
    base = b.floor
    pitch = 7.0 if climbing and sum(rise) > 0 else 3.0
    b.trunk(t - 0.1, t + 1.2 * beats[0], pitch + 1.0)
    for k in range(count + 1):
        closing = k == count
        span = beats[k]
        ground = level + (rise[k] if k < len(rise) else 0.0) if not closing else level
        ahead = 0.0 if closing else length * (0.75 if k == 0 else 1.0) * float(b.vary(1.0, 0.03))
        b.heading += 0.0 if closing else turn / count
        angle = math.radians(b.heading)
        middle[0] += ahead * math.sin(angle)
        middle[1] += ahead * math.cos(angle)
        b.x, b.z, b.floor = middle[0], middle[1], base + ground
        wide = 0.055 * who.height * who.stance if closing else half
        goal = b.world(b.out(side) * wide, 0.0, who.ball_ahead)
        yaw = b.heading + b.out(side) * who.toe_out
        up = ground - level
        lift = 0.05 + (0.05 if up > 0 else 0.02 if up < 0 else 0.0)
        start = t + (0.14 if climbing else 0.07) * span
        swing(
            b, side, start, t + span, goal, yaw, lift=0.03 if closing else lift,
            leave=36.0 if climbing else 20.0 if closing else 42.0,
            arrive=0.0 if closing else (-4.0 if up >= 0 and climbing else 14.0 if up < 0 else -15.0),
        )  # fmt: skip
        other = b.out(b.other(side)) * 0.022
        if climbing:
            # over the foot that carries, which straightens; going down, it bends until the other one lands
            low = 0.0 if closing else -up - 0.005 - (0.85 * abs(up) if up < 0 else 0.0)
            b.pelvis(
                t - 0.05 * span,
                t + 0.9 * span,
                0.0 if closing else other,
                low,
                0.0 if closing else 0.05 - ahead,
            )
        else:
            # over the standing foot half-way, between both feet when the swinging one lands
            if not closing:
                b.pelvis(t, t + 0.5 * span, other, 0.008, (0.05 if k else 0.15) * ahead - ahead, through=True)
            sway, back = (0.0, 0.0) if closing else (0.4 * b.out(side) * 0.012, -0.5 * ahead)
            finish = t + (1.25 if closing else 1.0) * span
            b.pelvis(t + 0.5 * span, finish, sway, -0.012 * (not closing), back, through=not closing)
        forward = 0.0 if closing else -b.out(side) * 6.0
        b.turn(t, t + 1.05 * span, forward, 2.0, 0.0, through=not closing)
        b.trunk(t, t + 1.05 * span, 0.0 if closing else pitch, 0.0, -1.5 * forward, through=not closing)
        b.look(t, t + span, -2.0, 0.0 if closing else 0.4 * turn / count + 0.5 * forward)
        _arms(b, side, t, t + 1.08 * span, 0.0 if closing else arms * (0.6 if climbing else 1.0))
        level = ground
        t += span
        side = b.other(side)
    b.now = t + 0.12
    b.settle()
    b.rise(b.now - 0.1, b.now + b.beat(0.3))


def _arms(b: Score, ahead: str, start: float, end: float, size: float) -> None:
    """Arms swing against the legs: the hand of the side whose foot goes ahead goes back."""
    out, up, front = b.hand_rest
    far = 0.36 * b.who.size * size
    for side in SIDES:
        sign = -0.75 if side == ahead else 1.0
        value = (out, up + 0.12 * far + (0.06 if sign > 0 else 0.0) * size, front + sign * far)
        b.move(f"{side}_hand", start, end, value, "arm")


def footfalls(b: Score) -> dict[str, list[tuple[float, float]]]:
    """When each foot stands on something that does not move: side → (start, end) in seconds."""
    result: dict[str, list[tuple[float, float]]] = {}
    for side in SIDES:
        edges = [0.0]
        for start, end in sorted(b.air[side]):
            edges += [start, end]
        edges.append(b.now)
        result[side] = [(a, z) for a, z in zip(edges[::2], edges[1::2], strict=True) if z > a]
    return result
