"""Motions of the whole body. Each returns when its annotated part began and ended, seconds."""

from __future__ import annotations

import math

from miburi.perform.bodies import steps
from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.score import SIDES, Score


def walk(b: Score, count: int) -> Span:
    """Some steps, straight on or along a bend."""
    start = b.now
    turn = float(b.rng.normal(0.0, 12.0 * count**0.5))
    steps.walk(b, count, turn=turn, seconds=float(b.vary(0.58, 0.03)))
    return start, b.now


def climb(b: Score) -> Span:
    """Up two steps, a foot on each, and side by side on the upper one."""
    start = b.now
    high = b.vary(0.18, 0.01)
    steps.walk(b, 2, length=b.vary(0.29, 0.012), rise=(high, high), seconds=0.62, arms=1.4)
    return start, b.now


def descend(b: Score) -> Span:
    """Down the steps again on the other side, if the floor is high."""
    start, count = b.now, 2
    high = b.floor / count
    steps.walk(b, count, length=b.vary(0.29, 0.012), rise=(-high, -high), seconds=0.6, arms=1.4)
    return start, b.now


def squats(b: Score, times: int) -> Span:
    """Knee bends on the soles or upright on the toes; arms ahead, at the hips or behind the head."""
    who, k = b.who, b.who.height / 1.75
    steps.stand(b, b.stance("l", 1.5), b.stance("r", 1.5), yaws=(8.0, -8.0))
    arms = b.way("squats", "ahead", "ahead", "swing", "hips", "head", "out")
    low = b.way("depth", "half", "deep", "deep") == "deep" and who.age < 60
    on_toes = b.way("balance", "soles", "soles", "toes") == "toes" and who.age < 60
    lean = 0.3 if on_toes else 1.0
    depth = min(max(b.vary(1.42 if low else 1.12, 0.12) * who.size, 0.8), 1.36) * who.thigh
    t = b.now
    if arms in ("hips", "head"):
        ready = b.beat(0.5 if arms == "hips" else 0.9)
        for side in SIDES:
            if arms == "hips":
                b.reach(side, t, t + ready, (0.12, 0.1, 0.06), "hip")
                b.move(f"{side}_swivel", t, t + ready, (25.0,))
            else:
                b.reach(side, t, t + 0.5 * ready, (0.45, 0.1, 0.5), arc=0.05)
                b.reach(side, t + 0.5 * ready, t + 1.2 * ready, (0.09, 0.02, -0.06), "head", arc=0.0)
                b.move(f"{side}_swivel", t, t + ready, (20.0,))
        t += ready
    start = t
    for _ in range(times):
        down, hold, up = b.beat(0.82), b.beat(0.12, 0.4), b.beat(0.76)
        deep = depth * b.vary(1.0, 0.06)
        share = deep / who.thigh
        b.pelvis(t, t + down, 0.0, -deep, -0.13 * k * share * (0.5 if on_toes else 1.0))
        b.turn(t, t + down, 0.0, 17.0 * min(share, 1.0) * lean, 0.0)
        b.trunk(t, t + down, 15.0 * share * lean)
        b.look(t, t + down, -18.0 * share * lean)
        heel = b.vary(34.0, 4.0) * share**0.5 if on_toes else b.vary(23.0, 4.0) * share**1.5
        # the heels leave the floor late, when the ankles give no more, and come back first
        for side in SIDES:
            toes = b.last(f"{side}_sole").value[0]
            late = abs(b.vary(0.0, 0.03))
            b.move(f"{side}_sole", t + 0.5 * down + late, t + down + late, (toes, max(heel, 3.0)))
            b.move(f"{side}_sole", t + down + hold, t + down + hold + 0.55 * up, (toes, 0.0))
        if arms == "out":
            for side in SIDES:
                b.reach(side, t, t + down, (0.45, -0.8, -0.05), arc=0.0)
        if arms in ("ahead", "swing"):
            for side in SIDES:
                b.reach(side, t, t + down, (-0.05, 0.3 * share - 0.1, 0.88), arc=0.05)
        t += down + hold
        b.rise(t, t + up)
        if arms in ("swing", "out"):
            b.relax(t, t + up)
        elif arms == "ahead":
            for side in SIDES:
                b.reach(side, t, t + up, (0.0, b.vary(-0.25, 0.1), 0.85), arc=0.0)
        t += up + abs(b.vary(0.12, 0.1))
    b.now = t
    sink = b.beat(0.6 if arms != "head" else 1.0)
    if arms == "head":
        for side in SIDES:
            b.reach(side, t, t + 0.5 * sink, (0.45, 0.1, 0.5), arc=0.0)
        t += 0.5 * sink
    b.relax(t, t + sink)
    steps.home(b)
    return start, t


def twists(b: Score, times: int) -> Span:
    """The trunk twists from side to side over feet that stand; arms out, bent, or hands at the hips."""
    steps.stand(b, b.stance("l", 1.6), b.stance("r", 1.6), yaws=(4.0, -4.0))
    arms = b.way("twists", "out", "out", "bent", "hips")
    t = b.now
    ready = b.beat(0.6)
    for side in SIDES:
        if arms == "out":
            b.reach(side, t, t + ready, (0.8, 0.0, 0.2), arc=0.1)
        elif arms == "bent":
            b.reach(side, t, t + ready, (-0.22, b.vary(-0.08, 0.03), 0.52), arc=0.1)
            b.move(f"{side}_swivel", t, t + ready, (55.0,))
        else:
            b.reach(side, t, t + ready, (0.12, 0.1, 0.06), "hip")
            b.move(f"{side}_swivel", t, t + ready, (25.0,))
    t += ready
    start = t - 0.15
    way = 1.0 if b.rng.random() < 0.5 else -1.0
    size = b.who.size
    lean, stoop = float(b.rng.uniform(6.0, 15.0)), float(b.rng.uniform(6.0, 14.0))
    for number in range(2 * times):
        # arms that are stretched out are slower to turn back
        span = b.beat(0.8 if arms == "out" else 0.72) * (0.7 if number == 0 else 1.0)
        b.turn(t, t + span, 28.0 * way * size, 0.0, 0.0)
        b.trunk(t + 0.03, t + span + 0.04, stoop, lean * way, b.vary(36.0, 3.0) * way * size)
        b.look(t + 0.02, t + span + 0.06, 0.0, b.vary(15.0, 4.0) * way)
        b.pelvis(t, t + span, -b.vary(0.09, 0.012) * way, -0.02, 0.0)
        for side in SIDES:  # the heel that the body turns away from comes up
            toes = b.heading + b.out(side) * (b.who.toe_out + 4.0)
            lifts = b.out(side) * way < 0
            pivot = (toes + 16.0 * way * lifts, b.vary(24.0, 4.0) if lifts else 0.0)
            b.move(f"{side}_sole", t + 0.1 * span, t + 0.85 * span, pivot)
        t += span + b.beat(0.08, 0.2)
        way = -way
    end = t
    for side in SIDES:
        b.move(f"{side}_sole", t, t + 0.4, (b.heading + b.out(side) * b.who.toe_out, 0.0))
    back = b.beat(0.5)
    b.rise(t, t + back)
    b.relax(t, t + 1.1 * back)
    b.now = t + 0.9 * back
    steps.home(b)
    return start, end


def kick(b: Score, times: int, side: str = "") -> Span:
    """A foot swings back and kicks ahead; the arms balance."""
    who, k = b.who, b.who.height / 1.75
    side = side or b.hand
    other = b.other(side)
    sign = b.out(side)
    t = b.now
    start = t
    stance = b.local(b.last(f"{other}_foot").value)
    for _ in range(times):
        back, go, down = b.beat(0.45), b.beat(0.36), b.beat(0.5)
        high = min(max(b.vary(0.5, 0.12) * who.size, 0.25), 0.66) * k
        # as far as a leg that is nearly straight reaches from a hip that goes with it, and the ball beyond the ankle
        far = (math.sqrt(0.8**2 - (0.86 - high / k) ** 2) + b.vary(0.3, 0.03)) * k
        foot = b.last(f"{side}_foot").value
        place = b.local(foot)
        yaw = b.last(f"{side}_sole").value[0]
        begin = t + 0.35 * back
        b.air[side].append((begin, t + back + go + down))
        b.pelvis(t - 0.1, t + 0.6 * back, 0.8 * stance[0], -0.02, 0.0)
        b.move(f"{side}_foot", begin, t + back, b.world(place[0], 0.18 * k, place[2] - 0.45 * k))
        b.move(f"{side}_sole", t, t + back, (yaw, 48.0))
        b.turn(t, t + back, sign * 14.0, 6.0, 0.0)
        b.trunk(t, t + back, 6.0, 0.0, -sign * 10.0)
        b.reach(other, t, t + back, (0.3, -0.45, 0.62), arc=0.03)
        b.reach(side, t, t + back, (0.35, -0.8, -0.3), arc=0.0)
        b.look(t, t + back, 14.0)
        t += back
        b.move(f"{side}_foot", t, t + go, b.world(place[0] * 0.6, high, far))
        b.move(f"{side}_lift", t, t + 0.5 * go, (-0.1 * k,))  # the foot swings below the straight way
        b.move(f"{side}_lift", t + 0.5 * go, t + go, (0.0,))
        b.move(f"{side}_sole", t, t + go, (yaw, 18.0 - 75.0 * high / k))
        b.pelvis(t, t + go, 0.8 * stance[0], -0.025, 0.06 * k)
        b.turn(t - 0.05, t + go, -sign * 16.0, -12.0, 0.0)
        b.trunk(t, t + go, 9.0, 0.0, sign * 14.0)
        b.reach(other, t, t + go, (0.45, -0.55, -0.1), arc=0.05)
        b.reach(side, t, t + go, (0.5, -0.55, 0.3), arc=0.0)
        t += go + 0.03
        b.move(f"{side}_foot", t, t + down, foot)
        b.move(f"{side}_sole", t, t + down, (yaw, 0.0))
        b.pelvis(t, t + 0.7 * down, 0.6 * stance[0], -0.015, 0.0)
        b.turn(t, t + down, 0.0, 0.0, 0.0)
        b.trunk(t, t + down, 1.0)
        b.look(t, t + down)
        b.relax(t, t + 1.2 * down)
        t += down + abs(b.vary(0.15, 0.1))
    b.now = t
    b.rise(t - 0.1, t + b.beat(0.35))
    return start, t


def pick_up(b: Score) -> Span:
    """Something is picked up from the floor, with bent knees or a bent back."""
    k = b.who.height / 1.75
    side = b.hand
    sign = b.out(side)
    t = b.now
    start = t
    bend = float(b.rng.uniform(0.0, 1.0))  # 0 knees, 1 back
    go, hold, back = b.beat(1.0), b.beat(0.25, 0.3), b.beat(1.05)
    drop = (0.44 - 0.22 * bend) * k
    b.pelvis(t, t + go, sign * 0.02, -drop, -(0.16 + 0.05 * bend) * k)
    b.turn(t, t + go, -sign * 6.0, 32.0 + 18.0 * bend, 0.0)
    b.trunk(t, t + go, 34.0 + 14.0 * bend, 0.0, -sign * 10.0)
    b.look(t - 0.1, t + 0.8 * go, -10.0)
    b.reach(side, t, t + go, (sign * 0.1 * k, 0.16 * k, 0.36 * k), "stage")
    b.reach(b.other(side), t, t + go, (0.06, 0.10, -0.06), "knee")
    t += go + hold
    b.rise(t, t + back)
    b.reach(side, t, t + back, (-0.1, -0.5, 0.45))
    b.reach(b.other(side), t, t + back, b.hand_rest)
    t += back + b.beat(0.15)
    b.relax(t, t + b.beat(0.5), side)
    b.now = t + 0.4
    return start, b.now


# --- sitting -------------------------------------------------------------------------------------------


def sit(b: Score, seat: float, *, rung: float = 0.0, hands: str = "knee") -> Span:
    """Sit down on something behind.

    Parameters
    ----------
    seat
        Height of the seat, shares of the body's height.
    rung
        Height of what one foot is put on, metres; 0: both stay on the floor.
    hands
        Where they come to lie: "knee" or "edge".
    """
    who, k = b.who, b.who.height / 1.75
    t = b.now
    start = t
    root = (seat + 0.062) * who.height - who.standing
    back = -(0.26 + 0.55 * max(0.0, 0.40 - seat)) * k
    go = b.beat(1.15 + 0.5 * max(0.0, 0.4 - seat))
    half = t + 0.55 * go
    b.look(t - 0.1, t + 0.3 * go, 10.0, b.vary(0.0, 18.0))
    b.turn(t, half, 0.0, 16.0 - 30.0 * min(seat - 0.3, 0.2), 0.0)
    b.trunk(t, half, 30.0 - 60.0 * max(0.0, seat - 0.28))
    b.pelvis(t, t + go, 0.0, root, back)
    b.look(half, t + 1.2 * go, 3.0)
    b.turn(half, t + 1.2 * go, 0.0, -8.0, 0.0)
    b.trunk(half, t + 1.25 * go, 4.0 + b.vary(4.0, 3.0))
    for side in SIDES:
        if hands == "edge":
            b.reach(side, t + 0.2 * go, t + go, (0.17, -0.03, 0.03), "hip")
        else:
            b.reach(
                side, t + 0.3 * go, t + 1.2 * go, (b.vary(-0.01, 0.02), 0.085, b.vary(-0.13, 0.03)), "knee"
            )
    t += go
    if rung:
        side = b.hand
        foot = b.local(b.last(f"{side}_foot").value)
        place = b.world(foot[0], rung, foot[2] - 0.03 * k)
        steps.swing(
            b,
            side,
            t,
            t + b.beat(0.5),
            place,
            b.last(f"{side}_sole").value[0],
            lift=0.03,
            leave=8.0,
            arrive=0.0,
        )
        b.air[side].append((t, t + 1e9))  # closed when the performer rises
    b.now = t + b.beat(0.35)
    return start, b.now


def stand_up(b: Score) -> Span:
    """Rise from a seat: lean ahead, push up, straighten."""
    k = b.who.height / 1.75
    t = b.now
    start = t
    go = b.beat(1.2)
    for side in SIDES:
        if b.air[side] and b.air[side][-1][1] > 1e8:
            opened = b.air[side].pop()[0]
            down = b.beat(0.5)
            foot = b.home_feet[side]
            b.move(f"{side}_foot", t, t + down, foot)
            b.move(f"{side}_sole", t, t + down, (b.heading + b.out(side) * b.who.toe_out, 0.0))
            b.air[side].append((opened, t + down))
    if any(b.air[side] and b.air[side][-1][1] > t for side in SIDES):
        t += 0.42
    b.trunk(t, t + 0.45 * go, 22.0)
    b.turn(t, t + 0.45 * go, 0.0, 12.0, 0.0)
    b.look(t, t + 0.4 * go, -6.0)
    b.pelvis(t + 0.15 * go, t + go, 0.0, 0.0, 0.0)
    for side in SIDES:
        b.reach(side, t + 0.1 * go, t + 0.6 * go, (0.02, -0.8, 0.3 * k))
    b.relax(t + 0.6 * go, t + 1.15 * go)
    b.rise(t + 0.45 * go, t + 1.1 * go)
    b.now = t + 1.05 * go
    return start, b.now


def stool(b: Score) -> Span:
    """Onto a high stool, a look around, and down again."""
    keep_feet(b)
    seat = b.vary(0.405, 0.015)
    start, _ = sit(
        b,
        seat,
        rung=0.2 if b.way("rung", "yes", "yes", "no") == "yes" else 0.0,
        hands=b.way("stool", "knee", "knee", "edge"),
    )
    idle(b, b.beat(1.8, 0.5))
    _, end = stand_up(b)
    return start, end


def idle(b: Score, seconds: float) -> None:
    """Wait: look about, shift the weight a little."""
    end = b.now + seconds
    while b.now < end:
        span = min(b.beat(0.9, 0.3), max(end - b.now, 0.3))
        b.look(b.now, b.now + 0.75 * span, b.vary(2.0, 4.0), b.vary(0.0, 16.0))
        b.trunk(b.now, b.now + span, *(b.vary(0.0, 1.5) for _ in range(3)))
        b.now += span


def swing_legs(b: Score, times: int) -> Span:
    """Sitting high up, shanks swing to and fro, in turn or together."""
    who, k = b.who, b.who.height / 1.75
    t = b.now
    # knees over the edge: the ankle hangs below the end of the thigh
    thigh, shank = who.thigh / k, who.shank / k

    def place(angle: float) -> tuple[float, float, float]:
        a = math.radians(angle)
        return (0.02, -0.07 - shank * math.cos(a) * 0.99, thigh * 0.97 + shank * math.sin(a) * 0.99)

    ready = b.beat(0.6)
    for side in SIDES:
        b.air[side].append((t, t + 1e9))
        b.move(f"{side}_foot", t, t + ready, place(-4.0), "hip")
        b.move(f"{side}_sole", t, t + ready, (b.heading + b.out(side) * 5.0, 24.0))
    b.trunk(t, t + ready, b.vary(6.0, 5.0))
    t += ready
    start = t
    together = b.way("legs", "in turn", "in turn", "together") == "together"
    ahead, back = b.vary(34.0, 7.0) * who.size, b.vary(-18.0, 4.0) * who.size
    for number in range(times):
        span = b.beat(0.52)
        for side in SIDES:
            forth = (number + (side == "r" and not together)) % 2 == 0
            angle = b.vary(ahead if forth else back, 3.0)
            late = b.vary(0.0, 0.03)
            middle = 0.5 * (angle + (back if forth else ahead))
            foot = f"{side}_foot"
            begin, end = max(t + late, b.last(foot).t), t + late + span
            b.move(foot, begin, 0.5 * (begin + end), place(middle), "hip", through=True)
            b.move(foot, 0.5 * (begin + end), end, place(angle), "hip")
            b.move(f"{side}_sole", begin, end, (b.heading + b.out(side) * 5.0, 22.0 - 0.7 * angle))
        if b.rng.random() < 0.4:
            b.look(t, t + span, b.vary(6.0, 6.0), b.vary(0.0, 14.0))
        rock = 6.0 if number % 2 else -6.0  # the trunk answers the legs
        b.turn(
            t,
            t + span,
            0.0 if together else 0.5 * rock,
            -8.0 + b.vary(rock if together else 0.5 * rock, 1.0),
            0.0,
        )
        b.trunk(
            t,
            t + span,
            b.vary(5.0 + (rock if together else 0.5 * rock), 1.5),
            b.vary(0.0, 1.5),
            0.0 if together else -0.8 * rock,
        )
        t += span
    b.now = t + 0.05
    return start, b.now


def keep_feet(b: Score) -> None:
    """Remember where the feet stand, to come back to."""
    b.home_feet = {side: b.last(f"{side}_foot").value for side in SIDES}


def chin_seated(b: Score) -> Span:
    """Sitting, an elbow on the knee and the chin in the hand; the other hand on the other knee."""
    side = b.hand
    t = b.now
    start = t
    lean = b.beat(0.8)
    b.trunk(t, t + lean, b.vary(30.0, 4.0), 0.0, -b.out(side) * 8.0)
    b.turn(t, t + lean, 0.0, 4.0, 0.0)
    b.reach(side, t, t + lean, (0.03, b.vary(-0.10, 0.01), 0.12), "head", arc=0.08)
    b.move(f"{side}_swivel", t, t + lean, (b.vary(14.0, 4.0),))
    b.move(f"{side}_wrist", t, t + lean, (-30.0, 0.0, 0.0))
    b.look(t, t + lean, 2.0, b.vary(0.0, 6.0))
    t += lean
    end = t + b.beat(2.4, 0.25)
    while t < end:
        span = b.beat(0.9, 0.2)
        b.look(t, t + 0.7 * span, b.vary(2.0, 5.0), b.vary(0.0, 8.0), b.vary(0.0, 3.0))
        t += span
    up = b.beat(0.7)
    b.trunk(t, t + up, 6.0)
    b.turn(t, t + up, 0.0, -8.0, 0.0)
    b.reach(side, t, t + up, (0.0, 0.085, -0.12), "knee")
    b.move(f"{side}_swivel", t, t + up, (0.0,))
    b.now = t + up
    return start, b.now
