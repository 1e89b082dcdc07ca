"""Spins and squat kicks. Each returns its start and end, seconds."""

from __future__ import annotations

from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.limbs import hands, leg, lift, plant, still, tiptoe
from miburi.perform.bodies.score import SIDES, Score
from miburi.perform.bodies.steps import home, stand


def spins(b: Score, times: int) -> Span:
    """Turns on the ball of one foot, the other at the knee or behind; arms gather and open."""
    k = b.who.height / 1.75
    side = b.hand  # pushes
    sign = b.out(side)
    other = b.other(side)  # carries
    stand(b, b.stance("l"), b.stance("r"))
    still(b)
    t = b.now
    start = t
    pose = b.way("spin", "knee", "knee", "behind", "low")
    free = {"knee": (0.10, -0.50, 0.16), "behind": (0.05, -0.6, -0.3), "low": (0.16, -0.72, 0.12)}[pose]
    round_ = b.way("arms", "round", "round", "crossed", "high")
    arms = {"round": (-0.12, -0.25, 0.62), "crossed": (-0.32, -0.2, 0.36), "high": (0.0, 0.85, 0.3)}[round_]
    for _ in range(times):
        ready, push = b.beat(0.5), b.beat(0.22)
        b.pelvis(t, t + ready, 0.0, -0.09 * k, 0.0)
        b.turn(t, t + ready, sign * 26.0, 2.0, 0.0)
        b.trunk(t, t + ready, 4.0, 0.0, sign * 16.0)
        b.look(t, t + ready, -2.0, -sign * 30.0)
        b.reach(side, t, t + ready, (-0.1, -0.2, 0.75), arc=0.04)
        b.reach(other, t, t + ready, (0.75, -0.12, 0.25), arc=0.04)
        t += ready
        turns = int(b.rng.integers(1, 3))
        place = b.local(b.last(f"{other}_foot").value)
        seconds = b.beat(0.76, 0.05)
        b.heading -= sign * 360.0 * turns
        over = t + push + seconds * turns
        b.pelvis(t, t + push, 0.92 * place[0], 0.045 * k, 0.02)
        b.turn(t, over, 0.0, 0.0, 0.0)
        b.trunk(t, t + 2 * push, -1.0, 0.0, -sign * 6.0)
        b.look(t + 0.7 * push, over, 0.0)
        hands(b, t - 0.05, t + push + 0.55, arms)
        yaw = b.heading + b.out(other) * b.who.toe_out
        was = b.last(f"{other}_sole").value
        b.move(f"{other}_sole", t, t + 0.5 * push, (was[0] - sign * 12.0, 30.0), through=True, even=True)
        b.move(f"{other}_sole", t + 0.5 * push, over, (yaw, 26.0))
        tiptoe(b, t - 0.1, t + 0.6 * push, 45.0, side)
        lift(b, side, t + 0.6 * push)
        leg(b, side, t + 0.6 * push, t + push + 0.3, free, 40.0)
        down = b.beat(0.4)
        tiptoe(b, over - 0.02, over + 0.7 * down, 0.0, other)
        plant(
            b,
            side,
            over - 0.15,
            over + 0.6 * down,
            b.world(*b.stance(side, 1.2, -0.04 * k)),
            b.heading + sign * b.who.toe_out,
        )
        b.pelvis(over - 0.05, over + down, 0.0, -0.03 * k, 0.0)
        hands(b, over - 0.2, over + down + 0.1, (0.5, -0.55, 0.25))
        b.trunk(over, over + down, 3.0)
        t = over + down + abs(b.vary(0.12, 0.08))
    up = b.beat(0.5)
    b.rise(t, t + up)
    b.relax(t, t + 1.1 * up)
    b.now = t + up
    end = b.now
    home(b)
    return start, end


def russian(b: Score, times: int) -> Span:
    """Squat kicks: deep down on the balls of the feet, arms folded, the legs shoot out in turn with a hop."""
    k, who = b.who.height / 1.75, b.who
    stand(b, b.stance("l", 0.9), b.stance("r", 0.9))
    still(b)
    t = b.now
    start = t
    down = b.beat(0.7)
    fold = b.way("russian", "folded", "wide", "wide", "ahead")
    arms = {"folded": (-0.34, -0.34, 0.42), "wide": (0.85, 0.0, 0.3), "ahead": (-0.1, -0.1, 0.8)}[fold]
    low = (0.47 * k * b.vary(1.0, 0.03)) - who.standing
    for s in SIDES:
        high = 0.05 if fold == "folded" and s == b.hand else 0.0
        b.reach(s, t, t + down, (arms[0], arms[1] + high, arms[2] + high), arc=0.05)
        if fold == "folded":
            b.move(f"{s}_swivel", t, t + down, (48.0,))
    b.pelvis(t, t + down, 0.0, low, -0.05 * k)
    b.turn(t, t + down, 0.0, 4.0, 0.0)
    b.trunk(t, t + down, 14.0)
    b.look(t, t + down, -8.0)
    tiptoe(b, t + 0.2 * down, t + down, 36.0)
    t += down + 0.05
    home_ = {s: b.stance(s, 0.7, -0.05 * k) for s in SIDES}
    kick = b.hand
    beat = b.beat(0.46, 0.05)
    for number in range(times):
        span = beat * b.vary(1.0, 0.04)
        stay = b.other(kick)
        # both feet leave the floor for a moment: one shoots out, the other comes under the body
        b.pelvis(t, t + 0.42 * span, b.out(stay) * 0.03 * k, low + 0.075 * k, -0.06 * k)
        lift(b, kick, t + 0.06 * span)
        b.move(
            f"{kick}_foot",
            t + 0.06 * span,
            t + 0.62 * span,
            b.world(
                b.out(kick) * 0.1 * k, 0.035 * k + 0.1 * k * float(b.rng.random()), b.vary(0.72, 0.03) * k
            ),
        )
        b.move(f"{kick}_sole", t + 0.06 * span, t + 0.62 * span, (b.heading + b.out(kick) * 8.0, -26.0))
        if number or b.last(f"{stay}_foot").frame == "world":
            if not (b.air[stay] and b.air[stay][-1][1] > 1e8):
                lift(b, stay, t + 0.08 * span)
            b.move(
                f"{stay}_foot",
                max(t + 0.08 * span, b.last(f"{stay}_foot").t),
                t + 0.55 * span,
                b.world(*home_[stay]),
            )
            b.move(f"{stay}_sole", t + 0.08 * span, t + 0.5 * span, (b.heading + b.out(stay) * 14.0, 38.0))
            opened = b.air[stay].pop()[0]
            b.air[stay].append((opened, t + 0.55 * span))
        b.pelvis(t + 0.42 * span, t + 0.85 * span, b.out(stay) * 0.035 * k, low - 0.01, -0.06 * k)
        b.turn(t, t + 0.7 * span, -b.out(kick) * b.vary(9.0, 2.0), -4.0 + b.vary(0.0, 2.0), 0.0)
        b.trunk(t, t + 0.7 * span, 12.0, 0.0, b.out(kick) * 8.0)
        for s in SIDES if fold != "folded" else "":  # the arms beat against the hops and the legs
            far = b.vary(0.26, 0.05) * (-1.0 if s == kick else 1.0)
            bob = b.vary(0.2, 0.05) if number % 2 else b.vary(-0.26, 0.05)
            place = (arms[0] - 0.3 * abs(far), arms[1] + bob, arms[2] + far)
            b.reach(s, t, t + 0.85 * span, place, arc=0.0, exact=True)
        t += span
        kick = b.other(kick)
    last = b.other(kick)
    span = b.beat(0.4)
    plant(b, last, t, t + span, b.world(*home_[last]), b.heading + b.out(last) * 12.0, tip=30.0)
    b.pelvis(t, t + span, 0.0, low + 0.02, -0.06 * k)
    b.turn(t, t + span, 0.0, 4.0, 0.0)
    t += span
    up = b.beat(0.8)
    tiptoe(b, t, t + 0.6 * up, 0.0)
    b.rise(t, t + up)
    for s in SIDES:
        b.move(f"{s}_swivel", t, t + 0.5 * up, (0.0,))
    b.relax(t, t + up)
    b.now = t + up
    end = b.now
    home(b)
    return start, end
