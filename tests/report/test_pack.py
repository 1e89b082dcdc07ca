"""Packed numbers and limbs' shares against the same written out."""

from __future__ import annotations

import base64
import gzip
import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.report.naive import contributions_naive, unpacked_naive

from miburi.errors import InputError
from miburi.figures import BODY_JOINTS, HAND, PERSON
from miburi.motion import Motion
from miburi.render.figure import LIMBS, limbs
from miburi.report.contribution import COLUMNS, contributions
from miburi.report.pack import UNITS, Clips, packed, packed_json
from miburi.retrieval import subspace

STEPS = arrays(np.int64, st.tuples(st.integers(1, 9), st.integers(1, 4)), elements=st.integers(-32767, 32767))


@given(STEPS, st.sampled_from([1.0, 0.002, 7.0]))
def test_numbers_come_back(steps: np.ndarray, unit: float) -> None:
    found = unpacked_naive(packed(steps * unit, unit), len(steps))
    assert found == steps.tolist()


def test_numbers_are_rounded_to_the_unit() -> None:
    x = np.cumsum(np.random.default_rng(3).normal(size=(200, 5)), axis=0)
    found = 0.01 * np.array(unpacked_naive(packed(x, 0.01), 200))
    assert np.abs(found - x).max() <= 0.005 + 1e-9
    assert packed(x, 0.01) == packed(x, 0.01)


@pytest.mark.parametrize("value", [32768.0, np.nan, np.inf])
def test_what_does_not_fit_is_refused(value: float) -> None:
    with pytest.raises(InputError, match="16 bits"):
        packed([[value]], 1.0)


def test_structures_are_gzipped_json() -> None:
    value = {"b": "<身>", "a": [1, None]}
    assert json.loads(gzip.decompress(base64.b64decode(packed_json(value)))) == value


def standing(frames: int = 61, fps: float = 60.0) -> Motion:
    still = np.zeros((frames, len(PERSON), 4))
    still[..., 3] = 1.0
    return Motion(PERSON, fps, np.zeros((frames, 3)), still)


def test_a_clip_is_packed_once_and_says_what_it_is() -> None:
    clips = Clips(fps=15.0)
    assert clips.add("a", standing())
    room = clips.room
    assert clips.add("a", standing())
    assert clips.room == room
    assert clips.add("b", standing())
    assert len(clips.skeletons) == 1
    assert clips.about["a"]["fps"] == 15.0
    assert clips.seconds("a") == pytest.approx(61 / 60, abs=1 / 15)
    points = clips.skeletons[0]["points"]
    found = UNITS["body"] * np.array(unpacked_naive(clips.data["a"], clips.about["a"]["frames"]))
    assert found.shape == (clips.about["a"]["frames"], 3 * points)
    assert np.ptp(found.reshape(-1, points, 3)[0, :, 1]) == pytest.approx(1.7, abs=0.1), "a person's height"


def test_without_room_nothing_is_added() -> None:
    clips = Clips(room=10)
    assert not clips.add("a", standing())
    assert not clips.data
    assert not clips.about


def test_limbs() -> None:
    parts = dict(zip(PERSON.joints, limbs(PERSON), strict=False))
    assert LIMBS[parts["l_hand"]] == "left arm"
    assert LIMBS[parts["r_knee"]] == "right leg"
    assert LIMBS[parts["neck"]] == "trunk"
    fingers = limbs(HAND)
    assert fingers[HAND.index("thumb3")] == 1
    assert fingers[HAND.index("little1")] == 5
    assert fingers[0] == 0
    names = [*(j for j in BODY_JOINTS for _ in "xyz"), *("trunk",) * 3]
    for column, name in zip(COLUMNS, names, strict=True):
        assert LIMBS[column] == LIMBS[parts.get(name, 0)]


def test_shares_against_the_equation() -> None:
    rng = np.random.default_rng(5)
    query, frames = rng.normal(size=(30, 42)), rng.normal(size=(20, 42)) + 0.3
    mean, basis = subspace.fit(frames, 5)
    found = contributions(query, frames, mean, basis, 5)
    np.testing.assert_allclose(found, contributions_naive(query, frames, 5), rtol=1e-9)
    assert found.sum() == pytest.approx(1.0)


def test_the_limb_that_differs_has_the_share() -> None:
    rng = np.random.default_rng(6)
    query = 0.01 * rng.normal(size=(40, 42))
    frames = query.copy()
    right_arm = LIMBS.index("right arm")
    frames[:, right_arm == COLUMNS] += 1.0
    shares = contributions(query, frames, *subspace.fit(frames, 5))
    assert shares[right_arm] > 0.9


def test_equal_stills_share_nothing() -> None:
    still = np.ones((4, 42))
    assert contributions(still, still, *subspace.fit(still, 5)).tolist() == [0.0] * len(LIMBS)
