"""Plots: the same bytes for the same numbers, other bytes for others, bad input named."""

from __future__ import annotations

import matplotlib
import numpy as np
import pytest
from PIL import Image

from miburi.errors import InputError
from miburi.render import plots

LABELS = ["r", "rs", "s"]
EDGES = [0, 10, 22, 30]
X = np.r_[np.full(10, 60.0), np.linspace(60, 5, 12), np.full(8, 5.0)]


def draw(kind, path, x=X):
    if kind == "curve":
        plots.curve(path, x, EDGES, LABELS, 30, ylabel="middle finger, third joint (degrees)")
    elif kind == "spliced":
        plots.spliced(
            path, x, EDGES, LABELS, 30, generated=np.linspace(60, 5, 36), generated_boundaries=[0, 12, 20, 36]
        )
    elif kind == "staircase":
        plots.staircase(path, x, np.repeat([60, 30, 5], [10, 12, 8]), np.full(30, 9.0), EDGES, LABELS, 30)
    elif kind == "by_states":
        plots.by_states(
            path, {"diagonal": {1: x[0], 2: 3.0, 3: 4.0}, "full": {1: -9.0}}, ylabel="log-likelihood"
        )
    else:
        bars = [plots.Bar("DSPM(PCA)", x[0], 8, 80, 7.4), plots.Bar("MSM", 30), plots.Bar("mean pose", 47)]
        plots.measures(path, bars, xlabel="mean rank of the target (simulated queries)", chance=135)


@pytest.mark.parametrize("kind", ["curve", "spliced", "staircase", "by_states", "measures"])
@pytest.mark.parametrize("suffix", ["png", "svg"])
def test_the_same_bytes_for_the_same_numbers(tmp_path, kind, suffix):
    a, b, c = (tmp_path / f"{n}.{suffix}" for n in "abc")
    draw(kind, a)
    with matplotlib.rc_context({"font.size": 20, "axes.facecolor": "black"}):  # a user's own style
        draw(kind, b)
    draw(kind, c, X + np.r_[7.0, np.zeros(29)])
    assert a.read_bytes() == b.read_bytes() != c.read_bytes()
    if suffix == "svg":
        assert b"<dc:date>" not in a.read_bytes()
    else:
        picture = np.asarray(Image.open(a).convert("L"))
        assert picture.shape[1] > 1000 and (picture[0] == 255).all() and 0.005 < (picture < 128).mean() < 0.2


def test_pieces_are_not_joined(tmp_path):
    """Between two pieces of different height no line is drawn."""
    for name, edges, labels in (("two", [0, 15, 30], ["r", "s"]), ("one", [0, 30], ["r"])):
        plots.spliced(tmp_path / f"{name}.svg", np.repeat([0.0, 50.0], 15), edges, labels, 30)
    paths = {n: (tmp_path / f"{n}.svg").read_text().count("stroke: #b5401a") for n in ("one", "two")}
    assert paths["two"] == paths["one"] + 1


@pytest.mark.parametrize(
    ("x", "edges", "labels", "message"),
    [
        (X, [0, 10, 30], LABELS, "expected 4 that rise from 0 to 30"),
        (X, [0, 10, 10, 30], LABELS, "rise from 0 to 30"),
        (X, [0, 10, 22, 31], LABELS, "rise from 0 to 30"),
        (np.full(30, np.nan), EDGES, LABELS, "finite numbers"),
        (np.zeros((30, 2)), EDGES, LABELS, r"shape \(30, 2\)"),
    ],
)
def test_curves_that_do_not_fit(tmp_path, x, edges, labels, message):
    with pytest.raises(InputError, match=message):
        plots.curve(tmp_path / "a.png", x, edges, labels, 30)
    assert not list(tmp_path.iterdir())


def test_endings_and_empty_plots(tmp_path):
    with pytest.raises(InputError, match=r"plots are \.png, \.svg or \.pdf"):
        draw("curve", tmp_path / "a.gif")
    with pytest.raises(InputError, match="no measure"):
        plots.measures(tmp_path / "a.png", [], xlabel="rank")
    with pytest.raises(InputError, match="no model"):
        plots.by_states(tmp_path / "a.png", {"full": {}}, ylabel="log-likelihood")
    with pytest.raises(InputError, match="30 frames"):
        plots.staircase(tmp_path / "a.png", X, np.zeros(3), np.zeros(3), EDGES, LABELS, 30)
