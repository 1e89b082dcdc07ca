"""Which joint of a skeleton is the knee: names of joints in the conventions of the world's software.

Canonical joints are `waist` (the root of the hips), `head` (where there is one) and the 13 of
`miburi.figures.BODY_JOINTS`. A joint sits at the proximal end of its bone, so `l_shoulder` is the head of
the upper arm (not the collar bone), `l_hand` the wrist, `l_foot` the ankle and `neck` the joint at the top
of the trunk, from which the neck rises.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import NamedTuple

from miburi.errors import InputError
from miburi.figures import BODY_JOINTS
from miburi.motion import Skeleton

REQUIRED = ("waist", *BODY_JOINTS)
"""The joints that a body must have."""


class Convention(NamedTuple):
    """Names of one family of software; `*` is the side, blanks part alternatives, the first that is there
    counts."""

    family: str
    sides: tuple[str, str]
    waist: str
    neck: str
    head: str
    shoulder: str
    elbow: str
    hand: str
    hip: str
    knee: str
    foot: str


_LEFT = ("left", "right")
_L = ("l", "r")

CONVENTIONS = (
    # CMU and HDM05 skeletons (.asf). The wrist bone begins at the end of the radius; public conversions to
    # BVH call that joint the hand, too.
    Convention(
        "Acclaim (CMU, HDM05)", _L, "root hips", "lowerneck neck", "head",
        "*humerus", "*radius", "*wrist *hand", "*femur", "*tibia", "*foot",
    ),
    Convention(
        "MotionBuilder, Mixamo, Rokoko, Perception Neuron, LaFAN1", _LEFT, "hips pelvis root",
        "neck neck1 head", "head", "*arm", "*forearm", "*hand", "*upleg", "*leg", "*foot",
    ),
    Convention(
        "Biovision", _LEFT, "hips", "neck", "head",
        "*uparm", "*lowarm", "*hand", "*upleg", "*lowleg", "*foot",
    ),
    Convention(
        "Xsens, Mocapbank, SMPL, OpenNI", _LEFT, "hips pelvis torso root", "lowerneck neck", "head",
        "*shoulder", "*elbow", "*wrist *hand", "*hip", "*knee", "*ankle *foot",
    ),
    Convention(
        "SMPL (short), miburi's own", _L, "waist pelvis hips root", "neck", "head",
        "*shoulder", "*elbow", "*wrist *hand", "*hip", "*knee", "*ankle *foot",
    ),
    Convention(
        "DAZ, Poser", _L, "hip pelvis", "neck necklower", "head",
        "*shldr *shldrbend", "*forearm *forearmbend", "*hand", "*thigh *thighbend", "*shin", "*foot",
    ),
    Convention(
        "iClone, 3ds Max Biped", _L, "hip pelvis", "necktwist01 neck", "head",
        "*upperarm", "*forearm", "*hand", "*thigh", "*calf", "*foot",
    ),
    Convention(
        "Bandai-Namco", _L, "hips", "neck", "head",
        "upperarm*", "lowerarm*", "hand*", "upperleg*", "lowerleg*", "foot*",
    ),
    Convention(
        "Blender Rigify", _L, "hips pelvis spine", "neck", "head",
        "upperarm*", "forearm*", "hand*", "thigh*", "shin*", "foot*",
    ),
    Convention(
        "Unreal", _L, "pelvis hips", "neck neck01", "head",
        "upperarm*", "lowerarm*", "hand*", "thigh*", "calf*", "foot*",
    ),
    Convention(
        "Unity, VRM", _LEFT, "hips", "neck", "head",
        "*upperarm", "*lowerarm", "*hand", "*upperleg", "*lowerleg", "*foot",
    ),
    Convention(
        "MakeHuman", _L, "root", "neck01", "head",
        "upperarm01*", "lowerarm01*", "wrist*", "upperleg01*", "lowerleg01*", "foot*",
    ),
    Convention(
        "MakeHuman (old)", _L, "hips root", "neck", "head",
        "uparm*", "loarm*", "hand*", "upleg*", "loleg*", "foot*",
    ),
)  # fmt: skip
"""Families are told apart by having all their names there, so that `LeftShoulder` is a collar bone beside
`LeftArm` and an upper arm beside `LeftElbow`."""

_RIGS = re.compile(r"^(mixamorig\d*|ccbase|bip0*1|def|org|character\d*|model|beta)(?=[a-z])")


def _normal(name: str) -> str:
    """A joint's name without name space, rig prefix, case and punctuation; empty for helpers
    (`__UpLeg_L`)."""
    if name.startswith("__"):
        return ""
    plain = re.sub(r"[^a-z0-9]", "", name.rsplit(":", 1)[-1].lower())
    return _RIGS.sub("", plain)


def _names(skeleton: Skeleton) -> dict[str, int]:
    """Normal name → joint; the first of equal ones counts. A prefix that all joints share is left out as
    well."""
    ends = [m.end() for m in re.finditer(r"[_:. -]", skeleton.joints[0])]
    cut = next(
        (e for e in reversed(ends) if all(n[:e] == skeleton.joints[0][:e] for n in skeleton.joints)), 0
    )
    found: dict[str, int] = {}
    for j, name in enumerate(skeleton.joints):
        for variant in (_normal(name), _normal(name[cut:])):
            if variant:
                found.setdefault(variant, j)
    return found


def _matched(convention: Convention, names: Mapping[str, int]) -> dict[str, int]:
    """The canonical joints that a skeleton has by one convention."""
    found: dict[str, int] = {}

    def look(canonical: str, patterns: str, side: str = "") -> None:
        for pattern in patterns.split():
            if (j := names.get(pattern.replace("*", side))) is not None:
                found[canonical] = j
                return

    for part in ("waist", "neck", "head"):
        look(part, getattr(convention, part))
    for letter, side in zip("lr", convention.sides, strict=True):
        for part in ("shoulder", "elbow", "hand", "hip", "knee", "foot"):
            look(f"{letter}_{part}", getattr(convention, part), side)
    return found


def find_joints(skeleton: Skeleton, overrides: Mapping[str, str] | None = None) -> dict[str, int]:
    """The canonical joints of a body, whatever software named them.

    Parameters
    ----------
    skeleton
        A body in any convention of `CONVENTIONS`.
    overrides
        Canonical joint → name in this skeleton; they come before the tables.

    Returns
    -------
    dict
        waist, head (if there is one) and the 13 BODY_JOINTS → index of the joint.

    Raises
    ------
    InputError
        A joint is missing; the sentence lists what the skeleton has.
    """
    fixed: dict[str, int] = {}
    for canonical, name in (overrides or {}).items():
        if canonical not in (*REQUIRED, "head"):
            raise InputError(
                f"joints.{canonical}: there is no such joint; there are {', '.join((*REQUIRED, 'head'))}"
            )
        fixed[canonical] = skeleton.index(name)
    names = _names(skeleton)
    best: dict[str, int] = {}
    for convention in CONVENTIONS:
        found = _matched(convention, names) | fixed
        if all(j in found for j in REQUIRED):
            return {j: found[j] for j in (*REQUIRED, "head") if j in found}
        best = max(best, found, key=lambda f: sum(j in f for j in REQUIRED))
    missing = [j for j in REQUIRED if j not in best]
    raise InputError(
        f"skeleton {skeleton.name!r} has no joint that is known as {', '.join(missing)}; it has "
        f"{', '.join(skeleton.joints)}: name the joints under the config key `joints`"
    )


def family(skeleton: Skeleton) -> str | None:
    """Name of the first convention that fits a skeleton whole; None if none does."""
    names = _names(skeleton)
    return next((c.family for c in CONVENTIONS if all(j in _matched(c, names) for j in REQUIRED)), None)
