"""More motions that no keyword asks for, near to one that is asked for. Each returns its start and end, seconds."""

from __future__ import annotations

import math

from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.limbs import (
    crouch,
    hands,
    land,
    leg,
    legs,
    lift,
    on_foot,
    plant,
    root,
    still,
    tiptoe,
    under,
)
from miburi.perform.bodies.score import SIDES, Score
from miburi.perform.bodies.steps import home, stand, swing, turn_round


def run(b: Score, count: int) -> Span:
    """Some running steps, both feet in the air between them, and to a stand."""
    who, k = b.who, b.who.height / 1.75
    still(b)
    t = b.now
    start = t
    side = b.hand
    beat = b.beat(0.34, 0.03)
    length = b.vary(0.78, 0.06) * k * who.size
    b.trunk(t, t + 0.4, 9.0)
    for s in SIDES:
        b.move(f"{s}_swivel", t, t + 0.3, (12.0,))
    at = 0.0
    for number in range(count + 2):
        last = number >= count
        ahead = length * (0.6 if number == 0 else 0.45 if number == count else 1.0) * (number <= count)
        at += ahead
        other = b.other(side)
        # the foot is in the air for more than a step's time, so that both are between two steps
        up = t - (0.28 * beat if 0 < number <= count else 0.0)
        x = b.out(side) * (0.05 if not last else 0.1 * who.stance) * k
        goal = b.world(x, 0.0, at + who.ball_ahead)
        swing(b, side, up, t + beat, goal, b.heading + b.out(side) * 5.0, lift=0.03 if last else 0.2 * k,
              leave=55.0 if not last else 25.0, arrive=0.0 if last else -6.0)  # fmt: skip
        rise = -0.045 * k if not last else -0.02 * k
        b.pelvis(t, t + 0.5 * beat, 0.0, 0.03 * k, at - 0.55 * ahead, through=True, even=True)
        b.pelvis(
            t + 0.5 * beat,
            t + beat,
            0.0,
            rise,
            at - (0.12 * k if not last else 0.0),
            through=not last,
            even=True,
        )
        b.turn(t, t + beat, -b.out(side) * 8.0 * (not last), 6.0 * (not last), 0.0)
        b.trunk(t, t + beat, 8.0 * (not last), 0.0, b.out(side) * 10.0 * (not last))
        for s, value in ((side, (0.1, -0.62, -0.3)), (other, (-0.05, -0.3, 0.5))):
            if last:
                b.relax(t, t + 1.5 * beat, s)
            else:
                b.move(f"{s}_hand", t, t + beat, value, "arm")
        t += beat
        side = other
    under(b, at)
    b.now = t + 0.15
    b.settle()
    b.rise(b.now - 0.1, b.now + 0.4)
    for s in SIDES:
        b.move(f"{s}_swivel", b.now, b.now + 0.3, (0.0,))
    end = b.now + 0.2
    home(b)
    return start, end


def turn(b: Score, times: int) -> Span:
    """A turn on the spot by small steps."""
    still(b)
    start = b.now
    turn_round(b, float(b.rng.choice([-1.0, 1.0]) * b.rng.uniform(70.0, 190.0)))
    return start, b.now


def catch(b: Score, times: int) -> Span:
    """Both hands go out to something that comes, give way and hold it."""
    t = b.now
    start = t
    go, give, hold = b.beat(0.42), b.beat(0.3), b.beat(0.4, 0.3)
    high, aside = b.vary(-0.2, 0.22), b.vary(0.0, 0.12)
    one = b.way("catch", "both", "both", "one") == "one"
    b.look(t - 0.05, t + 0.3, -8.0 - 20.0 * high, 30.0 * aside)
    for s in SIDES:
        if one and s != b.hand:
            b.reach(s, t, t + go, (0.25, -0.7, 0.3))
            continue
        x = (-0.2 if not one else 0.0) + b.out(s) * aside
        b.reach(s, t, t + go, (x, high, b.vary(0.78, 0.03)), arc=0.04)
        b.move(f"{s}_wrist", t, t + go, (0.0, -25.0, 0.0))  # fingers ahead and apart
    b.pelvis(t, t + go, 0.5 * aside, -0.04, 0.03)
    b.trunk(t, t + go, 6.0, 0.0, 30.0 * aside)
    t += go + 0.05
    for s in SIDES:
        if one and s != b.hand:
            continue
        b.reach(s, t, t + give, (-0.2, min(high, 0.0) - 0.2, 0.48), arc=0.0)
        b.move(f"{s}_wrist", t, t + give, (0.0, -38.0, 0.0))
    b.pelvis(t, t + give, 0.2 * aside, -0.06, -0.02)
    b.trunk(t, t + give, 12.0)
    b.look(t, t + give, 16.0)
    t += give + hold
    down = b.beat(0.7)
    b.relax(t, t + down)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def look_around(b: Score, times: int) -> Span:
    """The head turns from side to side, then the trunk with it; a hand over the eyes now and then."""
    t = b.now
    start = t
    shade = b.rng.random() < 0.35
    if shade:
        b.reach(b.hand, t, t + 0.8, (b.vary(0.05, 0.01), 0.10, 0.13), "head", arc=0.1)
        b.move(f"{b.hand}_wrist", t, t + 0.8, (20.0, 0.0, 0.0))
    way = 1.0 if b.rng.random() < 0.5 else -1.0
    for _ in range(times + 1):
        go = b.beat(0.8, 0.15)
        far = b.vary(48.0, 8.0) * way
        b.look(t, t + 0.8 * go, b.vary(0.0, 8.0), far)
        b.trunk(t + 0.1, t + go, 1.0, 0.0, 0.4 * far)
        b.turn(t + 0.1, t + go, 0.15 * far, 0.0, 0.0)
        b.pelvis(t + 0.1, t + go, 0.02 * way, -0.004, 0.0)
        t += go + b.beat(0.45, 0.4)
        way = -way
    back = b.beat(0.7)
    b.rise(t, t + back)
    if shade:
        b.relax(t, t + back, b.hand)
    b.now = t + 0.9 * back
    return start, b.now


def wave_both(b: Score, times: int) -> Span:
    """Both arms overhead, from side to side or apart and together."""
    t = b.now
    start = t
    up = b.beat(0.75)
    along = b.way("wave both", "along", "apart") == "along"
    for s in SIDES:
        b.reach(s, t, t + 0.5 * up, (0.7, 0.0, 0.4), through=True, exact=True)
        b.reach(s, t + 0.5 * up, t + up, (0.15, 0.82, 0.25), arc=0.0, exact=True)
    b.look(t, t + up, -6.0)
    t += up
    for _ in range(times):
        for sign in (1.0, -1.0):
            span = b.beat(0.36)
            for s in SIDES:
                lean = b.out(s) * sign if along else sign
                b.reach(
                    s, t, t + span, (0.15 + 0.26 * lean * b.who.size, 0.84 - 0.08 * abs(lean), 0.22), arc=0.0
                )
            b.trunk(t, t + span, -1.0, -4.0 * sign if along else 0.0)
            t += span
    down = b.beat(0.8)
    for s in SIDES:
        b.reach(s, t, t + 0.5 * down, (0.75, 0.0, 0.35), through=True, exact=True)
    b.relax(t + 0.5 * down, t + down)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def arm_circles(b: Score, times: int) -> Span:
    """Straight arms go round, ahead or back, together or in turn."""
    stand(b, b.stance("l", 1.2), b.stance("r", 1.2))
    t = b.now
    start = t
    way = 1.0 if b.way("circles", "ahead", "back") == "back" else -1.0
    turn_ = b.way("circles2", "together", "together", "in turn") == "in turn"
    step = b.beat(1.15, 0.08) / 8
    count = 8 * times
    for number in range(count + 1):
        for s in SIDES:
            a = math.radians(
                180.0 - way * 45.0 * number + (180.0 if turn_ and s == b.hand and number else 0.0)
            )
            high, far = math.cos(a), math.sin(a)
            # straight; behind the back a shoulder lets them pass further out only; the shoulder rises with them
            aside = 0.12 + 0.6 * max(-far, 0.0)
            value = (aside, (1.03 if high > 0 else 0.98) * high, far if far > 0 else 0.72 * far)
            span = 2 * step if number == 0 or (number == 1 and turn_) else step
            begin, hand = t, f"{s}_hand"
            if number == 1 and turn_ and s == b.hand:  # half a turn ahead, by way of the side
                begin += step
                b.move(hand, t, begin, (0.98, 0.05, 0.2), "arm", through=True, exact=True, even=True)
            b.move(hand, begin, t + span, value, "arm", through=number < count, exact=True, even=True)
        if number % 2:
            b.trunk(t, t + 2 * step, b.vary(-1.0, 1.5))
            b.pelvis(t, t + 2 * step, 0.0, b.vary(-0.006, 0.003), 0.0)
        t += 2 * step if number == 0 or (number == 1 and turn_) else step
    b.now = t
    hands(b, t, t + b.beat(0.6), b.hand_rest)
    b.rise(t, t + b.beat(0.5))
    end = t + 0.3
    b.now = end
    home(b)
    return start, end


def side_bend(b: Score, times: int) -> Span:
    """One arm overhead, the trunk bends to the other side."""
    stand(b, b.stance("l", 1.7), b.stance("r", 1.7))
    t = b.now
    start = t
    side = b.hand
    for _ in range(times):
        go, back = b.beat(1.0), b.beat(0.85)
        roll = b.vary(24.0, 3.0) * b.who.size * -b.out(side)
        b.reach(side, t, t + 0.5 * go, (0.8, 0.1, 0.3), through=True, exact=True)
        b.reach(side, t + 0.5 * go, t + go, (-0.28, 0.98, 0.15), arc=0.0, exact=True)
        b.reach(b.other(side), t, t + go, (0.1, -0.02, 0.1), "hip")
        b.trunk(t, t + go, 2.0, -roll, 0.0)
        b.turn(t, t + go, 0.0, 0.0, -0.2 * roll)
        b.pelvis(t, t + go, 0.05 * b.out(side), -0.006, 0.0)
        t += go + b.beat(0.2, 0.4)
        b.rise(t, t + back)
        b.reach(side, t, t + 0.5 * back, (0.8, 0.0, 0.3), through=True, exact=True)
        b.relax(t + 0.4 * back, t + back)
        t += back
        side = b.other(side)
    b.now = t
    home(b)
    return start, t


def lunge(b: Score, times: int) -> Span:
    """A long step ahead, both knees bend, and back."""
    k, who = b.who.height / 1.75, b.who
    still(b)
    t = b.now
    start = t
    side = b.hand
    arms = b.way("lunge", "hips", "hang", "ahead")
    for _ in range(times):
        out, down, up, back = b.beat(0.5), b.beat(0.6), b.beat(0.55), b.beat(0.55)
        here = b.last(f"{side}_foot").value
        yaw = b.last(f"{side}_sole").value[0]
        far = b.vary(0.62, 0.04) * k
        place = b.world(b.stance(side)[0], 0.0, who.ball_ahead + far)
        b.pelvis(t - 0.05, t + 0.3 * out, b.stance(b.other(side))[0] * 0.7, -0.01, 0.0)
        swing(b, side, t + 0.1 * out, t + out, place, yaw, lift=0.08, arrive=-10.0)
        b.pelvis(t + 0.3 * out, t + out, 0.0, -0.12 * k, 0.28 * k)
        tiptoe(b, t + 0.6 * out, t + out + 0.5 * down, 52.0, b.other(side))
        for s in SIDES:
            if arms == "hips":
                b.reach(s, t, t + out, (0.12, 0.1, 0.06), "hip")
                b.move(f"{s}_swivel", t, t + out, (25.0,))
            elif arms == "ahead":
                b.reach(s, t, t + out + 0.5 * down, (-0.05, -0.05, 0.85))
        t += out
        deep = b.vary(0.36, 0.04) * k
        b.pelvis(t, t + down, 0.0, -deep, 0.33 * k)
        b.trunk(t, t + down, 5.0)
        t += down + 0.08
        b.pelvis(t, t + up, 0.0, -0.1 * k, 0.22 * k)
        t += up
        tiptoe(b, t - 0.3 * up, t + 0.5 * back, 0.0, b.other(side))
        swing(b, side, t, t + back, here, yaw, lift=0.06)
        b.rise(t, t + back)
        if arms == "ahead":
            b.relax(t, t + back)
        t += back + abs(b.vary(0.1, 0.08))
        side = b.other(side)
    b.now = t
    b.relax(t, t + b.beat(0.5))
    for s in SIDES:
        b.move(f"{s}_swivel", t, t + 0.4, (0.0,))
    home(b)
    return start, t


def knee_raise(b: Score, times: int) -> Span:
    """Knees go up in turn, the other elbow comes down to them."""
    still(b)
    t = b.now
    start = t
    side = b.hand
    for _ in range(times):
        go, back = b.beat(0.5), b.beat(0.5)
        other = b.other(side)
        here, yaw = b.last(f"{side}_foot").value, b.last(f"{side}_sole").value[0]
        b.pelvis(t - 0.15, t + 0.4 * go, 0.85 * b.stance(other)[0], -0.01, 0.0)
        tiptoe(b, t, t + 0.3 * go, 35.0, side)
        lift(b, side, t + 0.25 * go)
        leg(b, side, t + 0.25 * go, t + go, (0.03, -0.38, b.vary(0.32, 0.03)), 25.0)
        b.trunk(t, t + go, 10.0, 0.0, b.out(side) * 14.0)
        b.reach(other, t, t + go, (-0.2, -0.2, 0.5), arc=0.05)
        b.reach(side, t, t + go, (0.2, -0.55, -0.1), arc=0.0)
        t += go + 0.04
        plant(b, side, t, t + back, here, yaw, tip=20.0)
        b.rise(t, t + back)
        b.relax(t, t + 1.1 * back)
        t += back + abs(b.vary(0.06, 0.05))
        side = other
    b.now = t
    return start, t


def jump(b: Score, times: int) -> Span:
    """Jumps on the spot or a little ahead, arms swing."""
    k, who = b.who.height / 1.75, b.who
    stand(b, b.stance("l"), b.stance("r"))
    start = b.now
    for _ in range(times):
        still(b)
        crouch(b, b.beat(0.45), b.vary(0.24, 0.03), 0.12)
        t, push = b.now, b.vary(0.24, 0.01)
        up = t + push
        root(b, t, up, on_foot(b, 2.0, 0.03 * k), even=False)
        b.turn(t, up, 0.0, 0.0, 0.0)
        b.trunk(t, up, 0.0)
        b.look(t, up)
        tiptoe(b, t + 0.4 * push, up, 45.0)
        for s in SIDES:
            b.reach(s, t, up, (0.05, 0.3 if b.who.size > 1 else -0.1, 0.75), arc=0.1, exact=True)
        span = b.vary(0.46, 0.03) * math.sqrt(k) * min(b.who.size, 1.05)
        down = up + span
        under(b, abs(b.vary(0.1, 0.12)) * k)
        b.fly(down, b.world(0.0, who.standing - 0.08 * k, 0.25 * who.ball_ahead - 0.03 * k), 0.0, 8.0, 0.0)
        for s in SIDES:
            lift(b, s, up)
        legs(b, up, up + 0.5 * span, (0.03, -0.74, 0.0), 35.0)
        for s in SIDES:
            yaw = b.heading + b.out(s) * who.toe_out
            plant(b, s, up + 0.55 * span, down, b.world(*b.stance(s)), yaw)
        land(b, down)
    end = b.now
    home(b)
    return start, end


def toe_touch(b: Score, times: int) -> Span:
    """Straight legs, the hands go down towards the toes."""
    k = b.who.height / 1.75
    stand(b, b.stance("l", 1.2), b.stance("r", 1.2))
    t = b.now
    start = t
    for _ in range(times):
        go, back = b.beat(0.9), b.beat(0.9)
        deep = b.vary(1.0, 0.08) * min(b.who.size, 1.0)
        b.pelvis(t, t + go, 0.0, -0.03 * k, -0.14 * k)
        b.turn(t, t + go, 0.0, 62.0 * deep, 0.0)
        b.trunk(t, t + go, 58.0 * deep)
        b.look(t, t + go, -6.0)
        for s in SIDES:
            b.reach(s, t, t + go, (b.out(s) * 0.1 * k, (0.22 + 0.5 * (1 - deep)) * k, 0.2 * k), "stage")
        t += go + b.beat(0.25, 0.4)
        b.rise(t, t + back)
        b.relax(t, t + back)
        t += back + abs(b.vary(0.05, 0.05))
    b.now = t
    home(b)
    return start, t
