"""Tumbling: hands that carry, bodies that turn over. Each motion returns its start and end, seconds."""

from __future__ import annotations

import math

from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.limbs import (
    WRIST,
    crouch,
    hands,
    land,
    leg,
    legs,
    lift,
    on_foot,
    on_hands,
    palms,
    plant,
    root,
    still,
    tiptoe,
    under,
    unpalm,
)
from miburi.perform.bodies.score import SIDES, Score
from miburi.perform.bodies.steps import home, stand, walk

# --- in the air -----------------------------------------------------------------------------------------


def backflip(b: Score) -> Span:
    """Backwards through the air, tucked or piked, from both feet to both feet."""
    k, who = b.who.height / 1.75, b.who
    stand(b, b.stance("l"), b.stance("r"))
    still(b)
    t = b.now
    start = t
    ready = b.beat(0.55)
    hands(b, t, t + ready, (0.05, 0.75 if b.way("flip", "high", "low") == "high" else 0.1, 0.6))
    b.look(t, t + ready, -4.0)
    tiptoe(b, t, t + ready, 10.0)
    b.now = t + ready
    tiptoe(b, b.now, b.now + 0.25, 0.0)
    crouch(b, b.beat(0.48), b.vary(0.30, 0.03), 0.16, arms=(0.15, -0.8, -0.3))
    t, push = b.now, b.vary(0.3, 0.01)
    up = t + push
    root(b, t, up, on_foot(b, -10.0, 0.06 * k, 0.0), even=False)
    b.turn(t, up, 0.0, -30.0, 0.0)
    b.trunk(t, up, -14.0)
    b.look(t, up, -16.0)
    tiptoe(b, t + 0.4 * push, up, 48.0, rate=500.0)
    hands(b, t - 0.16, up + 0.06, (-0.02, 0.75, 0.5))
    far = b.vary(0.34, 0.06) * k
    span = b.vary(0.70, 0.02) * math.sqrt(k)
    down = up + span
    under(b, -far)
    b.fly(down, b.world(0.0, who.standing - 0.15 * k, 0.25 * who.ball_ahead - 0.14 * k), 0.0, -312.0, 0.0)
    for side in SIDES:
        lift(b, side, up)
    pike = b.way("tuck", "tuck", "tuck", "pike") == "pike"
    tuck = (0.02, -0.36, 0.56) if pike else (0.05, -0.44, 0.34)
    leg_ = (0.02, -0.82, -0.18)
    legs(b, up, up + 0.14 * span, leg_, 45.0, through=True)
    legs(b, up + 0.14 * span, up + 0.42 * span, tuck, 25.0)
    b.trunk(up, up + 0.45 * span, 26.0)
    b.trunk(up + 0.55 * span, down, 6.0)
    b.look(up, up + 0.4 * span, 6.0)
    b.look(up + 0.4 * span, down, -22.0)
    hands(b, up + 0.06, up + 0.6 * span, (-0.02, -0.4, 0.75))
    hands(b, up + 0.6 * span, down + 0.15, (0.2, -0.25, 0.8))
    b.revolved[0] -= 360.0
    for side in SIDES:
        yaw = b.heading + b.out(side) * who.toe_out
        plant(b, side, up + 0.62 * span, down, b.world(*b.stance(side, 1.1)), yaw)
    land(b, down, b.vary(0.28, 0.04), pitch=14.0)
    end = b.now
    home(b)
    return start, end


def jump_kick(b: Score) -> Span:
    """A step or two, off one foot, and the other leg kicks in the air."""
    k, who = b.who.height / 1.75, b.who
    count = int(b.rng.integers(1, 3))
    walk(b, count, length=0.5 * k, seconds=b.vary(0.46, 0.02))
    still(b)
    side = b.hand
    other = b.other(side)
    start = b.now
    crouch(b, b.beat(0.42), b.vary(0.22, 0.02), 0.08, arms=(0.15, -0.8, -0.3))
    t, push = b.now, b.vary(0.27, 0.01)
    up = t + push
    root(b, t, up, on_foot(b, 5.0, 0.03 * k), even=False)
    b.turn(t, up, 0.0, -2.0, 0.0)
    b.trunk(t, up, 2.0)
    b.look(t, up)
    tiptoe(b, t + 0.4 * push, up, 45.0, other)
    hands(b, t - 0.12, up + 0.1, (0.1, -0.4, 0.55))
    knee = (0.03, -0.42, 0.26)
    lift(b, side, t + 0.3 * push)
    leg(b, side, t + 0.3 * push, up + 0.05, knee, 25.0)
    span = b.vary(0.49, 0.02) * math.sqrt(k)
    down = up + span
    under(b, b.vary(0.5, 0.06) * k)
    b.fly(down, b.world(0.0, who.standing - 0.09 * k, 0.25 * who.ball_ahead - 0.02), 0.0, 4.0, 0.0)
    lift(b, other, up)
    leg(b, other, up, up + 0.5 * span, (0.04, -0.52, -0.12 if b.rng.random() < 0.5 else 0.16), 40.0)
    high = b.vary(-0.16, 0.1)
    far = math.sqrt(0.85**2 - high**2)
    leg(b, side, up + 0.02 * span, up + 0.47 * span, (0.02, high, far), 20.0)
    b.trunk(up, up + 0.45 * span, 8.0, 0.0, b.out(side) * 12.0)
    b.trunk(up + 0.5 * span, down, 6.0)
    b.reach(side, up, up + 0.9 * span, (0.3, -0.55, 0.2), arc=0.0, exact=True)
    b.reach(other, up, up + 0.8 * span, (-0.05, -0.15, 0.7), arc=0.0, exact=True)
    for s in SIDES:
        yaw = b.heading + b.out(s) * who.toe_out
        ahead = 0.12 * k if s == side else -0.08 * k
        late = 0.1 if s == side else 0.0
        plant(b, s, up + 0.5 * span, down + late, b.world(*b.stance(s, 1.2, ahead)), yaw)
    land(b, down, b.vary(0.2, 0.03), arms=(0.25, -0.35, 0.45))
    end = b.now
    home(b)
    return start, end


def hand_flip(b: Score) -> Span:
    """Forward over both hands: a step, the hands go down, the legs whip over, a short flight, both feet."""
    k, who = b.who.height / 1.75, b.who
    walk(b, int(b.rng.integers(1, 3)), length=0.5 * k, seconds=b.vary(0.46, 0.02))
    still(b)
    start = b.now
    side = b.hand
    other = b.other(side)
    t = b.now
    up = b.beat(0.44)
    hands(b, t, t + 1.1 * up, (0.05, 0.84, 0.4))
    lift(b, side, t + 0.2 * up)
    leg(b, side, t + 0.2 * up, t + up, (0.02, -0.58, 0.3), 20.0)
    root(b, t, t + up, on_foot(b, 4.0, 0.03 * k), even=False)
    b.turn(t, t + up, 0.0, -4.0, 0.0)
    b.trunk(t, t + up, -4.0)
    t += up
    step = b.beat(0.26)  # the long step
    ahead = 0.62 * k
    foot = b.world(b.out(side) * 0.05 * k, 0.0, ahead)
    plant(b, side, t, t + step, foot, b.heading, tip=-2.0)
    root(b, t, t + step, (0.0, who.standing - 0.16 * k, 0.30 * k), through=True)
    b.turn(t, t + step, 0.0, 32.0, 0.0, through=True, even=True)
    b.trunk(t, t + step, 12.0)
    t += step
    gap, palm = 0.19 * k, (0.0, WRIST * k, ahead + 0.77 * k)
    reach = b.beat(0.36)
    for s in SIDES:
        palms(b, s, t - 0.12, t + reach, b.out(s) * gap, palm[2])
    lift(b, other, t - 0.05)
    tiptoe(b, t - 0.25, t - 0.05, 40.0, other)
    leg(b, other, t - 0.05, t + reach, (0.03, -0.8, -0.22), 45.0)
    leg(b, other, t + reach, t + reach + 0.3, (0.03, -0.83, -0.12), 45.0)
    b.look(t, t + reach, -30.0)
    root(b, t, t + reach, on_hands(b, palm, (0.0, 116.0, 0.0), (16.0, 0.0, 0.0), 0.95, 0.6), through=True)
    b.turn(t, t + reach, 0.0, 116.0, 0.0, through=True, even=True)
    b.trunk(t, t + reach, 16.0)
    t += reach
    push = b.vary(0.22, 0.01)
    for pitch, bend, upright in ((152.0, -14.0, 0.3), (186.0, -20.0, 0.0), (226.0, -28.0, 0.25)):
        place = on_hands(b, palm, (0.0, pitch, 0.0), (bend, 0.0, 0.0), 0.96, upright)
        root(b, t, t + push, place, through=pitch < 200)
        b.turn(t, t + push, 0.0, pitch, 0.0, through=pitch < 200, even=True)
        b.trunk(t, t + push, bend)
        if pitch < 160:
            tiptoe(b, t - 0.2, t - 0.05, 50.0, side)
            lift(b, side, t - 0.05)
            leg(b, side, t - 0.05, t + 2.6 * push, (0.03, -0.82, -0.2), 45.0)
        t += push
    span = b.vary(0.34, 0.02)
    far = 0.78 * k
    down = t + span
    under(b, palm[2] + far)
    b.fly(down, b.world(0.0, who.standing - 0.1 * k, 0.25 * who.ball_ahead - 0.18 * k), 0.0, 334.0, 0.0)
    hands(b, t, down + 0.1, (0.05, 0.85, 0.2))
    unpalm(b, t)
    b.trunk(t, down, -10.0)
    b.look(t, down, -14.0)
    b.revolved[0] += 360.0
    for s in SIDES:
        plant(b, s, t, down, b.world(*b.stance(s, 1.1)), b.heading + b.out(s) * who.toe_out)
    land(b, down, b.vary(0.2, 0.03), arms=(0.2, 0.4, 0.6), pitch=20.0)
    end = b.now
    home(b)
    return start, end


# --- on the hands ---------------------------------------------------------------------------------------


def cartwheel(b: Score) -> Span:
    """Sideways over one hand and the other, legs apart."""
    k, who = b.who.height / 1.75, b.who
    still(b)
    start = b.now
    side = b.hand  # leads
    other, sign = b.other(side), b.out(side)
    t = b.now
    up = b.beat(0.5)
    hands(b, t, t + up, (0.25, 0.88, 0.1))
    b.look(t, t + up, -4.0)
    b.trunk(t, t + up, -2.0)
    lift(b, side, t + 0.4 * up)
    leg(b, side, t + 0.4 * up, t + up, (0.05, -0.72, 0.25), 20.0)
    root(b, t, t + up, (-sign * 0.04 * k, who.standing, 0.1 * k), even=False)
    b.turn(t, t + up, -sign * 25.0, 0.0, 0.0, through=True, even=True)
    t += up
    step, turned = b.beat(0.3, 0.05), -sign * 90.0
    lead = 0.5 * k
    plant(b, side, t, t + step, b.world(0.0, 0.0, lead), b.heading + 0.35 * turned, tip=-2.0)
    root(b, t, t + step, (0.0, who.standing - 0.14 * k, 0.36 * k), through=True)
    b.turn(t, t + step, 0.8 * turned, 0.0, -sign * 38.0, through=True, even=True)
    lift(b, other, t + 0.8 * step)
    tiptoe(b, t + 0.3 * step, t + 0.8 * step, 40.0, other)
    t += step
    first, second = lead + 0.52 * k, lead + 0.95 * k
    gap = b.vary(0.265, 0.012)
    straight = b.way("cartwheel", "straight", "straight", "bent") == "straight"
    far = (0.45, -0.70, 0.0) if straight else (0.34, -0.58, 0.2)
    leg(b, other, t - 0.2 * step, t + 1.2 * gap, far, 45.0)
    palms(b, side, t - 0.05, t + gap, 0.0, first, 0.8 * turned)
    b.trunk(t, t + 2 * gap, -4.0)
    b.look(t, t + gap, -28.0)
    root(b, t, t + gap, (0.0, 0.84 * k, lead + 0.06 * k), through=True)
    b.turn(t, t + gap, turned, 0.0, -sign * 92.0, through=True, even=True)
    t += gap
    palms(b, other, t - gap, t + gap, 0.0, second, 0.8 * turned)
    tiptoe(b, t - gap, t + 0.3 * gap, 50.0, side)
    lift(b, side, t + 0.3 * gap)
    leg(b, side, t + 0.3 * gap, t + 2.6 * gap, far, 45.0)
    middle = (0.0, WRIST * k, 0.5 * (first + second))
    for share, shift, upright in ((-132.0, -0.10, 0.6), (-172.0, 0.0, 0.0), (-212.0, 0.08, 0.4)):
        on = (0.0, middle[1], middle[2] + shift * k)
        place = on_hands(b, on, (turned, 0.0, sign * share), far=0.93, upright=upright)
        root(b, t, t + gap, place, through=True)
        b.turn(t, t + gap, turned, 0.0, sign * share, through=True, even=True)
        t += gap
    # the other foot comes down, then the leading one
    one, two = second + 0.52 * k, second + 0.92 * k
    b.reach(side, t - 0.3 * gap, t + 2 * gap, (0.35, 0.75, 0.1), arc=0.0, exact=True)
    unpalm(b, t - 0.3 * gap)
    root(b, t, t + gap, (0.0, 0.82 * k, one - 0.16 * k), through=True)
    b.turn(t, t + gap, turned * 1.05, 0.0, -sign * 268.0, through=True, even=True)
    plant(b, other, t - 0.8 * gap, t + 1.1 * gap, b.world(0.0, 0.0, one), b.heading + 1.3 * turned, tip=18.0)
    t += gap
    b.reach(other, t, t + 2 * gap, (0.35, 0.6, 0.1), arc=0.0, exact=True)
    unpalm(b, t)
    root(b, t, t + 1.3 * gap, (0.0, who.standing - 0.06 * k, one + 0.06 * k), through=True)
    b.turn(t, t + 1.3 * gap, turned * 1.15, 4.0, -sign * 325.0, through=True, even=True)
    t += 1.3 * gap
    plant(b, side, t - 1.6 * gap, t + 1.2 * gap, b.world(0.0, 0.0, two), b.heading + 1.2 * turned, tip=15.0)
    b.revolved[1] -= sign * 360.0
    b.heading += turned * 1.2
    b.settle()
    b.rise(t, t + b.beat(0.6))
    b.trunk(t, t + 0.4, 0.0)
    b.relax(t + 0.15, t + b.beat(0.9))
    b.now = t + b.beat(0.75)
    end = b.now
    home(b)
    return start, end


def _kick_up(b: Score, ahead: float, side: str) -> float:
    """Hands to the floor and one leg after the other up; returns when the body is above the hands."""
    k, who = b.who.height / 1.75, b.who
    other = b.other(side)
    t = b.now
    up = b.beat(0.55)
    hands(b, t, t + up, (0.0, 0.9, 0.2))
    b.look(t, t + up, -3.0)
    b.now = t + up
    t = b.now
    step = b.beat(0.4)
    lead = 0.36 * k
    lift(b, side, t)
    plant(b, side, t, t + step, b.world(b.out(side) * 0.06 * k, 0.0, lead), b.heading, tip=-2.0)
    root(b, t, t + step, (0.0, who.standing - 0.13 * k, 0.24 * k), through=True)
    b.turn(t, t + step, 0.0, 34.0, 0.0, through=True, even=True)
    b.trunk(t, t + step, 14.0)
    t += step
    down = b.beat(0.32)
    for s in SIDES:
        palms(b, s, t - 0.1, t + down, b.out(s) * 0.19 * k, ahead)
    tiptoe(b, t - 0.25, t, 45.0, other)
    lift(b, other, t)
    leg(b, other, t, t + down, (0.03, -0.8, -0.22), 40.0)
    palm = (0.0, WRIST * k, ahead)
    root(b, t, t + down, on_hands(b, palm, (0.0, 114.0, 0.0), (18.0, 0.0, 0.0), 0.95, 0.6), through=True)
    b.turn(t, t + down, 0.0, 114.0, 0.0, through=True, even=True)
    b.trunk(t, t + down, 18.0)
    b.look(t, t + down, -32.0)
    t += down
    swing = b.beat(0.46)
    tiptoe(b, t - 0.1, t + 0.15 * swing, 50.0, side)
    lift(b, side, t + 0.15 * swing)
    leg(b, other, t, t + swing, (0.03, -0.83, -0.1), 45.0)
    leg(b, side, t + 0.15 * swing, t + 1.7 * swing, (0.03, -0.835, 0.0), 45.0)
    for pitch, bend in ((148.0, 0.0), (174.0, -5.0)):
        upright = 0.4 if pitch < 150 else 0.0
        place = on_hands(b, palm, (0.0, pitch, 0.0), (bend, 0.0, 0.0), 0.95, upright)
        root(b, t, t + swing, place, through=pitch < 150)
        b.turn(t, t + swing, 0.0, pitch - b.rest_pitch, 0.0, through=pitch < 150, even=True)
        b.move("trunk", t, t + swing, (bend, 0.0, 0.0), exact=True)
        t += swing
    leg(b, other, t - swing, t + 0.1, (0.03, -0.835, 0.0), 45.0)
    return t


def _come_down(b: Score, t: float, ahead: float, side: str) -> float:
    """From above the hands back onto one foot and the other; returns when both stand."""
    k, who = b.who.height / 1.75, b.who
    other = b.other(side)
    palm = (0.0, WRIST * k, ahead)
    swing = b.beat(0.5)
    leg(b, side, t, t + swing, (0.03, -0.76, 0.36), 20.0)
    root(b, t, t + swing, on_hands(b, palm, (0.0, 145.0, 0.0), (2.0, 0.0, 0.0), 0.95, 0.4), through=True)
    b.turn(t, t + swing, 0.0, 145.0, 0.0, through=True, even=True)
    b.trunk(t, t + swing, 6.0)
    t += swing
    b.turn(t, t + swing, 0.0, 108.0, 0.0, through=True, even=True)
    root(b, t, t + swing, on_hands(b, palm, (0.0, 108.0, 0.0), (6.0, 0.0, 0.0), 0.95, 0.7), through=True)
    plant(
        b, side, t - 0.1, t + 0.8 * swing, b.world(b.out(side) * 0.06 * k, 0.0, 0.34 * k), b.heading, tip=25.0
    )
    t += swing
    plant(
        b,
        other,
        t - 0.3,
        t + 0.4 * swing,
        b.world(b.out(other) * 0.08 * k, 0.0, 0.12 * k),
        b.heading,
        tip=20.0,
    )
    root(b, t, t + swing, (0.0, who.standing - 0.12 * k, 0.2 * k), through=True)
    b.turn(t, t + swing, 0.0, 40.0, 0.0, through=True, even=True)
    unpalm(b, t - 0.05)
    hands(b, t - 0.05, t + swing, (0.1, -0.6, 0.5))
    t += swing
    b.settle()
    b.rise(t, t + 1.2 * swing)
    b.relax(t, t + 1.4 * swing)
    return t + 1.2 * swing


def handstand(b: Score) -> Span:
    """Up onto the hands, a hold that is not quite still, and down again."""
    k = b.who.height / 1.75
    start = b.now
    stand(b, b.stance("l"), b.stance("r"))
    still(b)
    side, ahead = b.hand, 1.18 * k
    t = _kick_up(b, ahead, side)
    palm = (0.0, WRIST * k, ahead)
    end = t + b.beat(1.5, 0.3)
    bent = b.way("stand", "straight", "straight", "split", "bent")
    while t < end:
        span = b.beat(0.55, 0.2)
        tilt = b.vary(178.0, 3.0)
        bend = b.vary(-6.0, 2.0)
        root(
            b,
            t,
            t + span,
            on_hands(b, palm, (b.vary(0.0, 1.0), tilt, 0.0), (bend, 0.0, 0.0), 0.95),
            through=True,
        )
        b.turn(t, t + span, b.vary(0.0, 1.5), tilt - b.rest_pitch, b.vary(0.0, 1.0), through=True, even=True)
        b.move("trunk", t, t + span, (bend, b.vary(0.0, 2.0), b.vary(0.0, 2.0)), exact=True)
        for s in SIDES:
            reach = {
                "straight": (0.03, -0.83, 0.0),
                "split": (0.04, -0.76, b.out(s) * 0.35),
                "bent": (0.06, -0.62, -0.16),
            }
            place = tuple(v + float(b.rng.normal(0.0, 0.012)) for v in reach[bent])
            leg(b, s, t, t + span, place, b.vary(42.0, 4.0))
        t += span
    t = _come_down(b, t, ahead, side)
    b.now = t
    home(b)
    return start, t


def hand_stand_kicks(b: Score, times: int) -> Span:
    """Hands on the floor, the legs kick up behind, together or one after the other, again and again."""
    k, who = b.who.height / 1.75, b.who
    stand(b, b.stance("l"), b.stance("r"))
    still(b)
    start = b.now
    t, ahead = b.now, 0.86 * k
    down = b.beat(0.7)
    for s in SIDES:
        palms(b, s, t + 0.2 * down, t + down, b.out(s) * 0.2 * k, ahead)
    low = (0.0, 0.74 * k, 0.08 * k)
    root(b, t, t + down, low, even=False)
    b.turn(t, t + down, 0.0, 82.0, 0.0)
    b.trunk(t, t + down, 30.0)
    b.look(t, t + down, -30.0)
    tiptoe(b, t + 0.5 * down, t + down, 30.0)
    t += down + b.beat(0.1)
    palm = (0.0, WRIST * k, ahead)
    way = b.way("kicks", "together", "in turn", "in turn")
    lead = b.hand
    home_feet = {s: b.last(f"{s}_foot").value for s in SIDES}
    for _ in range(times):
        push, up, fall = b.beat(0.36), b.beat(0.66), b.beat(0.7)
        root(b, t, t + push, (0.0, 0.68 * k, 0.05 * k), even=False)
        b.turn(t, t + push, 0.0, 66.0, 0.0)
        t += push
        high = b.vary(150.0, 8.0) * (1.0 if way == "together" else 1.03)
        for s in SIDES:
            late = 0.0 if way == "together" or s == lead else 0.4 * up
            tiptoe(b, t - 0.15, t + 0.1 + late, 50.0, s)
            lift(b, s, t + 0.1 + late)
            if way == "together":
                leg(b, s, t + 0.1, t + 0.65 * up, (0.05, -0.5, 0.24), 40.0, through=True)
                leg(b, s, t + 0.65 * up, t + 1.1 * up, (0.05, -0.8, -0.16), 40.0)
            else:
                leg(b, s, t + 0.1 + late, t + up + late, (0.05, -0.79, -0.22 if s == lead else -0.05), 40.0)
        place = on_hands(b, palm, (0.0, high, 0.0), (8.0, 0.0, 0.0), 0.93, 0.3)
        root(b, t, t + up, place, even=False)
        b.turn(t, t + up, 0.0, high, 0.0)
        b.trunk(t, t + up, b.vary(6.0, 3.0))
        t += up + 0.03
        root(b, t, t + fall, low, even=False)
        b.turn(t, t + fall, 0.0, 80.0, 0.0)
        b.trunk(t, t + fall, 30.0)
        for s in SIDES:
            late = 0.0 if way == "together" or s == lead else 0.1
            yaw = b.heading + b.out(s) * who.toe_out
            if way != "together":
                leg(b, s, t, t + 0.5 * fall + late, (0.05, -0.62, 0.3), 15.0, through=True)
            plant(b, s, max(t + 0.15, b.last(f"{s}_foot").t), t + fall + late, home_feet[s], yaw, tip=30.0)
        lead = b.other(lead)
        t += fall + 0.12
    up = b.beat(0.7)
    unpalm(b, t)
    b.rise(t, t + up)
    b.relax(t, t + 1.1 * up)
    b.now = t + up
    home(b)
    return start, t + up
