"""On the floor: falling, lying, rolling, getting up. Each motion returns its start and end, seconds."""

from __future__ import annotations

from miburi.perform.bodies.gestures import Span
from miburi.perform.bodies.limbs import hands, leg, legs, lift, palms, plant, root, still, tiptoe, unpalm
from miburi.perform.bodies.score import SIDES, Score
from miburi.perform.bodies.steps import home, stand

LYING = 0.115  # height of the root of who lies on the back, metres for a height of 1.75 m


def rug_pull(b: Score) -> Span:
    """The ground goes from under the feet: they shoot ahead, the body falls on seat and back; arms fly up."""
    k = b.who.height / 1.75
    still(b)
    start = b.now
    t = b.now
    b.look(t, t + 0.4, 4.0)
    t += b.beat(0.3, 0.3)
    slip, fall = b.vary(0.29, 0.015), b.vary(0.40, 0.02)
    seat = -b.vary(0.16, 0.05) * k
    for s in SIDES:
        late = abs(b.vary(0.03, 0.03))
        x = b.out(s) * b.vary(0.13, 0.02) * k
        lift(b, s, t + late)
        b.move(f"{s}_foot", t + late, t + slip + 0.5 * fall, b.world(x, 0.22 * k, 0.72 * k))
        b.move(f"{s}_sole", t + late, t + slip + 0.4 * fall, (b.heading + b.out(s) * 10.0, -48.0))
    # free fall from a little above the seat's height, then the floor
    root(b, t, t + slip, (0.0, b.who.standing - 0.14 * k, seat * 0.3), through=True)
    b.turn(t, t + slip, b.vary(0.0, 4.0), -22.0, b.vary(0.0, 4.0), through=True, even=True)
    b.trunk(t, t + slip, 16.0)
    b.look(t, t + slip, 20.0)
    wide = b.vary(0.55, 0.1)
    for s in SIDES:
        b.reach(s, t + 0.04, t + slip + 0.15, (wide + b.vary(0.0, 0.1), b.vary(0.35, 0.2), 0.5), arc=0.0)
    t += slip
    root(b, t, t + fall, (0.0, 0.15 * k, seat))
    b.turn(t, t + fall, 0.0, -52.0, 0.0, through=True, even=True)
    b.trunk(t, t + fall, 24.0)
    t += fall
    back = b.vary(0.3, 0.02)
    root(b, t, t + back, (0.0, LYING * k, seat - 0.06 * k))
    b.turn(t, t + back, 0.0, -87.0, 0.0)
    b.trunk(t, t + back, 3.0)
    b.look(t, t + back, 16.0)
    up = b.vary(0.42, 0.1) * k
    for s in SIDES:
        b.move(f"{s}_foot", t - 0.3 * fall, t + back, b.world(b.out(s) * 0.12 * k, up, seat + 0.72 * k))
        b.reach(s, t - 0.1, t + back + 0.05, (b.vary(0.75, 0.06), b.vary(-0.2, 0.12), -0.06), arc=0.0)
    t += back
    rest = b.beat(0.5, 0.2)
    for s in SIDES:
        x, far = b.out(s) * b.vary(0.14, 0.02) * k, b.vary(0.9, 0.02) * b.who.height * 0.53
        b.move(f"{s}_foot", t, t + rest, b.world(x, 0.11 * k, seat + far))
        b.move(f"{s}_sole", t, t + rest, (b.heading + b.out(s) * 25.0, -62.0))
    b.look(t, t + rest, 2.0)
    t += rest + b.beat(0.3, 0.3)
    b.now = t
    return start, t


def lie_down(b: Score) -> Span:
    """Down on the floor by way of a squat and the seat, onto the back."""
    k = b.who.height / 1.75
    stand(b, b.stance("l"), b.stance("r"))
    still(b)
    t = b.now
    start = t
    go, sit, back = b.beat(1.0), b.beat(0.7), b.beat(1.1)
    b.look(t, t + 0.5 * go, 14.0)
    root(b, t, t + go, (0.0, 0.42 * k, -0.12 * k), through=True)
    b.turn(t, t + go, 0.0, 32.0, 0.0)
    b.trunk(t, t + go, 20.0)
    tiptoe(b, t + 0.4 * go, t + go, 12.0)
    side = b.hand
    for s in SIDES:
        palms(b, s, t + 0.4 * go, t + go + 0.3 * sit, b.out(s) * 0.3 * k, -0.26 * k)
    t += go
    seat = -0.30 * k
    root(b, t, t + sit, (0.0, 0.125 * k, seat))
    b.turn(t, t + sit, 0.0, -14.0, 0.0)
    b.trunk(t, t + sit, 26.0)
    tiptoe(b, t, t + sit, 0.0)
    t += sit
    unpalm(b, t)
    for n, s in enumerate((side, b.other(side))):
        late = 0.25 * n
        b.reach(s, t + late, t + back, (0.35, -0.8, 0.0), arc=0.05)
        lift(b, s, t + late)
        x = b.out(s) * 0.11 * k
        b.move(f"{s}_foot", t + late, t + 0.9 * back + late, b.world(x, 0.11 * k, seat + 0.47 * b.who.height))
        b.move(f"{s}_sole", t + late, t + 0.9 * back + late, (b.heading + b.out(s) * 20.0, -60.0))
    root(b, t, t + back, (0.0, LYING * k, seat - 0.04 * k))
    b.turn(t, t + back, 0.0, -87.0, 0.0)
    b.trunk(t, t + back, 2.0)
    b.look(t, t + back, 4.0)
    t += back + b.beat(0.6, 0.3)
    b.now = t
    return start, t


def get_up(b: Score) -> Span:
    """From the back: sit up, draw in the feet, push off with the hands, over the feet, and stand."""
    k = b.who.height / 1.75
    t = b.now
    start = t
    seat = b.local(b.last("pelvis").value)[2]
    up, tuck, over, rise = b.beat(0.9), b.beat(0.6), b.beat(0.75), b.beat(0.75)
    for s in SIDES:
        palms(b, s, t + 0.2 * up, t + up, b.out(s) * 0.3 * k, seat - 0.22 * k)
    b.look(t, t + 0.4 * up, 24.0)
    root(b, t, t + up, (0.0, 0.125 * k, seat))
    b.turn(t, t + up, 0.0, -16.0, 0.0)
    b.trunk(t, t + up, 30.0)
    b.look(t + 0.5 * up, t + up, 6.0)
    t += 0.75 * up
    for n, s in enumerate((b.hand, b.other(b.hand))):
        late = 0.2 * n * tuck
        goal = b.world(b.out(s) * 0.1 * k, 0.0, seat + (0.40 + 0.04 * n) * k)
        b.move(f"{s}_foot", t + late, t + late + tuck, goal)
        b.move(f"{s}_sole", t + late, t + late + tuck, (b.heading + b.out(s) * 8.0, -3.0))
        b.move(f"{s}_sole", t + late + tuck, t + late + tuck + 0.15, (b.heading + b.out(s) * 8.0, 0.0))
        opened = b.air[s].pop()[0]
        b.air[s].append((opened, t + late + tuck))
    t += 1.2 * tuck
    ahead = seat + 0.42 * k
    tiptoe(b, t, t + 0.7 * over, 24.0)
    root(b, t, t + over, (0.0, 0.36 * k, ahead - b.who.ball_ahead - 0.10 * k), through=True)
    b.turn(t, t + over, 0.0, 40.0, 0.0)
    b.trunk(t, t + over, 26.0)
    b.look(t, t + over, -8.0)
    for s in SIDES:
        b.reach(s, t + 0.35 * over, t + over + 0.1, (0.1, -0.55, 0.6), arc=0.0)
    unpalm(b, t + 0.35 * over)
    t += over
    tiptoe(b, t, t + 0.5 * rise, 0.0)
    b.settle()
    b.rise(t, t + rise)
    b.relax(t + 0.2 * rise, t + 1.1 * rise)
    b.now = t + 0.95 * rise
    end = b.now
    home(b)
    return start, end


def somersault(b: Score) -> Span:
    """Backwards over the rounded back: squat, seat, shoulders, hands beside the ears, feet, and up."""
    k, who = b.who.height / 1.75, b.who
    stand(b, b.stance("l"), b.stance("r"))
    still(b)
    t = b.now
    start = t
    squat, sit = b.beat(0.75), b.beat(0.38)
    hands(b, t, t + squat, (0.0, -0.3, 0.75))
    root(b, t, t + squat, (0.0, 0.38 * k, -0.14 * k), through=True)
    b.turn(t, t + squat, 0.0, 22.0, 0.0, through=True, even=True)
    b.trunk(t, t + squat, 40.0)
    b.look(t, t + squat, 18.0)
    tiptoe(b, t + 0.5 * squat, t + squat, 8.0)
    t += squat
    seat = -0.42 * k
    root(b, t, t + sit, (0.0, 0.13 * k, seat), through=True)
    b.turn(t, t + sit, 0.0, -40.0, 0.0, through=True, even=True)
    b.trunk(t, t + sit, 52.0)
    b.look(t, t + sit, 26.0)
    hands(b, t, t + 1.3 * sit, (-0.02, 0.34, 0.22))
    t += sit
    tuck = (0.05, -0.36, 0.36)
    for s in SIDES:
        tiptoe(b, t - 0.2, t, 0.0, s)
        lift(b, s, t - 0.02)
        leg(b, s, t - 0.02, t + 0.3, tuck, 25.0)
    roll = b.beat(0.2, 0.06)
    for pitch, high, back in (
        (-92.0, 0.13, -0.16),
        (-135.0, 0.34, -0.30),
        (-178.0, 0.61, -0.52),
        (-222.0, 0.68, -0.74),
    ):
        root(b, t, t + roll, (0.0, high * k, seat + back * k), through=True)
        b.turn(t, t + roll, 0.0, pitch, 0.0, through=True, even=True)
        b.trunk(t, t + roll, 54.0)
        t += roll
    put = seat - 0.50 * k
    for s in SIDES:  # the hands stand where the ears were
        palms(b, s, t - 3.4 * roll, t - 1.7 * roll, b.out(s) * 0.19 * k, put, 180.0)
    legs(b, t - 2 * roll, t, (0.05, -0.5, 0.42), 15.0)
    root(b, t, t + 1.2 * roll, (0.0, 0.62 * k, put - 0.42 * k), through=True)
    b.turn(t, t + 1.2 * roll, 0.0, -268.0, 0.0, through=True, even=True)
    b.trunk(t, t + 1.2 * roll, 46.0)
    foot = put - 0.36 * k
    b.revolved[0] -= 360.0
    for s in SIDES:
        place = b.world(b.stance(s)[0], 0.0, foot)
        plant(b, s, t, t + 1.1 * roll, place, b.heading + b.out(s) * who.toe_out, tip=34.0)
    t += 1.2 * roll
    up = b.beat(0.4)
    unpalm(b, t)
    b.settle()
    b.pelvis(t, t + up, 0.0, -0.42 * k, -0.16 * k, through=True)
    b.turn(t, t + up, 0.0, 42.0, 0.0, through=True, even=True)
    b.trunk(t, t + up, 36.0)
    b.look(t, t + up, -12.0)
    hands(b, t + 0.05, t + 1.2 * up, (0.1, -0.4, 0.7))
    t += up
    end = t + b.beat(0.75)
    b.rise(t, end)
    b.relax(t + 0.1, end + 0.1)
    b.now = end
    home(b)
    return start, end
