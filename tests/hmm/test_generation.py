"""Trajectories against the dense normal equations, a sparse solver and nnmnkwii."""

import json
from pathlib import Path

import numpy as np
import pytest
import scipy.sparse
import scipy.sparse.linalg
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError
from miburi.hmm import deltas, mlpg, solver, windows

from . import naive

HALVES = st.tuples(st.integers(1, 4), st.integers(1, 4))


def gaussians(rng, frames, features):
    """Means like those of features, variances over four orders of magnitude."""
    mean = rng.normal(size=(frames, 3 * features)) * np.repeat([20.0, 3.0, 1.0], features)
    return mean, 10.0 ** rng.uniform(-2, 2, size=mean.shape)


@given(HALVES, st.integers(1, 25), st.integers(1, 4), st.integers(0, 10**6))
def test_it_solves_the_normal_equations(half, frames, features, seed):
    mean, variance = gaussians(np.random.default_rng(seed), frames, features)
    expected = naive.mlpg(mean, variance, half)
    found = mlpg(mean, variance, half=half)
    assert found.shape == expected.shape
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("half", [(1, 1), (2, 3)])
def test_it_equals_a_sparse_solve(half):
    """A long string, by scipy's sparse solver: W from diagonals, least squares weighted by precisions."""
    frames, features = 3000, 2
    mean, variance = gaussians(np.random.default_rng(4), frames, features)
    found = mlpg(mean, variance, half=half)
    delta, square = windows(half)
    for m in range(features):
        blocks, precision = [scipy.sparse.eye_array(frames)], [1 / variance[:, m]]
        for k, window in enumerate((delta, square), 1):
            length = len(window) // 2
            blocks.append(
                scipy.sparse.diags_array(window, offsets=range(-length, length + 1), shape=(frames, frames))
            )
            p = 1 / variance[:, k * features + m]
            p[:length] = p[-length:] = 0.0
            precision.append(p)
        w, p = scipy.sparse.vstack(blocks), np.concatenate(precision)
        right = w.T @ (p * mean[:, m::features].T.ravel())
        left = (w.T @ scipy.sparse.diags_array(p) @ w).tocsc()
        expected = scipy.sparse.linalg.spsolve(left, right)
        assert np.allclose(found[:, m], expected, rtol=1e-9, atol=1e-8)


KEPT = solver._PART + solver._AHEAD


@pytest.mark.parametrize("frames", [1, 2, KEPT, KEPT + 1, KEPT + solver._PART, KEPT + 2 * solver._PART + 1])
def test_parts_of_a_long_string_join(frames):
    """States of many lengths, more features than are solved side by side, where parts begin and end."""
    rng = np.random.default_rng(frames)
    lasting = rng.integers(1, 9, frames)
    lasting = lasting[: np.searchsorted(lasting.cumsum(), frames) + 1]
    lasting[-1] -= lasting.sum() - frames
    mean, variance = gaussians(rng, len(lasting), 50)
    step = np.repeat(np.arange(len(lasting)), lasting)
    expected = solver.wide(mean, variance, step, *windows())
    np.testing.assert_allclose(mlpg(mean, variance, frames=lasting), expected, rtol=1e-9, atol=1e-9)
    x, some = np.empty((frames + 2, 48)), (solver._block(v, 0) for v in (mean, variance))
    assert solver._narrow(*some, step, True, solver._PART, x) == (True, True)
    np.testing.assert_allclose(x[:-2], expected[:, :48], rtol=1e-9, atol=1e-9)


def test_a_frame_may_depend_on_one_far_ahead():
    """Further than a part of a long string looks: only the first and the last frame are told where to be."""
    frames = solver._WHOLE + KEPT
    mean, variance = np.zeros((frames, 3)), np.ones((frames, 3))
    variance[1:-1, 0] = np.inf
    mean[-1, 0] = 1.0
    _, settled = solver._narrow(
        *(solver._block(v, 0) for v in (mean, variance)),
        np.arange(frames),
        True,
        solver._PART,
        np.empty((frames + 2, 48)),
    )
    assert not settled
    expected = solver.wide(mean, variance, np.arange(frames), *windows())
    assert np.ptp(expected) > 0.1
    np.testing.assert_allclose(mlpg(mean, variance), expected, rtol=1e-9, atol=1e-9)


def nnmnkwii_windows(half):
    delta, square = windows(half)
    return [(0, 0, np.array([1.0])), (half[0], half[0], delta), (half[1], half[1], square)]


@pytest.mark.parametrize("frames", [5, 9, 40])
def test_it_equals_nnmnkwii(frames):
    paramgen = pytest.importorskip("nnmnkwii.paramgen")
    for half in ((1, 1), (2, 2)):
        mean, variance = gaussians(np.random.default_rng(frames), frames, 3)
        expected = paramgen.mlpg(mean, variance, nnmnkwii_windows(half))
        assert np.allclose(mlpg(mean, variance, half=half), expected, rtol=1e-9, atol=1e-9)


def test_it_equals_the_numbers_of_nnmnkwii():
    golden = json.loads((Path(__file__).parent / "golden_mlpg.json").read_text())
    for case in golden["cases"]:
        found = mlpg(case["mean"], case["variance"], half=tuple(case["half"]))
        assert np.allclose(found, case["trajectory"], rtol=1e-9, atol=1e-9)


@given(HALVES, st.integers(1, 12), st.integers(0, 99))
def test_a_trajectory_is_found_again_from_its_own_features(half, frames, seed):
    x = np.random.default_rng(seed).normal(size=(frames, 2))
    assert np.allclose(mlpg(deltas(x, half), np.full((frames, 6), 0.3), half=half), x, atol=1e-9)


@given(st.integers(1, 200), st.floats(-1e4, 1e4), st.floats(1e-12, 1e6))
def test_a_constant_comes_back(frames, value, variance):
    mean = np.zeros((frames, 3))
    mean[:, 0] = value
    found = mlpg(mean, np.full((frames, 3), variance))
    assert np.allclose(found, value, rtol=1e-11, atol=1e-13)


def test_a_step_is_smoothed_more_where_changes_are_surer():
    mean = np.zeros((40, 3))
    mean[20:, 0] = 10.0
    rough = np.ones((40, 3))
    smooth = rough * [1.0, 0.05, 0.05]
    jumps = [np.abs(np.diff(mlpg(mean, v), axis=0)).max() for v in (rough, smooth)]
    assert jumps[1] < 0.5 * jumps[0] < 5.0


def test_infinite_variance_says_nothing():
    rng = np.random.default_rng(0)
    mean, variance = gaussians(rng, 12, 2)
    variance[:, 2:] = np.inf
    assert np.allclose(mlpg(mean, variance), mean[:, :2], rtol=1e-12)
    mean, variance = gaussians(rng, 12, 2)
    other = mean.copy()
    variance[4, 1], other[4, 1] = np.inf, 1e6
    assert np.array_equal(mlpg(mean, variance), mlpg(other, variance))


def test_a_missing_frame_is_bridged():
    mean = np.zeros((9, 3))
    mean[:, 0] = np.arange(9.0)
    mean[:, 1] = 1.0
    variance = np.full((9, 3), 1e-3)
    variance[3:6, 0] = np.inf
    mean[3:6, 0] = -77.0
    assert np.allclose(mlpg(mean, variance)[:, 0], np.arange(9.0), atol=1e-9)


@pytest.mark.parametrize(
    ("mean", "variance", "said"),
    [
        (np.zeros((3, 4)), np.ones((3, 4)), "mean has 4 columns, expected 3 M"),
        (np.zeros((3, 3)), np.ones((2, 3)), r"variance has shape \(2, 3\)"),
        (np.zeros((0, 3)), np.ones((0, 3)), r"shape \(0, 3\)"),
        ([[0.0, np.nan, 0.0]], np.ones((1, 3)), "mean, frame 0, column 1: found nan"),
        (np.zeros((1, 3)), [[1.0, 1.0, np.nan]], "variance, frame 0, column 2: found nan"),
        (np.zeros((1, 3)), [[1.0, 0.0, 1.0]], "frame 0, column 1: found 0.0, expected one above 0"),
        (np.zeros((1, 3)), [[-1.0, 1.0, 1.0]], "found -1.0"),
        (np.zeros((2, 6)), np.tile([1.0, np.inf, 1.0, 1.0, 1.0, 1.0], (2, 1)), "leave feature 1 open"),
    ],
)
def test_what_generation_refuses(mean, variance, said):
    with pytest.raises(InputError, match=said):
        mlpg(mean, variance)


@pytest.mark.parametrize("half", [(1, 1), (2, 1)])
@pytest.mark.parametrize("frames", [1, 2, 9, solver._WHOLE + 100])
def test_one_bad_value_is_found(half, frames):
    """Wherever it is, also where windows reach outside and it would not count."""
    for frame, column in ((0, 2), (frames // 2, 3), (frames - 1, 0), (frames - 1, 5)):
        for bad in (np.nan, np.inf, -np.inf):
            mean, variance = gaussians(np.random.default_rng(0), frames, 2)
            mean[frame, column] = bad
            with pytest.raises(InputError, match=f"mean, frame {frame}, column {column}"):
                mlpg(mean, variance, half=half)
        for bad in (np.nan, -np.inf, -1e-9, 0.0, -0.0):
            mean, variance = gaussians(np.random.default_rng(0), frames, 2)
            variance[frame, column] = bad
            with pytest.raises(InputError, match=f"variance, frame {frame}, column {column}"):
                mlpg(mean, variance, half=half)


@pytest.mark.parametrize("frames", [1, 2, 3, 10, 500, solver._WHOLE + 100])
def test_deltas_alone_determine_nothing(frames):
    """Without any static variance the level is free, whatever rounding leaves of the pivot."""
    rng = np.random.default_rng(frames)
    mean, variance = gaussians(rng, frames, 3)
    variance[:, 1] = np.inf
    with pytest.raises(InputError, match="leave feature 1 open"):
        mlpg(mean, variance)


def test_a_read_only_array_is_as_good():
    mean, variance = gaussians(np.random.default_rng(1), 6, 1)
    expected = mlpg(mean, variance)
    for values in (mean, variance):
        values.setflags(write=False)
    assert np.array_equal(mlpg(mean, variance), expected)
    assert np.array_equal(mlpg(np.asfortranarray(mean), variance.tolist()), expected)
