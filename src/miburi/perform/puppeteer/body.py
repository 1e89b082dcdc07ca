"""The puppet: its size, its joints' ranges, and how its limbs follow the hands that hold them."""

from __future__ import annotations

import numpy as np

from miburi.compiled import njit
from miburi.formats.puppet import COLUMNS
from miburi.motion import Floats

STEP = 300.0 / 1023.0
"""Degrees that one count of a potentiometer of 300° on a 10-bit converter stands for ([P])."""

PARTS = (
    ("l_shoulder", "l_elbow", "l_hand"),
    ("r_shoulder", "r_elbow", "r_hand"),
    ("l_hip", "l_knee", "l_foot"),
    ("r_hip", "r_knee", "r_foot"),
)
"""Root, middle and end joint of the four limbs: left arm, right arm, left leg, right leg."""
SIDE = np.array([1.0, -1.0, 1.0, -1.0])

# Metres. [P]: 33 cm tall, arm span 44 cm. How the height is shared is not printed; this doll has long arms,
# short legs and a long trunk beside a person, as the two printed figures ask for: 0.062 head, 0.110 trunk,
# 0.013 from waist to hips, 0.132 legs, 0.013 feet; 0.086 between the shoulders, 0.155 to each wrist, 0.022
# hands.
TRUNK = 0.110
SHOULDER = np.array([0.043, 0.102, 0.0])
HIP = np.array([0.024, -0.013, 0.0])
UPPER = np.array([0.082, 0.082, 0.066, 0.066])
LOWER = np.array([0.073, 0.073, 0.066, 0.066])
REACH = UPPER + LOWER
ROOTS = np.array([(SHOULDER if k < 2 else HIP) * (SIDE[k], 1.0, 1.0) for k in range(4)])
"""Where shoulders and hips are from the waist."""

# Degrees of (z, x, y, bend) of each limb; hips have no y ([P]: two potentiometers a hip).
_ARM = [(-20.0, 175.0), (-60.0, 170.0), (-90.0, 90.0), (0.0, 140.0)]
_LEG = [(-15.0, 70.0), (-40.0, 125.0), (0.0, 0.0), (0.0, 140.0)]
RANGES = np.array([_ARM, _ARM, _LEG, _LEG])

_JOINTS = [[*(f"{s}_shoulder_{a}" for a in "zxy"), f"{s}_elbow_x"] for s in "lr"]
_JOINTS += [[f"{s}_hip_z", f"{s}_hip_x", "", f"{s}_knee_x"] for s in "lr"]
_PLACES = np.array([[COLUMNS.index(c) if c else -1 for c in joints] for joints in _JOINTS])
"""Column of each limb's (z, x, y, bend) in a log."""

_FASTEST = np.radians(10.0)
"""What a hand can turn a joint by in a sixtieth of a second: 600°/s."""
_REST = np.radians(0.1)
"""A joint that moves by less in a sixtieth of a second has come to rest and sticks."""
_DAMPING = 1e-6
"""Square metres: keeps joints from racing where an arm points along the axis of another joint."""
_ITERATIONS = 12


def columns(limbs: Floats) -> Floats:
    """The 14 joint columns of a log (T, 14) of the angles (T, 4, 4) of the limbs."""
    out = np.empty((len(limbs), 14))
    for limb, places in zip(range(4), _PLACES, strict=True):
        for angle, place in enumerate(places):
            if place >= 0:
                out[:, place] = limbs[:, limb, angle]
    return out


def quantise(angles: Floats) -> Floats:
    """Angles (T, 17) as the converter reports them: whole counts, joints inside their ranges."""
    counts = np.round(angles / STEP)
    for limb, places in zip(range(4), _PLACES, strict=True):
        for angle, place in enumerate(places):
            if place >= 0:
                low, high = RANGES[limb, angle]
                counts[:, place] = np.clip(counts[:, place], np.ceil(low / STEP), np.floor(high / STEP))
    return counts * STEP + 0.0  # no negative zeros


@njit
def _turn(q, v, out):  # type: ignore[no-untyped-def]
    """out[0] = R v with R = Rz(z) Rx(−x) Ry(y), q = (z, x, y); out[1..3] its derivatives by z, x, y."""
    cz, sz, cx, sx, cy, sy = (
        np.cos(q[0]),
        np.sin(q[0]),
        np.cos(q[1]),
        np.sin(q[1]),
        np.cos(q[2]),
        np.sin(q[2]),
    )
    for k in range(4):  # 0: as it is, 1: by z, 2: by x, 3: by y
        if k == 3:
            a, b, c = v[2] * cy - v[0] * sy, 0.0, -v[2] * sy - v[0] * cy
        else:
            a, b, c = v[0] * cy + v[2] * sy, v[1], v[2] * cy - v[0] * sy
        if k == 2:
            a, b, c = 0.0, -b * sx + c * cx, -b * cx - c * sx
        else:
            b, c = b * cx + c * sx, -b * sx + c * cx
        if k == 1:
            out[k, 0], out[k, 1], out[k, 2] = -a * sz - b * cz, a * cz - b * sz, 0.0
        else:
            out[k, 0], out[k, 1], out[k, 2] = a * cz - b * sz, a * sz + b * cz, c


@njit
def _tip(bend, upper, lower, leg):  # type: ignore[no-untyped-def]
    """Hand or foot from shoulder or hip before R turns it: elbows bend forward, knees backward."""
    forward = -lower * np.sin(bend) if leg else lower * np.sin(bend)
    return 0.0, -upper - lower * np.cos(bend), forward


@njit
def _solve(a, b):  # type: ignore[no-untyped-def]
    """b becomes the solution of a x = b for a symmetric positive definite 3 × 3 matrix (Cholesky)."""
    l00 = np.sqrt(a[0, 0])
    l10, l20 = a[1, 0] / l00, a[2, 0] / l00
    l11 = np.sqrt(a[1, 1] - l10 * l10)
    l21 = (a[2, 1] - l20 * l10) / l11
    l22 = np.sqrt(a[2, 2] - l20 * l20 - l21 * l21)
    y0 = b[0] / l00
    y1 = (b[1] - l10 * y0) / l11
    y2 = (b[2] - l20 * y0 - l21 * y1) / l22
    b[2] = y2 / l22
    b[1] = (y1 - l21 * b[2]) / l11
    b[0] = (y0 - l10 * b[1] - l20 * b[2]) / l00


@njit
def _step(q, hand, elbow, weight, v, upper, ranges):  # type: ignore[no-untyped-def]
    """One damped least-squares step of (z, x, y) towards the wanted places; returns the largest change."""
    a, b = np.empty((4, 3)), np.empty((4, 3))
    _turn(q, v, a)
    _turn(q, (0.0, -upper, 0.0), b)
    normal, right = np.empty((3, 3)), np.empty(3)
    for i in range(3):
        right[i] = 0.0
        for j in range(3):
            normal[i, j] = 0.0
        for d in range(3):
            right[i] += a[i + 1, d] * (hand[d] - a[0, d]) + weight * b[i + 1, d] * (elbow[d] - b[0, d])
            for j in range(3):
                normal[i, j] += a[i + 1, d] * a[j + 1, d] + weight * b[i + 1, d] * b[j + 1, d]
    for i in range(3):  # a joint at its stop that is pushed further takes no part
        if (q[i] <= ranges[i, 0] and right[i] <= 0) or (q[i] >= ranges[i, 1] and right[i] >= 0):
            right[i] = 0.0
            for j in range(3):
                normal[i, j] = 0.0
                normal[j, i] = 0.0
        normal[i, i] += _DAMPING
    _solve(normal, right)
    largest = 0.0
    for i in range(3):
        new = min(max(q[i] + min(max(right[i], -0.4), 0.4), ranges[i, 0]), ranges[i, 1])
        largest = max(largest, abs(new - q[i]))
        q[i] = new
    return largest


@njit
def solve(q, hand, elbow, weight, upper, lower, leg, ranges):  # type: ignore[no-untyped-def]
    """Angles (z, x, y, bend), radians, of a left limb that reaches for `hand`, from the angles q on.

    The bend follows from the distance (law of cosines), the rest from damped least squares; `elbow` counts
    with `weight`. Each angle stays in its range.
    """
    out = q.copy()
    distance = np.sqrt(hand[0] * hand[0] + hand[1] * hand[1] + hand[2] * hand[2])
    distance = min(max(distance, abs(upper - lower)), upper + lower)
    cosine = (distance**2 - upper**2 - lower**2) / (2 * upper * lower)
    out[3] = min(max(np.arccos(min(max(cosine, -1.0), 1.0)), ranges[3, 0]), ranges[3, 1])
    v = _tip(out[3], upper, lower, leg)
    for _ in range(_ITERATIONS):
        if _step(out, hand, elbow, weight, v, upper, ranges) < 1e-4:
            break
    return out


# Other ways to begin: an arm that cannot get there from where it hangs may get there from the front or the
# side.
_BEGINNINGS = np.radians(
    np.array(
        [
            [0.0, 20.0, 0.0, 20.0],
            [90.0, 0.0, 0.0, 20.0],
            [30.0, 110.0, 0.0, 40.0],
            [150.0, 0.0, 0.0, 40.0],
            [60.0, 30.0, 60.0, 90.0],
            [60.0, 30.0, -60.0, 90.0],
        ]
    )
)


@njit
def settle(q, hand, elbow, weight, upper, lower, leg, ranges):  # type: ignore[no-untyped-def]
    """`solve` from several beginnings, at leisure: the pose whose hand or foot comes closest."""
    best, least = q.copy(), np.inf
    trial, place = q.copy(), np.empty((4, 3))
    for k in range(len(_BEGINNINGS) + 1):
        for i in range(4):
            begin = q[i] if k == 0 else _BEGINNINGS[k - 1, i]
            trial[i] = min(max(begin, ranges[i, 0]), ranges[i, 1])
        for _ in range(5):
            trial = solve(trial, hand, elbow, weight, upper, lower, leg, ranges)
        _turn(trial, _tip(trial[3], upper, lower, leg), place)
        error = 0.0
        for d in range(3):
            error += (place[0, d] - hand[d]) * (place[0, d] - hand[d])
        if error < least - 1e-8:
            best, least = trial.copy(), error
    return best


@njit
def follow(  # type: ignore[no-untyped-def]
    start, hands, elbows, held, join, weight, stick, upper, lower, leg, ranges
):
    """Angles of a left limb over time.

    A limb that nobody holds stays where it is. One that is taken starts where it is and is where it is
    wanted after `join` frames (minimum jerk). A joint at rest sticks until it is pushed by more than
    `stick`.

    start (4,) radians; hands, elbows (T, 3) metres from shoulder or hip, trunk's frame; held (T,) bool;
    returns (T, 4).
    """
    out = np.empty((len(hands), 4))
    q = start.copy()
    moving = np.zeros(4, np.bool_)
    offset, wanted, since = np.zeros(3), np.empty(3), 0
    place = np.empty((4, 3))
    for t in range(len(hands)):
        if held[t]:
            if t == 0 or not held[t - 1]:
                _turn(q, _tip(q[3], upper, lower, leg), place)
                since = 0
                for d in range(3):
                    offset[d] = place[0, d] - hands[t, d]
                for i in range(4):
                    moving[i] = False
            r = min(since / max(join, 1), 1.0)
            since += 1
            left = 1.0 - r * r * r * (10.0 - 15.0 * r + 6.0 * r * r)
            for d in range(3):
                wanted[d] = hands[t, d] + offset[d] * left
            pushed = solve(q, wanted, elbows[t], weight, upper, lower, leg, ranges)
            for i in range(4):
                change = min(max(pushed[i] - q[i], -_FASTEST), _FASTEST)
                if moving[i] or abs(pushed[i] - q[i]) > stick:
                    q[i] += change
                    moving[i] = abs(change) > _REST
        for i in range(4):
            out[t, i] = q[i]
    return out
