"""EM against enumeration of all paths, against hmmlearn, and at its edges."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from threadpoolctl import threadpool_limits

from miburi import InputError, store
from miburi.hmm import Model, by_label, deltas, global_variance, kernels, train, train_labels
from miburi.hmm.densities import log_densities, reestimate

from . import naive


def joined(parts):
    return np.concatenate(parts), np.cumsum([0, *(len(p) for p in parts)])


def drawn(rng, states, exits):
    """Log densities of sequences and log transitions, at random."""
    shortest = states if exits else 1
    densities = [
        rng.normal(scale=3.0, size=(n, states))
        for n in rng.integers(shortest, max(6, states) + 1, rng.integers(1, 4))
    ]
    stay = rng.uniform(0.05, 0.95, states)
    leave = 1 - stay
    if not exits:
        stay[-1], leave[-1] = 1.0, 0.0
    with np.errstate(divide="ignore"):
        return densities, np.log(stay), np.log(leave)


def movements(rng, count, shortest=6, longest=14, dims=4):
    """Smooth changes from one pose to another, with deltas."""
    found = []
    for _ in range(count):
        n = int(rng.integers(shortest, longest + 1))
        ramp = np.tanh(np.linspace(-2, 2, n) + rng.normal(0, 0.3))[:, None]
        found.append(deltas(20 * ramp * np.arange(1, dims + 1) + rng.normal(0, 1, (n, dims))))
    return found


def same_ends(first, second):
    """A falling likelihood is rounding or a bug."""
    return second >= first - 1e-9 * abs(first)


@given(st.integers(0, 10**6), st.integers(1, 4), st.booleans())
def test_expectation_is_the_sum_over_all_paths(seed, states, exits):
    densities, stay, leave = drawn(np.random.default_rng(seed), states, exits)
    x, offsets = joined(densities)
    found = kernels.expectation(x, offsets, stay, leave, exits)
    for a, b in zip(found, naive.expectation(densities, stay, leave, exits), strict=True):
        assert np.allclose(a, b, rtol=1e-10, atol=1e-12)


@given(st.integers(0, 10**6), st.integers(1, 3), st.integers(1, 4), st.booleans())
def test_log_densities_are_scipys(seed, states, dims, full):
    rng = np.random.default_rng(seed)
    x, mean = rng.normal(size=(5, dims)), rng.normal(size=(states, dims))
    variance = rng.uniform(0.1, 2.0, (states, dims))
    if full:
        a = rng.normal(size=(states, dims, dims))
        variance = a @ a.transpose(0, 2, 1) + 0.1 * np.eye(dims)
    assert np.allclose(log_densities(x, mean, variance), naive.log_densities(x, mean, variance), rtol=1e-10)


@given(st.integers(0, 10**6), st.booleans())
def test_reestimation_is_the_weighted_moments(seed, full):
    rng = np.random.default_rng(seed)
    x, gamma = rng.normal(5.0, 1.0, size=(12, 3)), rng.dirichlet(np.ones(2), 12)
    gamma[:, 1] *= rng.integers(0, 2)  # a state that is never reached keeps its Gaussian
    old = rng.normal(size=(2, 3))
    before = np.tile(np.eye(3), (2, 1, 1)) if full else np.ones((2, 3))
    mean, variance = reestimate(x, gamma, old, before, np.full(3, 1e-9))
    for i in range(2):
        if gamma[:, i].sum() == 0:
            assert np.array_equal(mean[i], old[i]) and np.array_equal(variance[i], before[i])
            continue
        assert np.allclose(mean[i], np.average(x, axis=0, weights=gamma[:, i]))
        covariance = np.cov(x.T, aweights=gamma[:, i], ddof=0)
        assert np.allclose(variance[i], covariance if full else np.diag(covariance), atol=1e-12)


def test_a_floored_covariance_is_the_likeliest_above_the_floor():
    """Among covariances no smaller than the floor, no neighbour is likelier."""
    rng = np.random.default_rng(3)
    x = rng.normal(size=(30, 3)) @ np.diag([2.0, 0.3, 0.05]) @ rng.normal(size=(3, 3))
    floors = np.array([0.4, 0.2, 0.3])
    start = np.zeros((1, 3)), np.ones((1, 3, 3))
    _, (found,) = reestimate(x, np.ones((30, 1)), *start, floors)
    assert abs(np.linalg.eigvalsh(found - np.diag(floors)).min()) < 1e-12  # it touches the floor
    sample = np.cov(x.T, ddof=0)
    assert np.linalg.eigvalsh(sample - np.diag(floors)).min() < 0  # the floor is at work

    def likelihood(covariance):
        return -np.linalg.slogdet(covariance)[1] - np.trace(np.linalg.solve(covariance, sample))

    for _ in range(300):
        a = rng.normal(size=(3, 3))
        other = np.diag(floors) + a @ a.T
        for step in (1.0, 0.1, 0.001):
            assert likelihood(found + step * (other - found)) <= likelihood(found) + 1e-9


@pytest.mark.parametrize("covariance", ["diagonal", "full"])
@pytest.mark.parametrize("exits", [True, False])
@pytest.mark.parametrize("floor", [0.0, 0.01, 0.5])
def test_the_likelihood_never_falls(covariance, exits, floor):
    x = movements(np.random.default_rng(1), 8)
    model = train(x, covariance=covariance, exit=exits, floor=floor, states=4, iterations=30, tolerance=-1)
    trace = model.log_likelihood
    assert len(trace) == 31 and not model.converged
    assert all(same_ends(a, b) for a, b in itertools.pairwise(trace))
    assert trace[-1] > trace[0]
    assert np.allclose(model.transitions.sum(axis=1) + np.eye(4)[3] * model.exit, 1.0)
    assert (model.exit > 0) == exits


def test_em_stops_when_it_has_converged():
    x = movements(np.random.default_rng(2), 8)
    model = train(x, iterations=200, tolerance=1e-3)
    assert model.converged and len(model.log_likelihood) < 100
    gains = np.diff(model.log_likelihood) / model.frames
    assert gains[-1] < 1e-3 and (gains[:-1] >= 1e-3).all()


@pytest.mark.parametrize("covariance", ["diagonal", "full"])
@pytest.mark.parametrize("exits", [True, False])
def test_the_last_likelihood_is_that_of_the_model(covariance, exits):
    """By the twin, from what the model's file will hold."""
    x = [s[:, :2] for s in movements(np.random.default_rng(4), 3, longest=8, dims=2)]
    model = train(x, covariance=covariance, exit=exits, iterations=3, tolerance=-1)
    variance = model.variance if model.covariance is None else model.covariance
    densities = [naive.log_densities(s, model.mean, variance) for s in x]
    with np.errstate(divide="ignore"):
        stay = np.log(np.diag(model.transitions))
        leave = np.log([*np.diag(model.transitions, 1), model.exit])
    assert np.isclose(model.log_likelihood[-1], naive.expectation(densities, stay, leave, exits)[3])
    assert np.array_equal(model.logs, [stay, leave])


def test_the_start_is_the_uniform_segmentation():
    x = [np.arange(6.0)[:, None], np.arange(4.0)[:, None]]
    model = train(x, states=2, iterations=0, floor=0.0)
    assert np.allclose(model.mean.ravel(), [np.mean([0, 1, 2, 0, 1]), np.mean([3, 4, 5, 2, 3])])
    assert np.allclose(model.variance.ravel(), [np.var([0, 1, 2, 0, 1]), np.var([3, 4, 5, 2, 3])])
    assert np.allclose(model.transitions, [[3 / 5, 2 / 5], [0, 3 / 5]]) and np.isclose(model.exit, 2 / 5)
    assert len(model.log_likelihood) == 1 and not model.converged


@pytest.mark.parametrize("covariance", ["diagonal", "full"])
@pytest.mark.parametrize("exits", [True, False])
def test_training_equals_hmmlearns(covariance, exits):
    """The same start and 12 iterations: log-likelihoods and parameters agree to 1e-8."""
    hmm = pytest.importorskip("hmmlearn.hmm")
    rng = np.random.default_rng(7)
    x = [s[:, :4] for s in movements(rng, 9, dims=4)]
    iterations = 12
    settings = {"covariance": covariance, "exit": exits, "floor": 0.0, "tolerance": -1.0}
    start = train(x, iterations=0, **settings)
    ours = train(x, iterations=iterations, **settings)
    n, d = start.mean.shape
    kind = {"diagonal": "diag", "full": "full"}[covariance]
    variance = start.variance if start.covariance is None else start.covariance
    common = {
        "covariance_type": kind, "n_iter": iterations, "tol": -np.inf, "init_params": "",
        "implementation": "log", "covars_prior": 0, "covars_weight": 0, "min_covar": 0,
    }  # fmt: skip

    class Exit(hmm.GaussianHMM):
        """One state more, which only the row appended to each sequence can be in."""

        def _compute_log_likelihood(self, rows):
            out = super()._compute_log_likelihood(rows)
            end = rows[:, 0] > 1e3
            out[end, :-1], out[~end, -1], out[end, -1] = -np.inf, -np.inf, 0.0
            return out

    if exits:
        peer = Exit(n + 1, **common)
        row = rng.normal(1e4, 1.0, (len(x), 1, d))  # scattered, so that the end's own Gaussian is one
        rows = [np.concatenate([s, e]) for s, e in zip(x, row, strict=True)]
        peer.means_ = np.vstack([start.mean, np.full(d, 1e4)])
        peer.covars_ = np.concatenate([variance, (np.ones((1, d)) if kind == "diag" else np.eye(d)[None])])
        peer.transmat_ = np.zeros((n + 1, n + 1))
        peer.transmat_[:n, :n] = start.transitions
        peer.transmat_[n - 1, n], peer.transmat_[n, n] = start.exit, 1.0
    else:
        peer, rows = hmm.GaussianHMM(n, **common), x
        peer.means_, peer.covars_, peer.transmat_ = start.mean, variance, start.transitions
    peer.startprob_ = np.eye(len(peer.means_))[0]
    peer.fit(np.concatenate(rows), [len(r) for r in rows])
    assert np.allclose(list(peer.monitor_.history), ours.log_likelihood[:-1], rtol=1e-8, atol=0)
    assert np.allclose(peer.means_[:n], ours.mean, rtol=1e-8)
    found = ours.variance if ours.covariance is None else ours.covariance
    theirs = peer._covars_[:n]
    assert np.allclose(theirs, found, rtol=1e-8, atol=1e-8)
    assert np.allclose(peer.transmat_[:n, :n], ours.transitions, rtol=1e-8, atol=1e-12)


@given(
    st.lists(st.integers(1, 9), min_size=1, max_size=5),
    st.integers(1, 4),
    st.integers(1, 3),
    st.booleans(),
    st.sampled_from(["diagonal", "full"]),
    st.integers(0, 99),
)
def test_any_shape_is_trained_or_refused(sizes, states, dims, exits, covariance, seed):
    rng = np.random.default_rng(seed)
    x = [np.round(rng.normal(size=(n, dims)), seed % 3) for n in sizes]
    if max(sizes) < states:
        with pytest.raises(InputError, match=f"longest of {len(sizes)} intervals has {max(sizes)} frames"):
            train(x, states=states, exit=exits, covariance=covariance)
        return
    model = train(x, states=states, exit=exits, covariance=covariance, iterations=5)
    long = [n for n in sizes if n >= states] if exits else sizes
    assert (model.intervals, model.frames, model.left_out) == (len(long), sum(long), len(sizes) - len(long))
    for values in (model.mean, model.variance, model.duration_mean, model.log_likelihood):
        assert np.isfinite(values).all()
    assert (model.variance > 0).all() and (model.duration_variance >= 0).all()
    assert all(same_ends(a, b) for a, b in zip(model.log_likelihood, model.log_likelihood[1:], strict=False))


def test_a_dead_sensor_is_counted_and_harmless():
    rng = np.random.default_rng(5)
    x = movements(rng, 6, dims=3)
    dead = [s.copy() for s in x]
    for s in dead:
        s[:, 1], s[:, 4], s[:, 7] = 127.1, 0.0, 0.0
    model = train(dead)
    assert model.constant == 3
    assert np.allclose(model.mean[:, 1], 127.1, rtol=1e-12) and (model.variance[:, 1] == 1e-12).all()
    alive = [0, 2, 3, 5, 6, 8]
    without = train([s[:, alive] for s in x])
    assert np.allclose(model.mean[:, alive], without.mean) and without.constant == 0


def test_floor_is_a_share_of_the_reference():
    x = movements(np.random.default_rng(6), 6)
    model = train(x, floor=0.5, reference=np.full(x[0].shape[1], 30.0))
    assert model.variance.min() == 15.0
    own = train(x, floor=0.5)
    assert np.allclose(own.variance.min(axis=0), np.maximum(0.5 * np.concatenate(x).var(axis=0), 0), rtol=0.9)
    assert (own.variance >= 0.5 * np.concatenate(x).var(axis=0) * (1 - 1e-12)).all()


@pytest.mark.parametrize("exits", [True, False])
def test_ten_thousand_frames(exits):
    """Long sequences of many dimensions, whose densities no number could hold without logarithms."""
    rng = np.random.default_rng(0)
    x = np.concatenate([rng.normal(k, 1.0, (n, 60)) for k, n in enumerate((2000, 5000, 3000))])
    model = train([x], exit=exits, iterations=30, tolerance=1e-9)
    assert model.converged and np.isfinite(model.log_likelihood).all()
    assert np.allclose(model.duration_mean, [2000, 5000, 3000], rtol=1e-9)
    assert np.allclose(model.mean, [[0.0], [1.0], [2.0]], atol=0.1)
    assert np.allclose(model.variance, 1.0, atol=0.15)


def test_labels_of_takes_are_trained_on_all_their_intervals():
    rng = np.random.default_rng(5)
    takes = [(rng.normal(size=(60, 2)), [(0, 20, "a"), (20, 45, "b"), (45, 60, "a")]) for _ in range(3)]
    found = train_labels(takes, iter(["b", "a", "b"]), states=2, fps=50.0)
    assert list(found) == ["b", "a"]
    reference = global_variance([x for x, _ in takes])
    alone = train(by_label(takes)["a"], states=2, label="a", fps=50.0, reference=reference)
    np.testing.assert_array_equal(found["a"].mean, alone.mean)
    np.testing.assert_array_equal(found["a"].variance, alone.variance)
    with pytest.raises(InputError, match="no interval has the label 'c'; there are a, b"):
        train_labels(takes, ["c"])


def test_one_frame():
    model = train([[[3.0, 4.0]]], states=1)
    assert model.mean.tolist() == [[3.0, 4.0]] and model.duration_mean.tolist() == [1.0]
    assert model.transitions.tolist() == [[0.0]] and model.exit == 1.0
    assert np.isfinite(model.log_likelihood).all()


@pytest.mark.parametrize(
    ("x", "settings", "said"),
    [
        ([], {}, "label 'rp': there are no intervals"),
        (np.zeros((5, 2)), {}, "found one array"),
        ([np.zeros((2, 1))], {}, "label 'rp': the longest of 1 intervals has 2 frames, expected 3 or more"),
        ([np.zeros((4, 2)), np.zeros((4, 3))], {}, "label 'rp', interval 1: found 3 features"),
        ([np.zeros((4, 1)), [[0.0], [np.nan]]], {}, "interval 1, frame 1, column 0: found nan"),
        ([np.zeros((4, 1))], {"states": 0}, "states is 0"),
        ([np.zeros((4, 1))], {"iterations": -1}, "iterations is -1"),
        ([np.zeros((4, 1))], {"floor": -0.1}, "floor is -0.1"),
        ([np.zeros((4, 1))], {"tolerance": np.nan}, "tolerance is nan"),
        ([np.zeros((4, 1))], {"covariance": "tied"}, "covariance is 'tied', expected diagonal or full"),
        ([np.zeros((4, 1))], {"durations": "eq9"}, "durations are 'eq9', expected exact or product"),
        ([np.zeros((4, 1))], {"reference": [1.0, 2.0]}, r"reference variances of shape \(2,\)"),
        ([np.zeros((4, 1))], {"half": (1, 0)}, "half lengths"),
    ],
)
def test_what_training_refuses(x, settings, said):
    with pytest.raises(InputError, match=said):
        train(x, label="rp", **settings)


@pytest.mark.parametrize("covariance", ["diagonal", "full"])
def test_a_model_survives_its_file(tmp_path, covariance):
    x = movements(np.random.default_rng(8), 5)
    model = train(x, label="rp", covariance=covariance, fps=30.0, durations="product")
    model.save(tmp_path / "rp.h5", {"motion": "00"})
    found = Model.open(tmp_path / "rp.h5")
    for name, value in vars(model).items():
        assert np.array_equal(getattr(found, name), value), name
    assert found.logs[0].tolist() == model.logs[0].tolist()


def test_two_runs_write_the_same_bytes(tmp_path):
    x = movements(np.random.default_rng(9), 5)
    for name in ("a", "b"):
        train([s.copy() for s in x], label="rp").save(tmp_path / f"{name}.h5")
    assert store.digest(tmp_path / "a.h5") == store.digest(tmp_path / "b.h5")


def test_threads_change_nothing():
    x = movements(np.random.default_rng(0), 20, 15, 25, dims=48)
    found = []
    for threads in (1, 2):
        with threadpool_limits(threads, "blas"):
            model = train(x, covariance="full", iterations=4)
        found.append(model.covariance.tobytes() + model.mean.tobytes() + model.log_likelihood.tobytes())
    assert found[0] == found[1]


def test_a_damaged_model_is_named(tmp_path):
    import h5py

    path = tmp_path / "rp.h5"
    train(movements(np.random.default_rng(9), 3), label="rp").save(path)
    with h5py.File(path, "r+") as file:
        file.attrs["form"] = "guess"
    with pytest.raises(InputError, match=r"rp.h5: the attribute 'form' is 'guess'"):
        Model.open(path)
    with h5py.File(path, "r+") as file:
        del file["duration_mean"]
        file.attrs["form"] = "exact"
    with pytest.raises(InputError, match=r"duration_mean is missing"):
        Model.open(path)
