"""Cuts against the bounds that a person set."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi.errors import InputError
from miburi.evaluate.segmentation import (
    Bounds,
    agreement,
    bounds,
    length_histogram,
    matches,
    read_cut_points,
    score,
    uniform_cuts,
)
from miburi.formats.annotations import Annotation

times = st.lists(st.floats(0, 5), max_size=5)


def naive_matches(cuts, ranges):
    """The best of all ways to pair cuts with bounds."""
    if not cuts:
        return 0
    best = naive_matches(cuts[1:], ranges)
    for k, (low, high) in enumerate(ranges):
        if low <= cuts[0] <= high:
            best = max(best, 1 + naive_matches(cuts[1:], ranges[:k] + ranges[k + 1 :]))
    return best


@given(times, times)
def test_pairs_are_as_many_as_can_be(cuts, best):
    low, high = np.sort(best) - 0.5, np.sort(best) + 0.5
    inside = [c for c in cuts if not np.any(np.isclose(np.abs(c - np.array(best)), 0.5, atol=1e-6))]
    assert matches(inside, low, high) == naive_matches(inside, list(zip(low, high, strict=True)))


def test_cuts_at_the_bounds_are_right_and_elsewhere_wrong():
    human = Bounds(*(np.array([2.0, 5.0, 8.0]),) * 3)
    perfect = score("a", "PPCA", [agreement([2.2, 4.6, 8.0], human, 10.0)], "recorded")
    assert (perfect.precision, perfect.recall, perfect.found, perfect.cuts) == (1.0, 1.0, 3, 3)
    assert perfect.uniform_recall == pytest.approx(1.0)  # 2.5, 5, 7.5
    off = score("a", "PPCA", [agreement([3.0, 3.5, 5.2, 6.0], human, 10.0)], "recorded")
    assert (off.precision, off.recall) == (0.25, round(1 / 3, 4))
    none = score("a", "PPCA", [agreement([], human, 10.0)], "recorded")
    assert np.isnan(none.precision) and none.recall == 0


def test_chance_is_what_random_cuts_find():
    human = Bounds(*(np.array([50.0]),) * 3)
    # one cut in a hundred seconds hits a range of one second once in a hundred
    assert agreement([1.0], human, 100.0).random == pytest.approx(0.01, abs=0.01)
    assert agreement([1.0], human, 100.0) == agreement([1.0], human, 100.0)


def test_the_acceptable_range_counts_as_well():
    human = Bounds(np.array([5.0]), np.array([3.8]), np.array([5.2]))
    one = agreement([4.0], human, 10.0)
    assert (one.found, one.accepted) == (0, 1)


def test_bounds_of_intervals():
    rows = [Annotation("t", a, b, "k") for a, b in [(0.3, 2.0), (2.0, 5.0), (5.6, 7.0), (9.0, 9.8)]]
    found = bounds(rows, 10.0)
    # 0.3 and 9.8 are the take's ends; 5.0 and 5.6 are one; something without a name is between 7 and 9
    np.testing.assert_allclose(found.best, [2.0, 5.3, 7.0, 9.0])
    assert len(bounds([], 10.0).best) == 0


def test_uniform_cuts_and_lengths():
    np.testing.assert_allclose(uniform_cuts(3, 8.0), [2, 4, 6])
    rows = length_histogram([0.2, 0.5, 0.7, 14.9, 99.0])
    assert sum(n for _, _, n in rows) == 5
    assert rows[0] == (0.0, 0.5, 1) and rows[1] == (0.5, 1.0, 2) and rows[-1] == (15.0, np.inf, 1)


def test_cut_points_of_a_person(tmp_path, recordings):
    found = read_cut_points(recordings / "body/segmentation/86_01.txt", 120.0)
    np.testing.assert_allclose(found.best[:2] * 120, [550, 1150])
    np.testing.assert_allclose(found.latest[:2] * 120, [600, 1200])
    assert len(found.best) == 6
    for path in sorted((recordings / "body/segmentation").glob("86_*.txt")):
        each = read_cut_points(path, 120.0)
        assert (each.earliest <= each.best).all() and (each.best <= each.latest).all()
    (tmp_path / "a.txt").write_text("2\n1 walk\n10 20\n2 run\n50\n")
    with pytest.raises(InputError, match=r"a\.txt, line 3: 2 frames"):
        read_cut_points(tmp_path / "a.txt", 120.0)
    (tmp_path / "a.txt").write_text("walk\n")
    with pytest.raises(InputError, match="holds no line"):
        read_cut_points(tmp_path / "a.txt", 120.0)
