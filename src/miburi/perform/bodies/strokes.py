"""Swimming as in a capture studio: lying on a bench, or standing bent ahead (on the back: leaning back)."""

from __future__ import annotations

import math

from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.limbs import hands, leg, lift, plant, root, still, sweep, tiptoe
from miburi.perform.bodies.score import SIDES, Score, Vector
from miburi.perform.bodies.steps import home, stand

_BENCH = 0.6  # height of the bench, metres for a height of 1.75 m


def _place(angle: float, bend: float, wide: float = 0.06) -> Vector:
    """A hand on its way round the shoulder: 0° overhead, 90° ahead of the chest, 180° at the hip."""
    a = math.radians(angle)
    far = 0.93 * (1.0 - bend)
    return (wide, far * math.cos(a), far * math.sin(a))


def _onto(b: Score, back: bool, lying: bool) -> None:
    """Into the stroke's posture."""
    k = b.who.height / 1.75
    still(b)
    t = b.now
    if not lying:
        stand(b, b.stance("l", 1.4, 0.08 * k), b.stance("r", 1.4, -0.08 * k))
        still(b)
        t = b.now
        go = b.beat(0.8)
        if back:
            b.turn(t, t + go, 0.0, -8.0, 0.0)
            b.trunk(t, t + go, -10.0)
            b.look(t, t + go, -10.0)
            b.pelvis(t, t + go, 0.0, -0.06 * k, 0.04 * k)
        else:
            b.turn(t, t + go, 0.0, 46.0, 0.0)
            b.trunk(t, t + go, 22.0)
            b.look(t, t + go, -22.0)
            b.pelvis(t, t + go, 0.0, -0.1 * k, -0.16 * k)
        hands(b, t, t + go, _place(20.0, 0.05))
        b.now = t + go
        return
    go, up = b.beat(1.1), b.beat(0.7)
    if back:  # sit on the bench, lean back
        b.turn(t, t + go, 0.0, 20.0, 0.0, through=True, even=True)
        b.trunk(t, t + go, 20.0)
        root(b, t, t + go, (0.0, _BENCH * k, -0.22 * k))
        b.look(t, t + go, -4.0)
        hands(b, t, t + go, (0.15, -0.75, 0.3))
        t += go
        b.turn(t, t + up, 0.0, -86.0, 0.0)
        b.trunk(t, t + up, -2.0)
        b.look(t, t + up, 10.0)
        root(b, t, t + up, (0.0, _BENCH * k, -0.26 * k), even=False)
    else:  # the belly onto the bench
        b.turn(t, t + go, 0.0, 60.0, 0.0, through=True, even=True)
        b.trunk(t, t + go, 20.0)
        b.look(t, t + go, -16.0)
        root(b, t, t + go, (0.0, 0.78 * k, 0.16 * k), through=True)
        hands(b, t, t + go, (0.1, 0.1, 0.75))
        t += go
        b.turn(t, t + up, 0.0, 86.0, 0.0)
        b.trunk(t, t + up, -4.0)
        b.look(t, t + up, -30.0)
        root(b, t, t + up, (0.0, _BENCH * k, 0.3 * k), even=False)
    for s in SIDES:
        late = 0.0 if s == b.hand else 0.12
        tiptoe(b, t - 0.2, t + 0.2 * up + late, 40.0 if not back else 8.0, s)
        lift(b, s, t + 0.2 * up + late)
        leg(b, s, t + 0.2 * up + late, t + 1.2 * up + late, (0.04, -0.81, -0.02 if not back else 0.04), 45.0)
    hands(b, t, t + 1.2 * up, _place(12.0, 0.04))
    b.now = t + 1.3 * up


def _off(b: Score, back: bool, lying: bool) -> None:
    """Out of it, and stand."""
    k = b.who.height / 1.75
    t = b.now
    if lying:
        go, up = b.beat(0.8), b.beat(0.9)
        for s in SIDES:
            ahead = -0.02 * k if back else 0.0
            late = 0.0 if s == b.hand else 0.12
            yaw = b.heading + b.out(s) * b.who.toe_out
            foot = b.stance(s, 1.2, ahead)
            plant(b, s, t + late, t + go + late, b.world(*foot), yaw, tip=30.0 if not back else 4.0)
        hands(b, t, t + go, (0.12, -0.4, 0.65))
        if back:
            root(b, t, t + go, (0.0, _BENCH * k, -0.2 * k))
            b.turn(t, t + go, 0.0, 24.0, 0.0)
            b.trunk(t, t + go, 28.0)
            b.look(t, t + go, -4.0)
        else:
            root(b, t, t + go, (0.0, 0.78 * k, 0.14 * k), through=True)
            b.turn(t, t + go, 0.0, 58.0, 0.0)
            b.trunk(t, t + go, 22.0)
        t += go + 0.1
        b.rise(t, t + up)
        b.relax(t + 0.1, t + up)
        b.now = t + up
    else:
        up = b.beat(0.7)
        b.rise(t, t + up)
        b.relax(t, t + up)
        b.now = t + up
    b.move("spin", t, t + 0.5, (0.0,))
    home(b)


def _lying(b: Score) -> bool:
    return b.way("swim", "bench", "standing", "bench") == "bench"


def _kick(b: Score, side: str, start: float, end: float, high: float, back: bool) -> None:
    """One beat of a straight leg up or down (metres of the ankle against the line of the body)."""
    leg(b, side, start, end, (0.04, -0.80, high - (0.05 if not back else -0.05)), 45.0 + 60.0 * high)


def crawl(b: Score, times: int, back: bool) -> Span:
    """Arms go round in turn; the body rolls; legs beat."""
    lying = _lying(b)
    _onto(b, back, lying)
    t = b.now
    start = t - 0.4
    side = b.hand
    cycle = b.beat(1.35 if back else 1.25, 0.05)
    # degrees of the hand's way and how bent the arm is, at eighths of a cycle, from the catch on
    front = ((8, 0.0), (48, 0.1), (88, 0.3), (130, 0.24), (172, 0.04), (225, 0.38), (282, 0.42), (338, 0.16))
    rear = (
        (-6, 0.02),
        (-52, 0.16),
        (-98, 0.3),
        (-142, 0.22),
        (-178, 0.03),
        (-232, 0.0),
        (-280, 0.0),
        (-325, 0.0),
    )
    way = rear if back else front
    count = 8 * times
    step = cycle / 8
    for s in SIDES:
        shift = 0 if s == side else 4
        sweep(b, s, t, t + 2 * step, _stroke(way[shift], back))
    t += 2 * step
    end = t + count * step
    for number in range(count):
        s_t = t + number * step
        for s in SIDES:
            shift = 1 if s == side else 5
            value = _stroke(way[(number + shift) % 8], back)
            value = tuple(v + float(b.rng.normal(0.0, 0.012)) for v in value)
            b.move(
                f"{s}_hand", s_t, s_t + step, value, "arm", through=number + 1 < count, exact=True, even=True
            )
        if number % 4 == 3:
            sign = b.out(side) * (1.0 if (number // 4) % 2 == 0 else -1.0) * (-1.0 if back else 1.0)
            roll = 26.0 if lying else 14.0
            b.move("spin", s_t - 3 * step, s_t + step, (0.5 * roll * sign,))
            b.trunk(
                s_t - 3 * step,
                s_t + step,
                -4.0 if lying else (22.0 if not back else -10.0),
                0.0,
                0.8 * roll * sign,
            )
            breath = not back and b.rng.random() < 0.5
            b.look(s_t - 3 * step, s_t + step, -26.0 if not back else 10.0, sign * (46.0 if breath else 4.0))
        if lying:
            for s in SIDES:
                up = (number + (s == side)) % 2 == 0
                _kick(
                    b, s, s_t, s_t + step, (0.11 if up else -0.08) * b.vary(0.75 if back else 1.0, 0.1), back
                )
        elif number % 4 == 3:
            _dip(b, s_t - 3 * step, s_t + step, number // 4, back)
    b.now = end
    _off(b, back, lying)
    return start, end + 0.2


def _stroke(point: tuple[float, float], back: bool) -> Vector:
    angle, bend = point
    recovers = bend > 0.35 or (back and angle < -200)
    wide = 0.16 if back and not recovers else 0.26 if not back and recovers else 0.04
    return _place(angle, bend, wide)


def _dip(b: Score, start: float, end: float, number: int, back: bool) -> None:
    """Standing, the weight and the knees go with the strokes."""
    k = b.who.height / 1.75
    way = 1.0 if number % 2 else -1.0
    low, behind = (-0.07, 0.04) if back else (-0.1, -0.16)
    b.pelvis(start, end, 0.03 * way * k, (low + b.vary(0.0, 0.008)) * k, behind * k)
    b.turn(start, end, 3.0 * way, -8.0 if back else 46.0, 0.0)


def breast(b: Score, times: int) -> Span:
    """Hands shoot out, sweep apart and in under the chest; the legs draw up and kick round."""
    lying = _lying(b)
    _onto(b, False, lying)
    t = b.now
    start = t - 0.4
    for _ in range(times):
        cycle = b.beat(1.6, 0.05)
        out, pull, shoot = 0.32 * cycle, 0.26 * cycle, 0.42 * cycle
        hands(b, t, t + out, (b.vary(0.42, 0.04), 0.66, 0.34))
        t1 = t + out
        for s in SIDES:
            b.move(
                f"{s}_hand",
                t1,
                t1 + 0.55 * pull,
                (0.3, 0.2, 0.58),
                "arm",
                through=True,
                exact=True,
                even=True,
            )
            b.move(
                f"{s}_hand",
                t1 + 0.55 * pull,
                t1 + pull,
                (-0.16, -0.02, 0.5),
                "arm",
                through=True,
                exact=True,
                even=True,
            )
            b.move(f"{s}_hand", t1 + pull, t1 + pull + 0.75 * shoot, (-0.1, 0.9, 0.28), "arm", exact=True)
        rise = -24.0 if lying else 2.0
        b.trunk(t, t1 + pull, rise)
        b.look(t, t1 + pull, -34.0)
        b.trunk(t1 + pull, t1 + pull + shoot, -2.0 if lying else 22.0)
        b.look(t1 + pull, t1 + pull + shoot, -12.0)
        if lying:
            for s in SIDES:
                late = abs(b.vary(0.0, 0.01))
                leg(b, s, t1 - 0.1, t1 + pull + late, (0.14, -0.40, -0.16), -5.0)
                leg(b, s, t1 + pull + late, t1 + pull + 0.3 * shoot, (0.34, -0.60, -0.10), 5.0, through=True)
                leg(b, s, t1 + pull + 0.3 * shoot, t1 + pull + 0.75 * shoot, (0.03, -0.81, -0.03), 50.0)
        else:
            k = b.who.height / 1.75
            b.pelvis(t, t1 + pull, 0.0, (-0.17 + b.vary(0.0, 0.01)) * k, -0.14 * k)
            b.pelvis(t1 + pull, t1 + pull + shoot, 0.0, -0.07 * k, -0.14 * k)
        t += cycle + 0.02
    b.now = t
    _off(b, False, lying)
    return start, t + 0.2


def fly(b: Score, times: int) -> Span:
    """Both arms round together, a wave runs through the trunk, the legs beat twice a stroke."""
    lying = _lying(b)
    _onto(b, False, lying)
    t = b.now
    start = t - 0.4
    cycle = b.beat(1.35, 0.05)
    way = ((8, 0.0), (45, 0.08), (85, 0.28), (130, 0.26), (172, 0.06), (228, 0.06), (285, 0.08), (335, 0.06))
    wide = (0.1, 0.25, 0.0, -0.05, 0.12, 0.5, 0.62, 0.3)
    step = cycle / 8
    count = 8 * times
    for number in range(count):
        s_t = t + number * step
        p = (number + 1) % 8
        for s in SIDES:
            angle, bend = way[p]
            value = _place(angle, bend, wide[p])
            if p in (5, 6):  # over the water, low and wide
                value = (0.72, value[1], -0.12)
            value = tuple(v + float(b.rng.normal(0.0, 0.012)) for v in value)
            b.move(
                f"{s}_hand", s_t, s_t + step, value, "arm", through=number + 1 < count, exact=True, even=True
            )
        if number % 4 == 3:
            up = (number // 4) % 2 == 0
            low = -14.0 if lying else 10.0
            high = 10.0 if lying else 28.0
            b.trunk(s_t - 3 * step, s_t + step, low if up else high)
            b.look(s_t - 3 * step, s_t + step, -38.0 if up else -4.0)
            if lying:
                for s in SIDES:
                    _kick(b, s, s_t - 3 * step, s_t - step, b.vary(0.20, 0.02), False)
                    _kick(b, s, s_t - step, s_t + step, b.vary(-0.14, 0.02), False)
                b.turn(s_t - 3 * step, s_t - step, 0.0, 80.0, 0.0)
                b.turn(s_t - step, s_t + step, 0.0, 92.0, 0.0)
            else:
                k = b.who.height / 1.75
                b.pelvis(s_t - 3 * step, s_t - step, 0.0, -0.16 * k, -0.14 * k)
                b.pelvis(s_t - step, s_t + step, 0.0, -0.08 * k, -0.16 * k)
    t += count * step
    b.now = t
    _off(b, False, lying)
    return start, t + 0.2
