"""Durations against enumeration of all paths and eq. 9 as printed; frames per state."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError
from miburi.hmm import durations, kernels, train
from miburi.hmm.timing import frames_per_state

from . import naive
from .test_training import drawn, joined, movements

SEEDS = st.integers(0, 10**6)


@given(SEEDS, st.integers(1, 4), st.booleans())
def test_exact_durations_are_the_sum_over_all_paths(seed, states, exits):
    densities, stay, leave = drawn(np.random.default_rng(seed), states, exits)
    x, offsets = joined(densities)
    found = kernels.exact_durations(x, offsets, stay, leave, exits)
    assert np.allclose(found, naive.exact_sums(densities, stay, leave, exits), rtol=1e-10, atol=1e-12)


@given(SEEDS, st.integers(1, 4), st.booleans())
def test_product_durations_are_equation_9(seed, states, exits):
    densities, stay, leave = drawn(np.random.default_rng(seed), states, exits)
    x, offsets = joined(densities)
    gammas = [naive.expectation([d], stay, leave, exits)[0] for d in densities]
    found = kernels.product_durations(x, offsets, stay, leave, exits)
    assert np.allclose(found, naive.product_sums(gammas), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("form", ["exact", "product"])
@pytest.mark.parametrize("exits", [True, False])
def test_durations_of_a_model_are_the_equations(form, exits):
    """Eqs. 10 and 11 from a trained model's own densities and transitions."""
    x = movements(np.random.default_rng(11), 4, longest=8, dims=1)
    model = train(x, exit=exits, floor=0.3)
    densities = [naive.log_densities(s, model.mean, model.variance) for s in x]
    stay, leave = model.logs
    if form == "exact":
        count, total, squares = naive.exact_sums(densities, stay, leave, exits)
    else:
        gammas = [naive.expectation([d], stay, leave, exits)[0] for d in densities]
        count, total, squares = naive.product_sums(gammas)
    mean, variance = durations(model, x, form=form)
    assert np.allclose(mean, total / count, rtol=1e-9)
    assert np.allclose(variance, squares / count - mean**2, rtol=1e-7, atol=1e-9)
    same = train(x, exit=exits, floor=0.3, durations=form)
    assert np.allclose(same.duration_mean, mean) and np.allclose(same.duration_variance, variance)


@given(SEEDS, st.integers(1, 5), st.sampled_from(["diagonal", "full"]))
def test_with_an_exit_exact_durations_add_up_to_the_mean_length(seed, states, covariance):
    x = movements(np.random.default_rng(seed), 5, shortest=states, dims=2)
    model = train(x, states=states, covariance=covariance, iterations=4)
    assert np.isclose(model.duration_mean.sum(), np.mean([len(s) for s in x]), rtol=1e-10)


@pytest.mark.parametrize("form", ["exact", "product"])
def test_a_state_that_is_never_reached_lasts_no_time(form):
    """Without an exit, intervals that look like the first state alone never leave it."""
    model = train([np.repeat([0.0, 100.0], 4)[:, None]] * 3, states=2, exit=False, floor=0.0)
    mean, variance = durations(model, [np.zeros((5, 1))], form=form)
    assert mean.tolist() == [5.0, 0.0] and variance.tolist() == [0.0, 0.0]


def test_an_interval_that_the_model_does_not_allow():
    model = train([[[0.0], [1.0], [2.0]]])  # each state lasts one frame
    with pytest.raises(InputError, match="transitions do not allow its length"):
        durations(model, [np.arange(5.0)[:, None]])
    with pytest.raises(InputError, match="found 2 features, the model has 1"):
        durations(model, [np.zeros((4, 2))])
    with pytest.raises(InputError, match="durations are 'hsmm'"):
        durations(model, [[[0.0], [1.0], [2.0]]], form="hsmm")


def test_rounding_is_equation_20():
    mean = np.array([0.2, 1.4999, 1.5, 2.5, 7.0])
    frames, rho = frames_per_state(mean, np.ones(5))
    assert frames.tolist() == [1, 1, 2, 3, 7] and rho == 0.0


def test_rho_slows_and_hastens():
    mean, variance = np.array([4.0, 4.0]), np.array([1.0, 4.0])
    assert frames_per_state(mean, variance, rho=1.0)[0].tolist() == [5, 8]
    assert frames_per_state(mean, variance, rho=-0.5)[0].tolist() == [4, 2]  # ⌊3.5 + ½⌋
    assert frames_per_state(mean, variance, rho=-9.0)[0].tolist() == [1, 1]


@given(
    st.lists(st.tuples(st.floats(1.0, 30.0), st.floats(0.01, 20.0)), min_size=1, max_size=12),
    st.integers(0, 300),
)
def test_a_length_is_met_exactly(states, more):
    mean, variance = np.array(states).T
    length = len(mean) + more
    frames, rho = frames_per_state(mean, variance, length=length)
    assert frames.sum() == length and frames.min() >= 1
    wanted = np.maximum(1.0, mean + rho * variance)
    if rho:  # largest remainders: nobody is a frame or more from its share, and the shares add up
        assert np.isclose(wanted.sum(), length)
        assert np.abs(frames - wanted).max() < 1.0 + 1e-9


def test_equal_remainders_go_to_the_first():
    frames, _ = frames_per_state(np.tile([3.0, 3.2], 20), np.ones(40), length=134)
    assert frames.tolist() == [3, 4] * 14 + [3, 3] * 6


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"length": 1}, "length is 1, expected 2 or more"),
        ({"length": 10**12}, "would last 1e.12 frames"),
        ({"length": 7.5}, "length is 7.5, expected a whole number"),
        ({"length": 9, "rho": 1.0}, "expected one of the two"),
        ({"rho": np.nan}, "rho is nan"),
        ({"rho": 1e300}, "would last"),
    ],
)
def test_what_frames_per_state_refuses(settings, said):
    with pytest.raises(InputError, match=said):
        frames_per_state(np.array([2.0, 3.0]), np.array([1.0, 1.0]), **settings)


def test_durations_that_never_vary_cannot_be_stretched():
    with pytest.raises(InputError, match="length is 9, expected 5: no other duration varies"):
        frames_per_state(np.array([2.0, 3.0]), np.zeros(2), length=9)
    assert frames_per_state(np.array([2.0, 3.0]), np.zeros(2), length=5)[0].tolist() == [2, 3]
