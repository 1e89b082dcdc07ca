"""Motions of the upper body, standing. Each returns when its annotated part began and ended, seconds."""

from __future__ import annotations

import math

from miburi.perform.bodies.score import Score, Vector
from miburi.perform.bodies.steps import home, stand, swing

Span = tuple[float, float]


def punch(b: Score, times: int, side: str = "r") -> Span:
    """Punches out of a guard, the other foot ahead: straight, hooked or upwards, with shoulder and hip."""
    who, k, other = b.who, b.who.height / 1.75, b.other(side)
    m = -b.out(side)  # towards the other side
    half = 0.1 * k * who.stance
    deep = b.vary(0.15, 0.03) * k
    places = {
        s: (b.out(s) * half, 0.0, who.ball_ahead + (deep if s == other else -deep)) for s in (side, other)
    }
    toes = {other: -14.0 * m, side: -32.0 * m}
    stand(b, places["l"], places["r"], yaws=(toes["l"], toes["r"]), seconds=0.38)
    t = b.now
    low = -0.035 - 0.02 * b.rng.random()
    ready = b.beat(0.4)
    bounce = b.rng.random() < 0.5

    def guard(s: float, e: float) -> None:
        b.pelvis(s, e, 0.0, low, 0.02)
        b.turn(s, e, -28.0 * m, 4.0, 0.0)
        b.trunk(s, e, 7.0, 0.0, 4.0 * m)
        b.look(s, e, -8.0, 22.0 * m)
        b.reach(side, s, e, (-0.12, 0.08, 0.38), arc=0.0)
        b.reach(other, s + 0.05, e, (-0.08, 0.04, 0.58), arc=0.0)

    guard(t - 0.15, t + ready)
    start = t
    t += ready + 0.1
    kind = b.way("punch", "straight", "straight", "hook", "upper")
    for _ in range(times):
        back, out, again = b.beat(0.22), b.beat(0.32), b.beat(0.42)
        if bounce:
            b.pelvis(t, t + 0.8 * back, -0.02 * m, low - 0.02, 0.0)
        high = {"straight": 0.80, "hook": 0.82, "upper": 0.86}[kind] * who.height + b.vary(0.0, 0.05) * k
        far = (0.95 * who.arm + 0.14 * k) * (1.0 if kind == "straight" else 0.8) * b.vary(1.0, 0.04)
        across = 0.16 * k if kind == "hook" else b.vary(0.04, 0.04)
        out *= 1.35 if kind == "hook" else 1.0
        b.reach(side, t, t + back, (-0.06, -0.25 if kind == "upper" else 0.02, 0.28), arc=0.0)
        b.turn(t, t + back, -33.0 * m, 4.0, 0.0)
        b.trunk(t, t + back, 7.0, 0.0, -4.0 * m)
        t += back
        b.turn(t - 0.04, t + 0.9 * out, 8.0 * m * who.size, 5.0, 0.0)
        b.trunk(t - 0.02, t + out, 9.0, 0.0, 34.0 * m * who.size)
        b.look(t, t + out, -8.0, -22.0 * m)
        b.pelvis(t - 0.04, t + out, 0.02 * m, low - 0.01, 0.07 * k)
        b.move(f"{side}_sole", t - 0.04, t + 0.85 * out, (b.heading - 14.0 * m, 30.0))
        if kind == "hook":
            b.move(f"{side}_swivel", t, t + out, (55.0,))
        arc = {"straight": 0.0, "hook": 0.12, "upper": -0.05}[kind]
        b.reach(side, t, t + out, (m * across, high, far), "stage", arc=arc)
        b.reach(other, t, t + out, (-0.1, 0.1, 0.4), arc=0.0)
        t += out + 0.03
        guard(t, t + again)
        b.move(f"{side}_swivel", t, t + again, (0.0,))
        b.move(f"{side}_sole", t, t + again, (b.heading + b.out(side) * who.toe_out + toes[side], 0.0))
        t += again + abs(b.vary(0.12, 0.08))
    b.now = t
    b.relax(t, t + b.beat(0.55))
    home(b)
    return start, t


def wash(b: Score, times: int, up_and_down: bool) -> Span:
    """A cloth in the right hand on a window: strokes from side to side (1), up and down or in circles (2)."""
    who, k = b.who, b.who.height / 1.75
    pane = b.vary(0.56, 0.03) * k
    left_edge, right_edge = 0.20 * k * who.size, -0.52 * k * who.size
    top, bottom = 0.98 * who.height * b.vary(1.0, 0.02), 0.62 * who.height
    if b.rng.random() < 0.5:
        wide, apart = b.rng.uniform(1.2, 2.0), b.rng.normal(0.0, 0.06) * k
        stand(b, b.stance("l", wide, apart), b.stance("r", wide, -apart))
    t = b.now
    ready = b.beat(0.85)
    circles = up_and_down and b.way("wash 2", "strokes", "strokes", "circles") == "circles"
    # the other hand hangs, leans on the pane or holds on to the hip
    other = b.way("wash", "hang", "hang", "pane", "hip")
    x = left_edge if not up_and_down else right_edge * 0.8
    y = top
    b.reach("r", t, t + ready, (x, y, pane), "stage", arc=0.15)
    b.move("r_wrist", t, t + ready, (-42.0, 0.0, 20.0))
    if other == "pane":
        b.reach("l", t, t + ready, (0.3 * k, 0.78 * who.height, pane), "stage")
        b.move("l_wrist", t, t + ready, (-50.0, 0.0, 0.0))
    elif other == "hip":
        b.reach("l", t, t + ready, (0.14, 0.12, 0.05), "hip")
        b.move("l_swivel", t, t + ready, (30.0,))
    lean = abs(b.vary(11.0, 5.0))
    b.trunk(t, t + ready, lean, 0.0, 8.0)
    b.pelvis(t, t + ready, -0.02, -0.01, 0.03)
    start = t
    t += ready
    stroke = b.beat(0.76)

    def follow(s: float, e: float, x: float, y: float) -> None:
        side = (x - 0.5 * (left_edge + right_edge)) / (left_edge - right_edge)  # −0.5 … 0.5
        b.pelvis(s, e, 0.09 * side * k, -0.01 - 0.05 * max(0.0, 0.75 - y / who.height), 0.03)
        b.turn(s, e, 12.0 * side, 2.0 + 22.0 * max(0.0, 0.72 - y / who.height), 0.0)
        b.trunk(s, e, lean + 30.0 * max(0.0, 0.8 - y / who.height), 6.0 * side, 22.0 * side)
        b.look(s, e, -50.0 * (y / who.height - 0.9), 20.0 * side)

    if circles:
        radius, y = b.vary(0.15, 0.02) * k, 0.80 * who.height
        turns, across = 8, b.vary(0.06, 0.02) * k
        for number in range(times):
            x0 = 0.12 * k - across * 1.6 * number
            follow(t, t + 2 * stroke, x0, y)
            for corner in range(turns):
                angle = 2 * math.pi * corner / turns
                place = (
                    x0 - radius * math.sin(angle) - across * corner / turns,
                    y + radius * 1.1 * math.cos(angle),
                    pane,
                )
                e = t + 1.7 * stroke / turns
                b.reach("r", t, e, place, "stage", through=True, exact=True)
                t = e
    else:
        for number in range(times):
            for back in (False, True):
                if up_and_down:
                    y = top if back else bottom * b.vary(1.0, 0.03)
                    x += (0.05 if back else 0.02) * k
                else:
                    x = left_edge if back else right_edge * b.vary(1.0, 0.06)
                    y = top - (top - bottom) * (number + 0.5 * back) / max(times, 2)
                e = t + stroke * b.vary(1.0, 0.06)
                follow(t - 0.05, e, x, y)
                b.reach("r", t, e, (x, y, pane), "stage")
                t = e + 0.02
    b.now = t
    b.relax(t, t + b.beat(0.7))
    b.rise(t, t + b.beat(0.6))
    b.now = t + 0.4
    home(b)
    return start, t


def point(b: Score, times: int, side: str = "r") -> Span:
    """An arm points: ahead, to the side or up; eyes and trunk go with it."""
    m = -b.out(side)
    t = b.now
    start = t
    base = b.rng.choice([0.0, -35.0, -70.0, 20.0])
    for number in range(times):
        azimuth = float(base + b.rng.normal(0.0, 9.0) - 25.0 * number)
        height = float(b.rng.normal(6.0, 9.0))
        a, e = math.radians(azimuth), math.radians(height)
        rise = b.beat(0.55)
        twist = max(-25.0, min(12.0, 0.3 * azimuth))
        b.look(t - 0.1, t + 0.7 * rise, -0.5 * height, m * (0.6 * azimuth - twist))
        b.trunk(t, t + rise, 1.0, 0.0, m * twist)
        b.turn(t, t + rise, m * 0.2 * azimuth, 0.0, 0.0)
        b.pelvis(t, t + rise, -0.015 * m, 0.0, 0.012)
        a -= math.radians(twist + 0.2 * azimuth)
        value = (-math.sin(a) * math.cos(e) * 0.97, math.sin(e) * 0.97, math.cos(a) * math.cos(e) * 0.97)
        b.reach(side, t, t + rise, value, arc=0.08)
        b.move(f"{side}_wrist", t, t + rise, (-4.0, 4.0, 10.0))
        t += rise
        hold = b.beat(0.55, 0.3)
        if b.rng.random() < 0.5:  # a little beat for emphasis
            b.reach(side, t, t + 0.4 * hold, (value[0] * 0.9, value[1] - 0.05, value[2] * 0.92), arc=0.0)
            b.reach(side, t + 0.4 * hold, t + 0.8 * hold, value, arc=0.0)
        t += hold
        if number + 1 < times and b.rng.random() < 0.5:
            continue
        down = b.beat(0.65)
        b.relax(t, t + down, side)
        b.rise(t, t + down)
        t += down + abs(b.vary(0.05, 0.1))
    b.relax(t, t + 0.5, side)
    b.rise(t, t + 0.5)
    b.now = t + 0.1
    return start, t


def chin(b: Score) -> Span:
    """Thinking: a hand at the chin, the other arm across the body holds the elbow, or hangs; small nods."""
    t = b.now
    start = t
    side = b.hand
    rise = b.beat(0.8)
    held = b.way("chin", "held", "held", "hangs") == "held"
    b.reach(side, t, t + rise, _chin(b), "head", arc=0.12)
    b.move(f"{side}_wrist", t, t + rise, (30.0, 0.0, 0.0))
    if held:
        b.reach(b.other(side), t + 0.1, t + rise, (b.vary(-0.5, 0.04), b.vary(-0.55, 0.04), 0.31), arc=0.05)
        b.move(f"{side}_swivel", t, t + rise, (b.vary(-42.0, 5.0),))
    else:
        b.move(f"{side}_swivel", t, t + rise, (b.vary(-34.0, 8.0),))
    b.trunk(t, t + rise, 3.0, b.vary(0.0, 2.0), b.vary(0.0, 3.0))
    b.look(t, t + rise, 11.0, b.vary(0.0, 9.0), b.out(side) * -4.0)
    b.pelvis(t, t + rise, b.vary(0.0, 0.025), -0.004, 0.0)
    t += rise
    end = t + b.beat(2.6, 0.25)
    while t < end:
        span = b.beat(0.9, 0.2)
        b.look(t, t + 0.7 * span, b.vary(9.0, 6.0), b.vary(0.0, 11.0), b.vary(0.0, 4.0))
        t += span
    down = b.beat(0.8)
    b.relax(t, t + down)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def _chin(b: Score) -> Vector:
    """The wrist when the fingers touch the chin, in the head's frame."""
    return (b.vary(0.035, 0.01), b.vary(-0.10, 0.012), b.vary(0.125, 0.01))


def drink(b: Score, times: int) -> Span:
    """A can, from a table or held already, to the mouth; the head goes back; each sip ends lower."""
    side, k = b.hand, b.who.height / 1.75
    t = b.now
    start = t
    sign = b.out(side)
    if b.way("drink", "fetch", "held") == "fetch":
        fetch = b.beat(0.75)
        b.reach(side, t, t + fetch, (sign * 0.2 * k, 0.6 * b.who.height, 0.42 * k), "stage")
        b.trunk(t, t + fetch, 8.0, 0.0, -sign * 6.0)
        b.look(t, t + fetch, 18.0, sign * 8.0)
        t += fetch + 0.15
    waist = (-0.08, b.vary(-0.48, 0.05), 0.45)
    lift = b.beat(0.6)
    b.reach(side, t, t + lift, waist, arc=0.03)
    b.trunk(t, t + lift, 0.0)
    b.look(t, t + lift, 6.0)
    t += lift + abs(b.vary(0.1, 0.1))
    for number in range(times):
        up, sip, down = b.beat(0.8), b.beat(0.9, 0.25), b.beat(0.75)
        b.reach(
            side,
            t,
            t + up,
            (b.vary(0.075, 0.01), b.vary(-0.02, 0.012), b.vary(0.185, 0.01)),
            "head",
            arc=0.05,
        )
        b.move(f"{side}_swivel", t, t + up, (b.vary(-34.0, 10.0),))
        b.move(f"{side}_wrist", t, t + up, (10.0, -12.0, -15.0))
        b.look(t + 0.4 * up, t + up + 0.15, -14.0)
        b.trunk(t + 0.3 * up, t + up + 0.1, -4.0)
        t += up
        b.look(t + 0.15, t + sip, b.vary(-16.0, 4.0))
        b.reach(side, t, t + sip, (0.065, 0.035, 0.185), "head", arc=0.0)
        t += sip
        b.look(t, t + 0.7 * down, 3.0)
        b.trunk(t, t + down, 0.0)
        b.move(f"{side}_swivel", t, t + down, (0.0,))
        if number + 1 < times:
            b.reach(side, t, t + down, waist, arc=0.03)
        else:
            b.relax(t, t + 1.2 * down, side)
        t += down + abs(b.vary(0.1, 0.1))
    b.rise(t - 0.2, t + 0.3)
    b.now = t + 0.2
    return start, b.now


def wave(b: Score, times: int) -> Span:
    """A raised hand waves from the elbow."""
    side = b.hand
    t = b.now
    start = t
    up = b.beat(0.55)
    wide = 0.17 * b.who.size
    high, out = b.vary(0.42, 0.1), 0.54
    b.reach(side, t, t + up, (out - wide, high, 0.3), arc=0.12)
    b.move(f"{side}_swivel", t, t + up, (10.0,))
    b.look(t, t + up, -3.0)
    b.trunk(t, t + up, -1.0, -b.out(side) * 2.0)
    t += up
    for _ in range(times):
        for sign in (1.0, -1.0):
            span = b.beat(0.27)
            b.reach(side, t, t + span, (out + sign * wide, high - 0.04 * sign, 0.3), arc=0.0)
            t += span
    down = b.beat(0.65)
    b.relax(t, t + down, side)
    b.move(f"{side}_swivel", t, t + down, (0.0,))
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def clap(b: Score, times: int) -> Span:
    """Hands meet in front of the chest."""
    t = b.now
    start = t
    up = b.beat(0.55)
    high, near = b.vary(-0.18, 0.06), b.vary(0.62, 0.05)
    gap = 0.16 * b.who.size
    middle = -0.24
    for side in "lr":
        b.reach(side, t, t + up, (middle + gap, high, near), arc=0.06)
        b.move(f"{side}_wrist", t, t + up, (0.0, -35.0, 0.0))  # fingers ahead, palms towards each other
    b.trunk(t, t + up, 2.0)
    t += up
    for _ in range(times):
        shut, out = b.beat(0.17), b.beat(0.22)
        for side in "lr":
            b.reach(side, t, t + shut, (middle - 0.02, high, near), arc=0.0, exact=True)
        t += shut
        for side in "lr":
            b.reach(side, t, t + out, (middle + gap * b.vary(1.0, 0.15), high, near), arc=0.0)
        t += out
    down = b.beat(0.6)
    b.relax(t, t + down)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def throw(b: Score) -> Span:
    """An overarm throw: the hand goes back and up, the other foot steps out, the trunk unwinds, the arm
    follows."""
    side, k = b.hand, b.who.height / 1.75
    sign, other = b.out(b.hand), b.other(b.hand)
    t = b.now
    start = t
    wind = b.beat(0.75)
    b.reach(side, t, t + wind, (0.5, 0.28, -0.22), arc=0.1)
    b.move(f"{side}_swivel", t, t + wind, (25.0,))
    b.reach(other, t, t + wind, (-0.05, -0.05, 0.75), arc=0.06)
    b.turn(t, t + wind, sign * 24.0, -2.0, 0.0)
    b.trunk(t, t + wind, -5.0, sign * 4.0, sign * 24.0)
    b.look(t, t + wind, -4.0, -sign * 40.0)
    b.pelvis(t, t + 0.6 * wind, sign * 0.05, -0.015, -0.03)
    b.pelvis(t + 0.6 * wind, t + wind, sign * 0.02, -0.05, 0.06 * k)
    step = b.local(b.last(f"{other}_foot").value)
    place = b.world(step[0], 0.0, step[2] + 0.34 * k * b.who.size)
    swing(
        b, other, t + 0.55 * wind, t + wind + 0.1, place, b.heading + b.out(other) * b.who.toe_out, lift=0.07
    )
    t += wind + 0.02
    go = b.beat(0.36)
    b.turn(t - 0.15, t + 0.8 * go, -sign * 14.0, 7.0, 0.0)
    b.trunk(t - 0.06, t + 1.2 * go, 16.0, -sign * 3.0, -sign * 18.0)
    b.look(t, t + go, -14.0, sign * 22.0)
    b.pelvis(t, t + 1.6 * go, -sign * 0.02, -0.05, 0.17 * k)
    b.move(f"{side}_sole", t, t + go + 0.1, (b.heading + sign * 4.0, 32.0))
    b.reach(side, t, t + 0.65 * go, (0.18, 0.55, 0.6), through=True)
    b.reach(side, t + 0.65 * go, t + 1.7 * go, (-0.35, -0.5, 0.6))
    b.reach(other, t, t + 1.2 * go, (0.25, -0.6, 0.0), arc=0.05)
    t += 1.7 * go + b.beat(0.12)
    end = t + b.beat(0.45)
    b.relax(t, end)
    b.trunk(t, end, 0.0)
    b.turn(t, end, 0.0, 0.0, 0.0)
    b.look(t, end)
    b.move(f"{side}_sole", t - 0.1, t + 0.25, (b.heading + sign * b.who.toe_out, 0.0))
    b.now = t + 0.2
    home(b)
    return start, b.now
