"""Delta windows, deltas of takes, intervals of labels."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError
from miburi.hmm import by_label, deltas, global_variance, windows

from . import naive

HALVES = st.tuples(st.integers(1, 4), st.integers(1, 4))


def test_windows_of_the_paper():
    delta, square = windows()
    assert delta.tolist() == [-0.5, 0.0, 0.5]
    assert square.tolist() == [0.25, -0.5, 0.25]


@given(HALVES)
def test_windows_are_the_equations(half):
    delta, square = windows(half)
    assert np.allclose(delta, naive.delta_window(half[0]), rtol=1e-14)
    assert np.allclose(square, naive.square_window(half[1]), rtol=1e-13, atol=1e-16)


@given(HALVES, st.integers(1, 12), st.integers(1, 3), st.integers(0, 99))
def test_deltas_are_the_equations(half, frames, features, seed):
    x = np.random.default_rng(seed).normal(size=(frames, features))
    assert np.allclose(deltas(x, half), naive.deltas(x, half), rtol=0, atol=1e-13)


@given(HALVES, st.integers(1, 12), st.floats(-1e6, 1e6))
def test_a_constant_has_no_deltas_at_all(half, frames, value):
    assert not deltas(np.full((frames, 1), value), half)[:, 1:].any()


def test_deltas_of_a_ramp_are_its_slope():
    found = deltas(np.arange(10.0)[:, None] * 3, (2, 2))
    assert np.allclose(found[2:-2, 1], 3.0) and np.allclose(found[2:-2, 2], 0.0, atol=1e-13)


@pytest.mark.parametrize(
    ("x", "half", "said"),
    [
        ([[0.0], [np.nan]], (1, 1), "frame 1, column 0: found nan"),
        ([[0.0, np.inf]], (1, 1), "frame 0, column 1: found inf"),
        ([1.0, 2.0], (1, 1), r"shape \(2,\)"),
        (np.zeros((0, 3)), (1, 1), r"shape \(0, 3\)"),
        ([["a"]], (1, 1), "something else than numbers"),
        ([[1.0]], (0, 1), r"half lengths .* are \(0, 1\)"),
        ([[1.0]], (1,), "expected two whole numbers"),
    ],
)
def test_what_deltas_refuse(x, half, said):
    with pytest.raises(InputError, match=said):
        deltas(x, half)


def test_intervals_see_the_frame_before_them():
    x = np.arange(12.0)[:, None] ** 2
    cut = by_label([(x, [(0, 5, "b"), (5, 12, "a")]), (x[:4], [(1, 3, "b")])])
    assert list(cut) == ["a", "b"]
    assert np.array_equal(cut["a"][0], deltas(x)[5:])
    assert cut["a"][0][0, 1] == (36 - 16) / 2
    assert [len(s) for s in cut["b"]] == [5, 2]
    assert by_label([(x, [(0, 5, "b")])], None)["b"][0].shape == (5, 1)


def test_an_interval_outside_its_take_is_named():
    with pytest.raises(InputError, match="take 0: the interval 'r' from 2 to 5 lies outside its 4 frames"):
        by_label([(np.zeros((4, 1)), [(2, 5, "r")])])


def test_global_variance_of_all_frames():
    rng = np.random.default_rng(0)
    takes = [rng.normal(size=(9, 2)), rng.normal(size=(5, 2))]
    for x in takes:
        x[:, 1] = 127.1
    found = global_variance(takes)
    assert np.allclose(found, np.concatenate([deltas(x) for x in takes]).var(axis=0), rtol=1e-12, atol=1e-20)
    assert found[1] == found[3] == found[5] == 0.0  # not the rounding of a mean
