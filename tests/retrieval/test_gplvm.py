"""Latent variable models: likelihood, gradients, projection, and the measures made of them."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import check_grad, minimize

from miburi.errors import InputError
from miburi.retrieval import Index, gplvm
from miburi.retrieval.latent import Settings

from . import naive
from .test_index import cut, takes


def smooth(n=20, width=8, seed=0, noise=0.01):
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, n)[:, None]
    waves = np.hstack([np.sin(t), np.cos(t), np.sin(2 * t)])
    return waves @ rng.normal(size=(3, width)) + rng.normal(0, noise, (n, width)) + rng.normal(size=width)


def parameters(n, q, seed):
    rng = np.random.default_rng(seed)
    return np.concatenate([rng.normal(size=n * q), np.log(rng.uniform([0.1, 0.01], [2.0, 0.3]))])


@given(st.integers(1, 8), st.integers(1, 3), st.integers(1, 6), st.integers(0, 999))
def test_likelihood_is_the_density_of_the_frames(n, q, width, seed):
    z = parameters(n, q, seed)
    y = np.random.default_rng(seed).normal(size=(n, width))
    want = naive.gplvm_log_likelihood(z[:-2].reshape(n, q), *np.exp(z[-2:]), y)
    assert -gplvm.negative_log_likelihood(z, y @ y.T, width)[0] == pytest.approx(want, rel=1e-9, abs=1e-9)


@given(st.integers(1, 8), st.integers(1, 3), st.integers(0, 999))
def test_gradient_by_finite_differences(n, q, seed):
    z = parameters(n, q, seed)
    y = np.random.default_rng(seed).normal(size=(n, 5))
    products = y @ y.T

    def value(v):
        return gplvm.negative_log_likelihood(v, products, 5)[0]

    def gradient(v):
        return gplvm.negative_log_likelihood(v, products, 5)[1]

    assert check_grad(value, gradient, z) < 1e-4 * (1 + np.abs(gradient(z)).max())


class TestAgainstGPy:
    golden = json.loads((Path(__file__).parent / "golden_gplvm.json").read_text())

    @property
    def start(self):
        return np.concatenate(
            [np.ravel(self.golden["latent"]), np.log([self.golden["signal"], self.golden["noise"]])]
        )

    def test_likelihood_and_gradient(self):
        g, y = self.golden, np.array(self.golden["frames"])
        value, gradient = gplvm.negative_log_likelihood(self.start, y @ y.T, y.shape[1])
        assert -value == pytest.approx(g["log_likelihood"], rel=1e-6)
        np.testing.assert_allclose(-gradient[:-2], np.ravel(g["gradient_latent"]), rtol=1e-4, atol=1e-4)
        # ours are of logarithms
        assert -gradient[-2] == pytest.approx(g["gradient_signal"] * g["signal"], rel=1e-5)
        assert -gradient[-1] == pytest.approx(g["gradient_noise"] * g["noise"], rel=1e-5)

    def test_prediction(self):
        g = self.golden
        known = gplvm.model(g["frames"], np.array(g["latent"]), np.array([g["signal"], g["noise"]]))
        mean, variance = gplvm.predict(known, g["points"])
        np.testing.assert_allclose(mean, g["predicted"], atol=1e-6)
        np.testing.assert_allclose(variance, g["variance"], rtol=1e-5)

    def test_optimum(self):
        g, y = self.golden, np.array(self.golden["frames"])
        found = minimize(
            gplvm.negative_log_likelihood,
            self.start,
            (y @ y.T, y.shape[1]),
            jac=True,
            method="L-BFGS-B",
            options={"maxiter": 5000},
        )
        assert -found.fun == pytest.approx(g["optimum_log_likelihood"], abs=0.01)
        np.testing.assert_allclose(np.exp(found.x[-2:]), [g["optimum_signal"], g["optimum_noise"]], rtol=0.02)

    def test_projection(self):
        g = self.golden
        known = gplvm.model(
            g["frames"], np.array(g["optimum_latent"]), np.array([g["optimum_signal"], g["optimum_noise"]])
        )
        for case in g["projected"]:
            latent, error = gplvm.project(known, [case["frame"]], starts=3, iterations=50)
            np.testing.assert_allclose(latent[0], case["latent"], atol=0.02)
            assert error[0] == pytest.approx(case["error"], rel=0.02)


def test_training_raises_the_likelihood_and_is_deterministic():
    y = smooth()
    centred = y - y.mean(axis=0)

    def value(known):
        z = np.concatenate([known.latent.ravel(), np.log(known.scale)])
        return gplvm.negative_log_likelihood(z, centred @ centred.T, y.shape[1])[0]

    by_iterations = [value(gplvm.fit(y, 2, n)) for n in (0, 5, 50, 200)]
    assert (np.diff(by_iterations) < 0).all()
    np.testing.assert_array_equal(gplvm.fit(y).latent, gplvm.fit(y.copy()).latent)


@pytest.mark.parametrize(
    ("seed", "q", "away"), [(0, 2, 0.0), (1, 2, 0.3), (2, 2, 2.0), (3, 1, 0.3), (4, 3, 0.3)]
)
def test_projection_is_as_likely_as_a_search_from_everywhere(seed, q, away):
    """BFGS from a few starts against simplices from every latent point, on the density written out."""
    y = smooth(8, 5, seed, noise=0.1)
    known = gplvm.fit(y, q, 40)
    frame = y[3] + away * np.random.default_rng(seed).normal(size=5)
    latent, error = gplvm.project(known, frame[None], starts=4, iterations=50)
    rest = (frame, known.latent, *known.scale, known.mean, y)
    value, distance = naive.gplvm_surprise(latent[0], *rest)
    assert error[0] == pytest.approx(distance, rel=1e-6, abs=1e-9)
    best = min(
        minimize(lambda p: naive.gplvm_surprise(p, *rest)[0], x, method="Nelder-Mead").fun
        for x in known.latent[::3]
    )
    assert value < best + 0.05


@settings(max_examples=25)
@given(st.integers(1, 12), st.integers(1, 3), st.integers(0, 2))
def test_any_frames_have_a_model(n, q, kind):
    y = np.random.default_rng(n).normal(size=(n, 6))
    if kind == 1:
        y[:] = y[0]
    if kind == 2:
        y = np.repeat(y[: (n + 1) // 2], 2, axis=0)[:n]
    known = gplvm.fit(y, q, 10)
    assert known.latent.shape == (n, q)
    latent, error = gplvm.project(known, np.vstack([y, y[:1] + 1.0]))
    assert np.isfinite(latent).all() and np.isfinite(error).all()
    if kind == 1 or n == 1:
        # nothing varies: what is lost is the distance from the only pose there is
        np.testing.assert_allclose(
            error, np.linalg.norm(np.vstack([y, y[:1] + 1.0]) - y[0], axis=1), atol=1e-6
        )


@pytest.fixture(scope="module")
def few():
    features = takes(3, 2, 120)
    segments = [*cut(features, 30, 40), ("take0", 0, 5, 8), ("take1", 1, 7, 8)]
    return features, segments


@pytest.mark.parametrize("samples", [None, 20])
def test_measures_are_equations_1_and_2_with_models(few, samples):
    features, segments = few
    wanted = Settings(dims=2, frames=12, iterations=30, starts=3)
    index = Index.build(features, segments, samples=samples).trained(wanted)
    query = takes(9, 1, 40)[0]
    drawn = index._drawn(query.astype(np.float64))
    sm, dspm = index.distances(query, "SM(GP-LVM)"), index.distances(query, "DSPM(GP-LVM)")
    mean = index.distances(query, "SM(GP-LVM)", reduction="mean")

    def spaced(x):
        m = min(12, len(x))
        return x[[i * len(x) // m for i in range(m)]]

    q = gplvm.fit(spaced(drawn), 2, 30)
    for s in range(len(index)):
        frames = index.frames[index.offsets[s] : index.offsets[s + 1]].astype(np.float64)
        h = gplvm.fit(spaced(frames), 2, 30)
        there = [gplvm.project(h, x[None], 3)[1][0] for x in spaced(drawn)]
        back = [gplvm.project(q, x[None], 3)[1][0] for x in spaced(frames)]
        assert sm[s] == pytest.approx(max(there), abs=1e-3)
        assert mean[s] == pytest.approx(np.mean(there), abs=1e-3)
        assert dspm[s] == pytest.approx(max(*there, *back), abs=1e-3)


def test_models_come_back(few, tmp_path):
    features, segments = few
    index = Index.build(features, segments).trained(Settings(frames=10, iterations=20))
    index.save(tmp_path / "index.h5")
    index.models.save(tmp_path / "gplvm.h5", {"index.h5": "0"})
    again = Index.open(tmp_path / "index.h5", tmp_path / "gplvm.h5")
    assert again.models.settings == Settings(frames=10, iterations=20)
    query = takes(9, 1, 40)[0]
    for measure in ("SM(GP-LVM)", "DSPM(GP-LVM)"):
        np.testing.assert_array_equal(again.distances(query, measure), index.distances(query, measure))
    other = Index.build(features, segments[:-1])
    other.save(tmp_path / "other.h5")
    with pytest.raises(InputError, match=r"gplvm\.h5.*latent has shape"):
        Index.open(tmp_path / "other.h5", tmp_path / "gplvm.h5")
    with pytest.raises(InputError, match="its format is 'miburi/index', expected 'miburi/gplvm'"):
        Index.open(tmp_path / "index.h5", tmp_path / "index.h5")
    with pytest.raises(InputError, match="starts is 0"):
        Settings(starts=0)
