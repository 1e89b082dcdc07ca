"""Streams, durations searched with the trajectory, global variance, words with lengths, left-out intervals."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError
from miburi.hmm import (
    Synthesis,
    by_label,
    delay_errors,
    leave_one_out,
    log_likelihood,
    mlpg,
    solver,
    stream,
    stream_labels,
    synthesize,
    total_length,
    train,
    windows,
)
from miburi.hmm.generation import steps_of
from miburi.hmm.left_out import log_likelihood_of
from miburi.hmm.search import Staircase, joint_durations, joint_score
from miburi.hmm.variance import Spread, expected_spread, with_spread

from . import naive
from .test_generation import HALVES, gaussians
from .test_synthesis import takes

STRING = "up hold down up hold down"


@pytest.fixture(scope="module")
def models():
    return {label: train(x, label=label, fps=30.0) for label, x in by_label(takes()).items()}


@given(HALVES, st.integers(1, 14), st.integers(0, 16), st.integers(0, 10**6))
def test_a_stream_is_the_batch_of_what_is_known(half, frames, delay, seed):
    mean, variance = gaussians(np.random.default_rng(seed), frames, 2)
    found = np.array(list(stream(zip(mean, variance, [1] * frames, strict=True), delay, half=half)))
    known = [min(t + delay + 1, frames) for t in range(frames)]
    expected = np.array([mlpg(mean[:n], variance[:n], half=half)[t] for t, n in enumerate(known)])
    assert np.allclose(found, expected, rtol=1e-8, atol=1e-8 * np.abs(expected).max())


def test_a_stream_waits_no_longer_than_its_delay(models):
    asked = []

    def labels():
        for label in STRING.split():
            asked.append(label)
            yield label

    frames = stream_labels(models, labels(), 4)
    next(frames)
    assert asked == ["up"]
    rest = np.array(list(frames))
    assert asked == STRING.split() and len(rest) + 1 == total_length(models, STRING)
    whole = np.array(list(stream_labels(models, STRING.split(), 500)))
    assert np.allclose(whole, synthesize(models, STRING).trajectory, atol=1e-8)
    assert list(stream_labels(models, [], 4)) == []
    with pytest.raises(InputError, match="label 2 is 'left', known are down, hold, up"):
        list(stream_labels(models, ["up", "left"], 4))
    with pytest.raises(InputError, match="delay is -1"):
        next(stream([], -1))


def test_errors_of_a_stream_fade_with_its_delay(models):
    made = synthesize(models, STRING)
    found = delay_errors(made.mean, made.variance, [0, 2, 8, 32, 500])
    rms = [e.rms for e in found]
    assert rms == sorted(rms, reverse=True) and rms[0] > 1e-3 and found[-1].largest < 1e-8
    assert all(e.largest >= e.rms for e in found)


def staircase(rng, states):
    mean, variance = gaussians(rng, states, 1)
    return Staircase(mean, variance, rng.uniform(1.0, 5.0, states), rng.uniform(0.3, 3.0, states))


@given(st.integers(1, 4), st.floats(0.01, 100.0), st.integers(0, 10**6))
def test_the_score_is_equation_18(states, alpha, seed):
    rng = np.random.default_rng(seed)
    stairs, frames = staircase(rng, states), rng.integers(1, 6, states)
    mean, full = (
        stairs.mean.repeat(frames, 0),
        np.array([np.diag(v) for v in stairs.variance.repeat(frames, 0)]),
    )
    density = naive.log_likelihood(naive.full_mlpg(mean, full, (1, 1)), mean, full, (1, 1))
    lasting = sum(
        -0.5 * np.log(2 * np.pi * v) - (d - m) ** 2 / (2 * v)
        for d, m, v in zip(frames, stairs.lasting, stairs.spread, strict=True)
    )
    assert np.isclose(joint_score(stairs, frames, alpha), alpha * lasting + density, rtol=1e-8, atol=1e-6)


@pytest.mark.parametrize("alpha", [0.1, 1.0, 20.0])
def test_searched_durations_are_the_best_of_all_small_ones(alpha):
    """Against every way to spread the frames; the search may end at a neighbour of the best, seldom."""
    met = 0
    for seed in range(12):
        stairs = staircase(np.random.default_rng(seed), 3)
        start = np.maximum(1, np.floor(stairs.lasting + 0.5)).astype(np.int64)
        found = joint_durations(stairs, start, alpha)
        total = int(start.sum())
        ways = [w for w in itertools.product(range(1, total), repeat=3) if sum(w) == total]
        best = max(joint_score(stairs, np.array(w), alpha) for w in ways)
        score = joint_score(stairs, found, alpha)
        assert found.sum() == total and joint_score(stairs, start, alpha) <= score <= best + 1e-9
        met += score >= best - 1e-9
    assert met >= 10


def test_a_large_alpha_is_the_papers_answer(models):
    usual, heavy = synthesize(models, STRING), synthesize(models, STRING, alpha=1e9)
    assert np.array_equal(usual.trajectory, heavy.trajectory) and heavy.alpha == 1e9
    light = synthesize(models, STRING, alpha=0.01)
    assert len(light) == len(usual)
    scores = [log_likelihood(s.trajectory, s.mean, s.variance) for s in (usual, light)]
    assert scores[1] > scores[0]
    with pytest.raises(InputError, match="alpha is 0"):
        synthesize(models, STRING, alpha=0.0)


@pytest.mark.parametrize(("half", "static"), [((1, 1), 1.0), ((2, 2), 300.0)])
def test_the_trajectory_of_a_variance_is_the_maximum(half, static):
    """Against scipy's climb from several starts, feature by feature."""
    rng = np.random.default_rng(3)
    frames = np.array([3, 4, 2, 5, 4])
    mean, variance = gaussians(rng, 5, 2)
    variance[:, :2] *= static
    step, (delta, square) = steps_of(5, frames), windows(half)
    usual = mlpg(mean, variance, frames=frames, half=half)
    for factor in (0.5, 3.0):
        spread = Spread(factor * usual.var(axis=0), (0.2 * usual.var(axis=0)) ** 2)
        found = with_spread(mean, variance, step, spread, half)

        def fall(c, m, spread=spread):
            both = usual.copy()
            both[:, m] = c
            fit = solver.log_density(both, mean, variance, step, delta, square)[m]
            return -fit / (3 * len(c)) + (c.var() - spread.mean[m]) ** 2 / (2 * spread.variance[m])

        for m in range(2):
            starts = [2 * usual[:, m], rng.normal(size=len(step))]
            best = min(scipy.optimize.minimize(fall, s, args=(m,), tol=1e-12).fun for s in starts)
            assert fall(found[:, m], m) <= best + 1e-6 * abs(best)
        # as far as the likelihood lets it, the variance moves to what is wanted
        assert (
            np.abs(found.var(axis=0) - spread.mean) <= np.abs(usual.var(axis=0) - spread.mean) + 1e-9
        ).all()


def test_global_variance_says_what_it_costs(models, tmp_path):
    usual, wide = synthesize(models, STRING), synthesize(models, STRING, global_variance=True)
    frames = np.diff(usual.boundaries)
    spread = expected_spread([models[s] for s in usual.labels], frames)
    short = np.abs(usual.trajectory.var(axis=0) / spread.mean - 1)
    assert (np.abs(wide.trajectory.var(axis=0) / spread.mean - 1) < np.maximum(0.5 * short, 0.01)).all()
    scores = [log_likelihood(s.trajectory, s.mean, s.variance) / len(s) for s in (usual, wide)]
    assert wide.lost == pytest.approx(scores[0] - scores[1]) and wide.lost > 0 and usual.lost is None
    wide.save(tmp_path / "a.h5")
    assert Synthesis.open(tmp_path / "a.h5").lost == wide.lost


def test_where_global_variance_is_left_out(models):
    usual, short = synthesize(models, "up hold"), synthesize(models, "up hold", global_variance=True)
    assert np.array_equal(usual.trajectory, short.trajectory) and short.lost is None
    assert short.why_not == "the string has 2 labels, expected 3 or more"
    one = {**models, "hold": replace(models["hold"], intervals=1)}
    assert "'hold' has 1 interval" in synthesize(one, STRING, global_variance=True).why_not
    full = {s: train(x, label=s, covariance="full") for s, x in by_label(takes()).items()}
    made = synthesize(full, STRING, global_variance=True)
    assert "is full" in made.why_not and made.lost is None
    with pytest.raises(InputError, match="diagonal covariances only"):
        synthesize(full, STRING, alpha=1.0)


def test_expected_variance_is_that_of_drawn_splices(models):
    """The moments of intervals say what putting the intervals end to end would."""
    raw, labels = by_label(takes(), None), STRING.split()
    frames = np.array([np.mean([len(x) for x in raw[s]]) for s in labels])
    found = expected_spread([models[s] for s in labels], frames)
    rng, seen = np.random.default_rng(1), []
    for _ in range(300):
        pieces = [raw[s][rng.integers(len(raw[s]))] for s in labels]
        seen.append(np.concatenate(pieces).var(axis=0))
    assert np.allclose(found.mean, np.mean(seen, axis=0), rtol=0.05)


def test_words_say_how_long_they_last(models):
    usual = np.diff(synthesize(models, "up hold down").boundaries)
    made = synthesize(models, "up hold=1.5s down*2")
    lasting = np.diff(made.boundaries)
    assert lasting[0] == usual[0] and lasting[1] == 45 and abs(lasting[2] - 2 * usual[2]) <= 3
    assert made.labels == ("up", "hold", "down") and made.string == "up hold=1.5s down*2"
    whole = synthesize(models, "up hold=1.5s down", length=90)
    assert len(whole) == 90 and np.diff(whole.boundaries)[1] == 45
    with pytest.raises(
        InputError, match=r"label 2, 'hold=0.05s': 2 frames at 30 per second, expected 3 or more"
    ):
        synthesize(models, "up hold=0.05s")
    with pytest.raises(InputError, match="the frame rate is not known"):
        synthesize({"up": replace(models["up"], fps=None)}, "up=2s")


def test_left_out_intervals_are_scored_by_models_without_them():
    data = by_label(takes())
    data["short"] = [np.zeros((2, 6)), np.zeros((9, 6))]  # one interval alone is long enough
    reference = np.concatenate(data["up"]).var(axis=0)
    reference[5] = 0.0  # a dead feature, which does not count
    found = leave_one_out(data, reference, states=[1, 3], covariances=["diagonal"], iterations=3)
    assert [(r.label, r.states) for r in found] == [(s, n) for s in ("down", "hold", "up") for n in (1, 3)]
    x = [s[:, :5] for s in data["up"]]
    total = 0.0
    for k, s in enumerate(x):
        model = train(x[:k] + x[k + 1 :], states=3, reference=reference[:5], iterations=3)
        density = naive.log_densities(s, model.mean, model.variance)
        total += naive.expectation([density], *model.logs, True)[3]
        assert np.isclose(log_likelihood_of(model, [s]), naive.expectation([density], *model.logs, True)[3])
    assert np.isclose(found[-1].log_likelihood, total) and found[-1].frames == sum(map(len, x))


def test_too_few_intervals_are_named():
    with pytest.raises(
        InputError, match="label 'up': 2 of 3 intervals are long enough for 3 states, expected 3"
    ):
        train([np.zeros((5, 1)), np.zeros((4, 1)), np.zeros((2, 1))], label="up", least_intervals=3)
