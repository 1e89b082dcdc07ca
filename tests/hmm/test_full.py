"""Generation from full covariances, log-likelihoods and steps of a staircase, against the equations written out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError
from miburi.hmm import full, log_likelihood, mlpg, solver, windows

from . import naive
from .test_generation import HALVES, gaussians


def covariances(rng, steps, dims):
    a = rng.normal(size=(steps, 3 * dims, 3 * dims))
    return a @ a.transpose(0, 2, 1) + 0.1 * np.eye(3 * dims)


@given(HALVES, st.integers(1, 9), st.integers(1, 3), st.integers(0, 10**6))
def test_full_covariances_are_one_dense_system(half, frames, dims, seed):
    rng = np.random.default_rng(seed)
    mean, covariance = rng.normal(size=(frames, 3 * dims)), covariances(rng, frames, dims)
    found, expected = mlpg(mean, covariance, half=half), naive.full_mlpg(mean, covariance, half)
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    score = log_likelihood(found, mean, covariance, half=half)
    assert np.isclose(score, naive.log_likelihood(found, mean, covariance, half), rtol=1e-9)
    for _ in range(5):  # and it is the likeliest
        other = found + rng.normal(0, 0.01, found.shape)
        assert log_likelihood(other, mean, covariance, half=half) < score


@given(HALVES, st.integers(1, 12), st.integers(1, 3), st.integers(0, 10**6))
def test_diagonal_ones_are_the_diagonal_case(half, frames, dims, seed):
    mean, variance = gaussians(np.random.default_rng(seed), frames, dims)
    whole = np.array([np.diag(v) for v in variance])
    x = mlpg(mean, variance, half=half)
    assert np.allclose(mlpg(mean, whole, half=half), x, rtol=1e-8, atol=1e-8 * np.abs(x).max())
    expected = naive.log_likelihood(x, mean, whole, half)
    for v in (variance, whole):
        assert np.isclose(log_likelihood(x, mean, v, half=half), expected, rtol=1e-9)


@given(HALVES, st.lists(st.integers(1, 9), min_size=1, max_size=8), st.integers(1, 60), st.integers(0, 99))
def test_steps_that_last_are_their_frames(half, frames, dims, seed):
    mean, variance = gaussians(np.random.default_rng(seed), len(frames), dims)
    found = mlpg(mean, variance, half=half, frames=frames)
    each = mlpg(mean.repeat(frames, axis=0), variance.repeat(frames, axis=0), half=half)
    assert np.array_equal(found, each)


@given(st.integers(1, 40), st.integers(1, 100), st.integers(0, 10**6))
def test_the_papers_windows_have_a_kernel_of_their_own(frames, dims, seed):
    """It must say what the one for all windows says, over the borders of its blocks too."""
    mean, variance = gaussians(np.random.default_rng(seed), frames, dims)
    step = np.arange(frames)
    found, _ = solver.trajectory(mean, variance, step, *windows())
    expected = solver.wide(mean, variance, step, *windows())
    assert np.allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_a_correlation_carries_one_feature_with_the_other():
    """Only the first feature is told to move; the second follows where the covariance says so."""
    mean, covariance = np.zeros((20, 6)), np.tile(np.eye(6), (20, 1, 1))
    mean[10:, 0] = 10.0
    covariance[:, 1, 1] = 1e4
    assert np.abs(mlpg(mean, covariance)[:, 1]).max() < 1e-9
    covariance[:, 2, 3] = covariance[:, 3, 2] = 0.9  # of their Δ
    assert mlpg(mean, covariance)[:, 1].std() > 0.5


@pytest.mark.parametrize(
    ("covariance", "settings", "said"),
    [
        (-np.eye(3)[None], {}, "covariance of step 0 is not positive definite"),
        (np.full((1, 3, 3), np.nan), {}, "covariance of step 0 is not positive definite"),
        (np.ones((1, 3, 2)), {}, r"variance has shape \(1, 3, 2\)"),
        (np.eye(3)[None], {"frames": [0]}, "expected 1 whole numbers, 1 or more"),
        (np.eye(3)[None], {"frames": [1.5]}, "expected 1 whole numbers"),
    ],
)
def test_what_it_refuses(covariance, settings, said):
    with pytest.raises(InputError, match=said):
        mlpg(np.zeros((1, 3)), covariance, **settings)
    with pytest.raises(InputError, match="a trajectory of shape"):
        log_likelihood(np.zeros((2, 1)), np.zeros((1, 3)), np.ones((1, 3)))


def test_a_system_that_is_too_large(monkeypatch):
    monkeypatch.setattr(full, "MOST", 1e4)
    with pytest.raises(InputError, match="full covariances of 1000 frames need more than 1e-05 GB"):
        mlpg(np.zeros((1, 3)), np.eye(3)[None], frames=[1000])
