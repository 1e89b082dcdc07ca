"""From strings of labels to motion: its layout, its file, splices and steps."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError, store
from miburi.figures import HAND
from miburi.hmm import (
    Synthesis,
    by_label,
    check_string,
    largest_step,
    lengths,
    mlpg,
    splice,
    steps,
    synthesize,
    total_length,
    train,
)

FRAMES = {"up": 8, "hold": 5, "down": 10}


def takes(features=2, seed=0):
    """Two recordings that go up, hold and down again, six times."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(2):
        frames, intervals = [], []
        for _ in range(6):
            for label, usual in FRAMES.items():
                n = usual + int(rng.integers(-1, 2))
                path = {"up": np.linspace(0, 40, n), "hold": np.full(n, 40.0), "down": np.linspace(40, 0, n)}
                start = sum(map(len, frames))
                frames.append(
                    path[label][:, None] * np.arange(1, features + 1) + rng.normal(0, 1.0, (n, features))
                )
                intervals.append((start, start + n, label))
        found.append((np.concatenate(frames), intervals))
    return found


@pytest.fixture(scope="module")
def recorded():
    return takes()


@pytest.fixture(scope="module")
def models(recorded):
    return {label: train(x, label=label, fps=30.0) for label, x in by_label(recorded).items()}


def test_the_staircase_and_its_trajectory(models):
    found = synthesize(models, "up hold down up")
    frames = [np.maximum(1, np.floor(models[s].duration_mean + 0.5)).astype(int) for s in found.labels]
    assert found.boundaries.tolist() == [0, *np.cumsum([f.sum() for f in frames])]
    assert len(found) == found.boundaries[-1] == total_length(models, "up hold down up")
    assert found.state.tolist() == [i for f in frames for i, n in enumerate(f) for _ in range(n)]
    assert list(found.label) == [s for s, f in zip(found.labels, frames, strict=True) for _ in range(f.sum())]
    for t in range(len(found)):
        model = models[found.label[t]]
        assert np.array_equal(found.mean[t], model.mean[found.state[t]])
        assert np.array_equal(found.variance[t], model.variance[found.state[t]])
    assert np.array_equal(found.trajectory, mlpg(found.mean, found.variance))
    assert found.trajectory[found.boundaries[1] + 2, 0] == pytest.approx(40, abs=3)  # up there
    assert (found.fps, found.rho, found.string) == (30.0, 0.0, "up hold down up")


def test_a_string_is_a_text_or_a_sequence(models):
    one, other = synthesize(models, " up\thold "), synthesize(models, ["up", "hold"])
    assert np.array_equal(one.trajectory, other.trajectory) and one.string == other.string == "up hold"


@given(st.lists(st.sampled_from(list(FRAMES)), min_size=1, max_size=6), st.integers(0, 200))
def test_any_length_that_fits_is_met(string, more):
    models = {s: train(x, label=s) for s, x in by_label(takes()).items()}
    found = synthesize(models, string, length=3 * len(string) + more)
    assert len(found) == 3 * len(string) + more == len(found.trajectory) == len(found.label)
    assert np.isfinite(found.trajectory).all() and (np.diff(found.boundaries) >= 3).all()
    assert (found.rho > 0) == (len(found) > total_length(models, string))


def test_speed(models):
    usual = total_length(models, "up down")
    assert total_length(models, "up down", rho=2.0) == len(synthesize(models, "up down", rho=2.0)) > usual
    assert len(synthesize(models, "up down", rho=-2.0)) < usual


def test_one_frame_for_each_state_is_enough(models):
    found = synthesize(models, "hold", length=3)
    assert found.state.tolist() == [0, 1, 2] and np.isfinite(found.trajectory).all()


def test_wider_windows_and_full_covariances():
    for settings in ({"half": (2, 3)}, {"covariance": "full"}):
        half = settings.get("half", (1, 1))
        models = {s: train(x, label=s, **settings) for s, x in by_label(takes(), half).items()}
        found = synthesize(models, "up hold down")
        gaussians = found.variance
        if "covariance" in settings:
            chosen = zip(found.label, found.state, strict=True)
            gaussians = np.array([models[label].covariance[state] for label, state in chosen])
        assert np.allclose(found.trajectory, mlpg(found.mean, gaussians, half=half), atol=1e-9)
        assert np.abs(found.trajectory[:, 0]).max() == pytest.approx(40, abs=3)


def test_a_synthesis_survives_its_file(tmp_path, models):
    made = synthesize(models, "up hold down", length=50)
    for name in ("a", "b"):
        made.save(tmp_path / f"{name}.h5", {"models/up.h5": "00"})
    found = Synthesis.open(tmp_path / "a.h5")
    for name, value in vars(made).items():
        assert np.array_equal(getattr(found, name), value), name
    assert store.digest(tmp_path / "a.h5") == store.digest(tmp_path / "b.h5")
    with pytest.raises(InputError, match="its format is 'miburi/synthesis', expected 'miburi/models'"):
        type(models["up"]).open(tmp_path / "a.h5")
    (tmp_path / "a.h5").write_bytes((tmp_path / "a.h5").read_bytes()[:700])
    with pytest.raises(InputError, match="not a readable HDF5 file"):
        Synthesis.open(tmp_path / "a.h5")


def test_the_same_again(recorded):
    found = [
        synthesize({s: train(x) for s, x in by_label(takes()).items()}, "up hold down").trajectory
        for _ in range(2)
    ]
    assert found[0].tobytes() == found[1].tobytes()


def test_a_hand_moves():
    angles = takes(features=48)
    models = {s: train(x, label=s, fps=30.0) for s, x in by_label(angles).items()}
    found = synthesize(models, "up hold")
    motion = found.motion("up-hold")
    assert motion.skeleton is HAND and motion.fps == 30.0 and motion.name == "up-hold"
    assert np.array_equal(motion.angles, found.trajectory) and len(motion) == len(found)
    with pytest.raises(InputError, match="frame rate of a trajectory is not known"):
        replace(found, fps=None).motion()
    with pytest.raises(InputError, match=r"moves no hand, expected \(T, 48\)"):
        replace(found, trajectory=found.trajectory[:, :3]).motion()


@pytest.mark.parametrize(
    ("string", "said"),
    [
        ("", "the string of labels is empty"),
        ("  ", "the string of labels is empty"),
        ("up hodl", r"string 'up hodl': label 2 is 'hodl', known are down, hold, up"),
        (["up", "hold down"], "label 2 is 'hold down'"),
    ],
)
def test_unknown_labels_are_named(models, string, said):
    for work in (lambda: synthesize(models, string), lambda: check_string(string, list(models))):
        with pytest.raises(InputError, match=said):
            work()


def test_a_label_with_a_blank_is_no_label_of_a_string(models):
    with pytest.raises(InputError, match="label 'thumb up' has a blank in it"):
        synthesize({"thumb up": models["up"]}, ["thumb up"])


def test_models_must_fit_together(models):
    with pytest.raises(InputError, match="models 'up' and 'down' differ in half lengths of delta windows"):
        synthesize({**models, "down": replace(models["down"], half=(2, 2))}, "up down")
    with pytest.raises(InputError, match=r"differ in frames per second: 30.0 and 24.0"):
        synthesize({**models, "down": replace(models["down"], fps=24.0)}, "up down")
    narrow = train([np.zeros((4, 1))], label="n", fps=30.0)
    with pytest.raises(InputError, match="differ in features: 6 and 1"):
        synthesize({**models, "n": narrow}, "up n")
    with pytest.raises(InputError, match="model 'n' has 1 features, expected static, Δ and Δ² of each"):
        synthesize({"n": narrow}, "n")


def test_lengths_of_the_four_combinations(recorded):
    data = by_label(recorded)
    found = lengths(data, "up hold down", states=2)
    assert [(e, f) for e, f, _ in found] == [
        (True, "exact"), (True, "product"), (False, "exact"), (False, "product"),
    ]  # fmt: skip
    for exits, form, frames in found:
        models = {s: train(x, states=2, exit=exits, durations=form) for s, x in data.items()}
        assert total_length(models, "up hold down") == frames
    mean = sum(np.mean([len(x) for x in data[s]]) for s in FRAMES)
    assert abs(found[0][2] - mean) <= 6 * 0.5


def test_splices_are_intervals_of_median_length(recorded):
    raw = by_label(recorded, None)
    found = splice(raw, "down up down")
    pieces = np.split(found.trajectory, found.boundaries[1:-1])
    assert np.array_equal(pieces[0], pieces[2]) and found.labels == ("down", "up", "down")
    for label, piece in zip(found.labels, pieces, strict=True):
        sizes = [len(x) for x in raw[label]]
        assert len(piece) == sorted(sizes)[(len(sizes) - 1) // 2]
        assert np.array_equal(piece, raw[label][sizes.index(len(piece))])  # the first of equal ones
    assert len(splice({"a": [np.zeros((n, 1)) for n in (7, 3)]}, "a").trajectory) == 3  # the lower median
    with pytest.raises(InputError, match="label 1 is 'left'"):
        splice(raw, "left")
    with pytest.raises(InputError, match="label 'up': there are no intervals"):
        splice({"up": []}, "up")


def test_steps_are_jumps_not_speed():
    ramp = np.arange(20.0)[:, None] * [9.0, -9.0]
    assert np.allclose(steps(ramp), 0.0)
    ramp[10:, 1] += 5.0
    jump = steps(ramp)
    assert len(jump) == 19 and jump.argmax() == 9 and jump[9] == 5.0
    assert largest_step(ramp) == largest_step(ramp, [0, 10, 20]) == 5.0
    assert largest_step(ramp, [0, 5, 20]) == 0.0
    assert largest_step(ramp, [0, 20]) == 0.0
    assert [largest_step(ramp[9 : 9 + n]) for n in (1, 2)] == [0.0, 0.0]


@given(st.integers(1, 9), st.integers(0, 99))
def test_steps_are_their_definition(frames, seed):
    x = np.random.default_rng(seed).normal(size=(frames, 3))
    v = [x[t + 1] - x[t] for t in range(frames - 1)]
    expected = []
    for t in range(len(v)):
        near = [v[n] for n in (t - 1, t + 1) if 0 <= n < len(v)]
        expected.append(np.abs(v[t] - sum(near) / len(near)).max() if near else 0.0)
    assert np.allclose(steps(x), expected)


def test_splices_step_where_generated_motion_does_not():
    """Recordings that drift: pieces of different times do not meet."""
    drifting = [(x + 25.0 * np.sin(0.05 * np.arange(len(x)))[:, None], i) for x, i in takes()]
    models = {s: train(x, label=s) for s, x in by_label(drifting).items()}
    string = "up hold down up hold down"
    made, cut = synthesize(models, string), splice(by_label(drifting, None), string)
    assert largest_step(cut.trajectory, cut.boundaries) > 3 * largest_step(made.trajectory, made.boundaries)
