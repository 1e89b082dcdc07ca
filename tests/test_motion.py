"""Skeletons and motions: what they refuse, and that they do not change."""

from __future__ import annotations

import numpy as np
import pytest

from miburi.errors import InputError
from miburi.figures import BODY_JOINTS, FINGERS, HAND, PERSON
from miburi.motion import Motion, Skeleton

REST = np.tile([0.0, 0, 0, 1], (5, 14, 1))


def walk(**settings) -> Motion:
    arguments = {"root": np.arange(15.0).reshape(5, 3), "rotations": REST, "name": "walk"}
    return Motion(PERSON, 30, **(arguments | settings))


@pytest.mark.parametrize(
    ("parents", "offsets", "joints", "message"),
    [
        ([-1, 0], np.zeros((2, 3)), ("a", "a"), "joint 'a' stands twice"),
        ([-1, 2, 0], np.zeros((3, 3)), ("a", "b", "c"), "every joint after its parent"),
        ([0, 0], np.zeros((2, 3)), ("a", "b"), "the root must come first"),
        ([-1, -1], np.zeros((2, 3)), ("a", "b"), "the root must come first"),
        ([-1], np.zeros((2, 3)), ("a",), "1 joints, 1 parents and 2 offsets"),
        ([], np.zeros((0, 3)), (), "0 joints"),
        ([-1, 0], [[0, 0, 0], [0, np.nan, 0]], ("a", "b"), "an offset is not finite"),
    ],
)
def test_trees_that_are_none(parents, offsets, joints, message):
    with pytest.raises(InputError, match=message):
        Skeleton(joints, np.array(parents, dtype=np.int32), offsets, "odd")


def test_ends_belong_to_joints():
    with pytest.raises(InputError, match="an end belongs to no joint"):
        Skeleton(("a",), [-1], [[0, 0, 0]], "", [1], [[0, 0, 1]])
    with pytest.raises(InputError, match="1 ends and 0 end offsets"):
        Skeleton(("a",), [-1], [[0, 0, 0]], "", [0], np.zeros((0, 3)))


def test_an_unknown_joint_is_answered_with_those_that_there_are():
    with pytest.raises(InputError, match=r"has no joint 'tail'; it has waist, neck, l_shoulder"):
        PERSON.index("tail")
    assert PERSON.joints[PERSON.index("r_knee")] == "r_knee"


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"rotations": REST[:, :13]}, "'walk': arrays of 14 joints do not fit"),
        ({"rotations": REST[:4]}, "do not fit"),
        ({"translations": np.zeros((5, 13, 3))}, "do not fit"),
        ({"angles": np.zeros((5, 41))}, "do not fit"),
        ({"root": np.full((5, 3), [[np.inf, 0, 0]])}, "frame 0: a number is not finite"),
        ({"rotations": np.where(np.arange(5)[:, None, None] == 3, np.nan, REST)}, "frame 3: a number is not"),
    ],
)
def test_motions_that_do_not_fit(settings, message):
    with pytest.raises(InputError, match=message):
        walk(**settings)


@pytest.mark.parametrize("fps", [0.0, -1.0, float("nan"), float("inf")])
def test_rates_that_are_none(fps):
    with pytest.raises(InputError, match="frames per second, expected a positive number"):
        Motion(PERSON, fps, np.zeros((5, 3)), REST)


def test_motions_do_not_change():
    root = np.zeros((5, 3))
    motion = walk(root=root)
    root[0] = 9
    assert motion.root[0, 0] == 0  # a copy
    with pytest.raises(ValueError, match="read-only"):
        motion.root[0] = 1
    with pytest.raises(ValueError, match="read-only"):
        motion.skeleton.offsets[0] = 1


def test_a_range_of_frames():
    motion = walk(translations=np.ones((5, 14, 3)))
    part = motion[1:3]
    assert len(part) == 2 and len(part.translations) == 2 and part.name == "walk"
    np.testing.assert_array_equal(part.root, motion.root[1:3])
    np.testing.assert_array_equal(part.positions(), motion.positions()[1:3])
    with pytest.raises(TypeError, match="slice"):
        motion[1]


def test_the_standard_figures():
    assert len(HAND) == 16 and len(HAND.ends) == 5
    assert HAND.joints[1:] == tuple(f"{f}{k}" for f in FINGERS for k in (1, 2, 3))
    flat = Motion(HAND, 30, np.zeros((1, 3)), np.tile([0.0, 0, 0, 1], (1, 16, 1)))
    tips = flat.end_positions()[0]
    assert (tips[1:, 1] > 0.14).all() and tips[0, 0] > tips[1, 0] > tips[2, 0] > tips[3, 0] > tips[4, 0]
    assert set(PERSON.joints) == {"waist", *BODY_JOINTS}
    stands = Motion(PERSON, 30, np.zeros((1, 3)), REST[:1]).positions()[0]
    head = Motion(PERSON, 30, np.zeros((1, 3)), REST[:1]).end_positions()[0, 0]
    assert 1.6 < head[1] - stands[PERSON.index("l_foot"), 1] < 1.8  # without the feet
    assert stands[PERSON.index("l_hand"), 0] > 0 > stands[PERSON.index("r_hand"), 0]
