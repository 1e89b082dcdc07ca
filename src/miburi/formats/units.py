"""Units and upward axes of recordings that state neither.

A BVH file names no unit and no upward axis, so both are found by the body that it holds, and said (log, and
`miburi.formats.inspect`); `unit` and `up` in the config come first.

*Unit.* If a body is recognised (`miburi.conventions`), its stature (ankle, knee, hip, neck, head along the
bones, as they stand in the recording) decides: centimetres if that makes it 0.75 to 2.6 m, else the one of
metres, decimetres, 1/0.45 inch (CMU), inches, centimetres and millimetres that brings it nearest to 1.35 m.
A hand alone is treated the same, from the wrist to the middle fingertip: centimetres for 0.12 to 0.26 m,
else nearest to 0.19 m. Anything else is taken as centimetres.

*Up.* The axis along which the head is above the ankles in the recording. If that is not the same axis all
the time (somebody lies down), it is the one along which the lowest joint keeps its height best. Without a
body: y.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from miburi.conventions import find_joints
from miburi.errors import InputError
from miburi.kinematics import forward
from miburi.motion import Floats, Motion, Skeleton

log = logging.getLogger(__name__)

UNITS = {
    "metres": 1.0,
    "decimetres": 0.1,
    "1/0.45 inches": 0.0254 / 0.45,
    "inches": 0.0254,
    "centimetres": 0.01,
    "millimetres": 0.001,
}
"""Metres per unit of the candidates."""

_BODY = (0.75, 2.6, 1.35)
_HAND = (0.12, 0.26, 0.19)
"""Shortest and tallest that passes in centimetres, and what is usual, metres."""

# rotations that bring each axis to +y, as quaternions x y z w
_H = float(np.sqrt(0.5))
_TURNS = {
    "y": (0.0, 0.0, 0.0, 1.0),
    "z": (-_H, 0.0, 0.0, _H),
    "-z": (_H, 0.0, 0.0, _H),
    "x": (0.0, 0.0, _H, _H),
    "-x": (0.0, 0.0, -_H, _H),
    "-y": (1.0, 0.0, 0.0, 0.0),
}


@dataclass(frozen=True)
class Choice:
    """How the lengths and axes of a recording were understood.

    Parameters
    ----------
    unit
        Metres per unit of the recording.
    unit_why
        What that rests on.
    up
        The recording's upward axis: "x", "y", "z", or one of them with "-" before it.
    up_why
        What that rests on.
    """

    unit: float
    unit_why: str
    up: str
    up_why: str

    def __str__(self) -> str:
        return f"1 unit = {self.unit:.6g} m ({self.unit_why}), {self.up} is up ({self.up_why})"


def choose(
    motion: Motion,
    *,
    unit: float | None = None,
    up: str | None = None,
    joints: Mapping[str, str] | None = None,
) -> Choice:
    """The unit and upward axis of a motion that is still in its file's own.

    Parameters
    ----------
    unit, up
        What the user states, or None.
    joints
        Canonical joint → name, where the tables do not know it.
    """
    if unit is not None and not (np.isfinite(unit) and unit > 0):
        raise InputError(f"unit: found {unit}, expected metres per unit, above 0")
    body = _body(motion.skeleton, joints)
    sample = motion[:: max(1, -(-len(motion) // 64))]
    places = forward(sample)[0] if body is not None else None
    if unit is not None:
        unit_why = "stated"
    elif body is not None and places is not None:
        unit, unit_why = _unit(_stature(places, body), *_BODY, "a body")
    elif (length := _hand(motion.skeleton)) is not None:
        unit, unit_why = _unit(length, *_HAND, "a hand")
    else:
        unit, unit_why = 0.01, "centimetres, as neither a body nor a hand is recognised"
    if up is not None:
        up_why = "stated"
    elif body is not None and places is not None:
        up, up_why = _up(places, body)
    else:
        up, up_why = "y", "no body is recognised"
    return Choice(float(unit), unit_why, up, up_why)


def apply(motion: Motion, choice: Choice) -> tuple[Motion, Choice]:
    """The motion in metres, Y up, and the choice that it follows; the choice is logged."""
    log.info("%s: %s", motion.name, choice)
    return turned(scaled(motion, choice.unit), choice.up), choice


def scaled(motion: Motion, unit: float) -> Motion:
    """All lengths times `unit`."""
    s = motion.skeleton
    skeleton = replace(s, offsets=s.offsets * unit, end_offsets=s.end_offsets * unit)
    moved = None if motion.translations is None else motion.translations * unit
    return replace(motion, skeleton=skeleton, root=motion.root * unit, translations=moved)


def turned(motion: Motion, up: str) -> Motion:
    """A change of basis that makes the axis `up` the y axis: offsets, root, rotations and translations."""
    if up not in _TURNS:
        raise InputError(f"up: found {up!r}, expected x, y or z")
    if up == "y":
        return motion
    x, y, z, w = _TURNS[up]
    basis = np.round(  # quarter turns: exact
        np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
        )
    )
    s = motion.skeleton
    skeleton = replace(s, offsets=s.offsets @ basis.T, end_offsets=s.end_offsets @ basis.T)
    rotations = np.concatenate([motion.rotations[..., :3] @ basis.T, motion.rotations[..., 3:]], axis=-1)
    moved = None if motion.translations is None else motion.translations @ basis.T
    return replace(
        motion, skeleton=skeleton, root=motion.root @ basis.T, rotations=rotations, translations=moved
    )


def _body(skeleton: Skeleton, joints: Mapping[str, str] | None) -> dict[str, int] | None:
    try:
        return find_joints(skeleton, joints)
    except InputError:
        if joints:
            raise
        return None


def _stature(places: Floats, j: Mapping[str, int]) -> float:
    """Length of a body from the ankles to the head along its bones, median over frames, in the file's
    unit."""

    def bone(a: Floats, b: Floats) -> float:
        return float(np.median(np.linalg.norm(a - b, axis=-1)))

    legs = [
        bone(places[:, j[f"{s}_{a}"]], places[:, j[f"{s}_{b}"]])
        for s in "lr"
        for a, b in (("foot", "knee"), ("knee", "hip"))
    ]
    hips = (places[:, j["l_hip"]] + places[:, j["r_hip"]]) / 2
    neck = places[:, j["neck"]]
    return sum(legs) / 2 + bone(hips, neck) + bone(neck, places[:, j.get("head", j["neck"])])


def _unit(length: float, least: float, most: float, usual: float, what: str) -> tuple[float, str]:
    """The unit that makes `length` that of a person (a hand), and why."""
    if length <= 0:
        return 0.01, f"centimetres, as {what} has no size"
    name = "centimetres"
    if not least <= length * UNITS[name] <= most:
        name = min(UNITS, key=lambda u: abs(np.log(length * UNITS[u] / usual)))
    return UNITS[name], f"{name} make {what} of {length:.4g} units {length * UNITS[name]:.3g} m long"


def _hand(skeleton: Skeleton) -> float | None:
    """Length of a hand from the wrist to the middle fingertip in the file's unit, if this is a hand."""
    names = [re.sub(r"[^a-z]", "", n.lower()) for n in skeleton.joints]
    fingers = [j for j, n in enumerate(names) if "mid" in n]
    if not fingers or not any("thumb" in n for n in names):
        return None
    length = np.zeros(len(names))
    tip = np.zeros(len(names))
    for e, offset in zip(skeleton.ends.tolist(), skeleton.end_offsets, strict=True):
        tip[e] = max(tip[e], float(np.linalg.norm(offset)))
    for j, p in enumerate(skeleton.parents.tolist()):
        palm = not re.search("thumb|index|mid|ring|little|pink", names[p])
        # the count begins at the wrist: the last joint above the finger
        start = 0.0 if palm else length[p]
        length[j] = start + (np.linalg.norm(skeleton.offsets[j]) if p >= 0 else 0.0)
    return float(max(length[j] + tip[j] for j in fingers))


def _up(places: Floats, j: Mapping[str, int]) -> tuple[str, str]:
    """The axis along which the head is above the ankles."""
    ankles = (places[:, j["l_foot"]] + places[:, j["r_foot"]]) / 2
    rise = places[:, j.get("head", j["neck"])] - ankles
    axis = np.argmax(np.abs(rise), axis=1)
    common = [a for a in range(3) if np.mean(axis == a) >= 0.1]
    why = "the head is above the ankles along it"
    if len(common) > 1:
        spread = np.ptp(np.percentile(places.min(axis=1), [10, 90], axis=0), axis=0)
        common = [min(common, key=lambda a: float(spread[a]))]
        why = "the lowest joint keeps its height along it"
    best = common[0]
    sign = "-" if np.median(rise[axis == best, best]) < 0 else ""
    return sign + "xyz"[best], why
