"""Standard figures: the hand that is synthesised and the person that puppets and people are mapped onto."""

from __future__ import annotations

import numpy as np

from miburi.motion import Skeleton

FINGERS = ("thumb", "index", "middle", "ring", "little")

# Right hand, fingers +Y, palm +Z, thumb +X; millimetres. Bone lengths are an adult's (proximal, middle, distal);
# bases are where each finger's first movable joint lies from the wrist.
_BASES = {
    "thumb": (24.0, 22.0, 8.0),
    "index": (24.0, 88.0, 0.0),
    "middle": (3.0, 90.0, 0.0),
    "ring": (-16.0, 84.0, 0.0),
    "little": (-33.0, 75.0, 2.0),
}
_BONES = {
    "thumb": (46.0, 34.0, 28.0),
    "index": (44.0, 27.0, 22.0),
    "middle": (49.0, 31.0, 23.0),
    "ring": (46.0, 29.0, 23.0),
    "little": (36.0, 21.0, 21.0),
}
_DIRECTIONS = {
    "thumb": (0.64, 0.74, 0.2),
    "index": (0.06, 1.0, 0.0),
    "middle": (0.0, 1.0, 0.0),
    "ring": (-0.05, 1.0, 0.0),
    "little": (-0.1, 1.0, 0.0),
}


def _hand() -> Skeleton:
    joints, parents, offsets, ends, end_offsets = ["wrist"], [-1], [np.zeros(3)], [], []
    for finger in FINGERS:
        along = np.array(_DIRECTIONS[finger]) / np.linalg.norm(_DIRECTIONS[finger])
        offset = np.array(_BASES[finger])
        parent = 0
        for k, bone in enumerate(_BONES[finger], 1):
            joints.append(f"{finger}{k}")
            parents.append(parent)
            offsets.append(offset / 1000)
            parent = len(joints) - 1
            offset = along * bone
        ends.append(parent)
        end_offsets.append(offset / 1000)
    return Skeleton(
        tuple(joints), np.array(parents), np.array(offsets), "hand", np.array(ends), np.array(end_offsets)
    )


HAND: Skeleton = _hand()
"""16 joints ([H]): the wrist and three for each finger; the ends are the fingertips."""


def _person() -> Skeleton:
    # Segment lengths of a 1.70 m adult (Drillis and Contini 1966, rounded), arms and legs hanging straight down.
    rows = [
        ("waist", -1, (0.0, 0.0, 0.0)),
        ("neck", 0, (0.0, 0.50, 0.0)),
        ("l_shoulder", 1, (0.19, -0.04, 0.0)),
        ("l_elbow", 2, (0.0, -0.30, 0.0)),
        ("l_hand", 3, (0.0, -0.26, 0.0)),
        ("r_shoulder", 1, (-0.19, -0.04, 0.0)),
        ("r_elbow", 5, (0.0, -0.30, 0.0)),
        ("r_hand", 6, (0.0, -0.26, 0.0)),
        ("l_hip", 0, (0.09, -0.06, 0.0)),
        ("l_knee", 8, (0.0, -0.42, 0.0)),
        ("l_foot", 9, (0.0, -0.42, 0.0)),
        ("r_hip", 0, (-0.09, -0.06, 0.0)),
        ("r_knee", 11, (0.0, -0.42, 0.0)),
        ("r_foot", 12, (0.0, -0.42, 0.0)),
    ]
    ends = [("neck", (0.0, 0.25, 0.0))]
    names = [r[0] for r in rows]
    return Skeleton(
        tuple(names),
        np.array([r[1] for r in rows]),
        np.array([r[2] for r in rows]),
        "person",
        np.array([names.index(j) for j, _ in ends]),
        np.array([o for _, o in ends]),
    )


PERSON: Skeleton = _person()
"""The puppet's 14 joints at a person's size ([P]): rigid trunk; hands and feet never bend; the end is the head."""

BODY_JOINTS = (
    "neck",
    "l_shoulder",
    "r_shoulder",
    "l_elbow",
    "r_elbow",
    "l_hand",
    "r_hand",
    "l_hip",
    "r_hip",
    "l_knee",
    "r_knee",
    "l_foot",
    "r_foot",
)
"""The 13 joints of [P]'s 42 values, in our order; `hand` is the wrist and `foot` the ankle."""
