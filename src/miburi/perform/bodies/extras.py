"""Motions that no keyword asks for, some of them near to one. Each returns its start and end, seconds."""

from __future__ import annotations

from miburi.perform.bodies import steps
from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.score import SIDES, Score


def phone(b: Score) -> Span:
    """A hand at the ear; the weight goes from foot to foot, the other hand explains now and then."""
    side, other = b.hand, b.other(b.hand)
    t = b.now
    start = t
    up = b.beat(0.85)
    # the wrist is at the jaw and the elbow hangs, so that the fingers are beside the ear
    b.reach(side, t, t + up, (b.vary(0.12, 0.01), b.vary(-0.05, 0.015), b.vary(0.06, 0.01)), "head", arc=0.1)
    b.move(f"{side}_swivel", t, t + up, (b.vary(-38.0, 6.0),))
    b.move(f"{side}_wrist", t, t + up, (0.0, -10.0, 0.0))
    b.look(t, t + up, 3.0, b.vary(0.0, 8.0), -b.out(side) * 5.0)
    t += up
    end = t + b.beat(2.2, 0.3)
    while t < end:
        span = b.beat(0.9, 0.2)
        b.look(t, t + 0.7 * span, b.vary(4.0, 5.0), b.vary(0.0, 14.0), -b.out(side) * 5.0)
        b.pelvis(t, t + span, b.vary(0.0, 0.03), -0.008, 0.0)
        if b.rng.random() < 0.4:
            b.reach(other, t, t + 0.6 * span, (b.vary(0.0, 0.1), b.vary(-0.5, 0.1), b.vary(0.45, 0.08)))
            b.relax(t + 0.7 * span, t + 1.5 * span, other)
        t += span
    down = b.beat(0.75)
    b.relax(t, t + down)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def scratch(b: Score, times: int) -> Span:
    """A hand scratches the head, which tilts towards it."""
    side = b.hand
    t = b.now
    start = t
    up = b.beat(0.9)
    at = (b.vary(0.07, 0.015), b.vary(0.15, 0.02), b.vary(0.03, 0.03))
    b.reach(side, t, t + up, at, "head", arc=0.14)
    b.move(f"{side}_swivel", t, t + up, (b.vary(2.0, 8.0),))
    b.look(t, t + up, 8.0, b.vary(0.0, 6.0), b.out(side) * -7.0)
    t += up
    for _ in range(times):
        for step in (0.025, -0.02):
            span = b.beat(0.16)
            b.reach(side, t, t + span, (at[0], at[1] + step, at[2] - step), "head", arc=0.0)
            t += span
    down = b.beat(0.7)
    b.relax(t, t + down, side)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    return start, b.now


def mop(b: Score, times: int) -> Span:
    """Both hands on a stick push and pull it over the floor."""
    k = b.who.height / 1.75
    side, other = b.hand, b.other(b.hand)
    sign = b.out(side)
    steps.stand(b, b.stance("l", 1.3, -sign * 0.12 * k), b.stance("r", 1.3, sign * 0.12 * k))
    t = b.now
    start = t
    ready = b.beat(0.7)
    aside = b.way("mop", "aside", "to and fro") == "aside"
    far = b.vary(0.17, 0.03) * k * b.who.size

    def hold(s: float, e: float, share: float, exact: bool) -> None:
        x, z = (sign * far * share, 0.0) if aside else (0.0, far * share)
        b.reach(
            side, s, e, (0.35 * x - sign * 0.02, 1.06 * k, 0.30 * k + 0.5 * z), "stage", arc=0.0, exact=exact
        )
        b.reach(other, s, e, (x + sign * 0.05, 0.78 * k, 0.44 * k + z), "stage", arc=0.0, exact=exact)
        b.trunk(s, e, 16.0 + (0.0 if aside else 6.0 * share), 0.0, sign * 12.0 * share if aside else 0.0)
        b.turn(s, e, sign * 6.0 * share if aside else 0.0, 10.0, 0.0)
        b.pelvis(s, e, 0.3 * x, -0.03, 0.3 * z)
        b.look(s, e, 12.0)

    hold(t, t + ready, 0.0, False)
    t += ready
    for _ in range(times):
        for share in (b.vary(1.0, 0.1), b.vary(-1.0, 0.1)):
            span = b.beat(0.55)
            hold(t, t + span, share, True)
            t += span + 0.02
    b.now = t
    b.relax(t, t + b.beat(0.7))
    b.rise(t, t + b.beat(0.6))
    b.now = t + 0.4
    steps.home(b)
    return start, t


def jacks(b: Score, times: int) -> Span:
    """Jumping jacks: feet apart and together, arms overhead and down, both feet in the air between."""
    t = b.now
    start = t
    high = b.vary(0.88, 0.05)
    for _ in range(times):
        for apart in (True, False):
            crouch, fly, land = b.beat(0.15), b.beat(0.29), b.beat(0.13)
            middle = t + crouch + 0.5 * fly
            b.pelvis(t, t + crouch, 0.0, -0.085, 0.0)
            b.pelvis(t + crouch, middle, 0.0, 0.05, 0.0)
            b.pelvis(middle, middle + 0.5 * fly + land, 0.0, -0.07 if apart else -0.055, 0.0)
            wide = 2.3 * b.who.size if apart else 1.0
            for side in SIDES:
                place = b.world(*b.stance(side, wide))
                yaw = b.heading + b.out(side) * (b.who.toe_out + (4.0 if apart else 0.0))
                steps.swing(
                    b, side, t + crouch, t + crouch + fly, place, yaw, lift=0.05, leave=30.0, arrive=8.0
                )
                whole = crouch + fly
                b.reach(side, t, t + 0.5 * whole, (0.85, 0.05, 0.22), through=True, exact=True)
                goal = (0.05, high, 0.15) if apart else b.hand_rest
                b.reach(side, t + 0.5 * whole, t + 1.05 * whole, goal, arc=0.0, exact=True)
            b.trunk(t, t + crouch, 5.0)
            b.trunk(t + crouch, t + crouch + fly, 1.0)
            t += crouch + fly + land
    b.now = t + 0.05
    b.relax(t, t + b.beat(0.4))
    b.rise(t, t + b.beat(0.4))
    b.now = t + 0.2
    return start, b.now


def stretch(b: Score, times: int) -> Span:
    """Arms overhead, the trunk bends from side to side."""
    steps.stand(b, b.stance("l", 1.5), b.stance("r", 1.5))
    t = b.now
    start = t
    up = b.beat(1.0)
    one = b.way("stretch", "both", "one") == "one"  # one hand stays at the hip
    way = 1.0 if b.rng.random() < 0.5 else -1.0
    for side in SIDES:
        if one and b.out(side) == way:
            b.reach(side, t, t + up, (0.12, 0.1, 0.06), "hip")
            b.move(f"{side}_swivel", t, t + up, (25.0,))
        else:
            b.reach(side, t, t + 0.5 * up, (0.75, 0.15, 0.35), through=True)
            b.reach(side, t + 0.5 * up, t + up, (-0.1, 1.02, 0.12), arc=0.0)
    b.trunk(t, t + up, -3.0)
    t += up
    for number in range(times if one else 2 * times):
        span = b.beat(0.95)
        roll = b.vary(19.0, 3.0) * b.who.size * way
        b.trunk(t, t + span, 2.0, -roll, 0.0)
        b.turn(t, t + span, 0.0, 0.0, -0.3 * roll)
        b.pelvis(t, t + span, -0.04 * way, -0.004, 0.0)
        b.look(t, t + span, 0.0, 0.0, 0.2 * roll)
        t += span + b.beat(0.2, 0.4)
        if one:
            b.trunk(t, t + 0.7 * span, 0.0)
            t += 0.7 * span if number + 1 < times else 0.0
        else:
            way = -way
    down = b.beat(0.9)
    for side in SIDES:
        if b.last(f"{side}_hand").frame == "arm":
            b.reach(side, t, t + 0.5 * down, (0.8, 0.1, 0.25), through=True)
    b.relax(t + 0.5 * down, t + down)
    b.rise(t, t + down)
    b.now = t + 0.9 * down
    steps.home(b)
    return start, t + 0.9 * down


def bow(b: Score) -> Span:
    """A bow with the hands at the thighs or folded."""
    t = b.now
    start = t
    deep = b.vary(38.0, 10.0) * b.who.size
    go, hold, back = b.beat(0.85), b.beat(0.4, 0.3), b.beat(0.95)
    ahead = b.way("bow", "ahead", "at the thighs") == "ahead"
    b.pelvis(t, t + go, 0.0, -0.008, -0.0022 * deep)
    b.turn(t, t + go, 0.0, 0.55 * deep, 0.0)
    b.trunk(t, t + go, 0.5 * deep)
    b.look(t + 0.05, t + go, 0.15 * deep)
    for side in "lr":
        value = (-0.2, -0.82, 0.35) if ahead else (0.06, -0.86, 0.38)
        b.reach(side, t, t + go, value)
    t += go + hold
    b.rise(t, t + back)
    b.relax(t, t + back)
    b.now = t + 0.95 * back
    return start, b.now


def reach_up(b: Score, times: int) -> Span:
    """One or both hands reach for something high; heels leave the floor."""
    t = b.now
    start = t
    both = b.way("reach", "one", "one", "both") == "both"
    side = b.hand
    for _ in range(times):
        go, hold, back = b.beat(1.0), b.beat(0.45, 0.3), b.beat(0.95)
        tip = b.rng.random() < 0.6
        lean = 0.0 if both else b.out(side)
        for s in "lr":
            if both or s == side:
                b.reach(s, t, t + go, (-0.05, 1.02, 0.33), arc=0.16)
            if tip:
                yaw = b.last(f"{s}_sole").value[0]
                b.move(f"{s}_sole", t + 0.3 * go, t + go, (yaw, 24.0))
                b.move(f"{s}_sole", t + go + hold, t + go + hold + 0.7 * back, (yaw, 0.0))
        b.pelvis(t + 0.2 * go, t + go, 0.03 * lean, 0.045 if tip else 0.0, 0.035 if tip else 0.01)
        b.trunk(t, t + go, -7.0, -6.0 * lean)
        b.look(t - 0.05, t + 0.8 * go, -28.0)
        t += go + hold
        b.relax(t, t + back, "lr" if both else side)
        b.rise(t, t + 0.9 * back)
        t += back + abs(b.vary(0.05, 0.1))
    b.now = t
    return start, t
