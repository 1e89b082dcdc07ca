"""Plots as a journal prints them; the same bytes for the same numbers. No function here reads a file."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import Any, NamedTuple

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from miburi import store
from miburi.errors import InputError
from miburi.motion import Floats

_INK, _GREY, _ACCENT, _PAPER = "#1b1b1f", "#a3a6ab", "#b5401a", "#1f5fa8"
_STYLE: dict[str, Any] = {
    "font.family": "DejaVu Sans",  # comes with matplotlib
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.1,
    "xtick.direction": "out",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "legend.frameon": False,
    "svg.hashsalt": "miburi",
    "svg.fonttype": "path",
}
_STAMPS: dict[str, dict[str, str | None]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}

Path = str | os.PathLike[str]
Whole = Sequence[int] | NDArray[np.integer[Any]]


class Bar(NamedTuple):
    """A measure's result: its value, the interval around it (absent: none), and the paper's figure
    (absent: none)."""

    name: str
    value: float
    low: float | None = None
    high: float | None = None
    paper: float | None = None


def curve(
    path: Path,
    x: ArrayLike,
    boundaries: Whole,
    labels: Sequence[str],
    fps: float,
    *,
    ylabel: str = "angle (degrees)",
    title: str = "",
) -> None:
    """A joint's angle in a generated motion, with its labels ([H], fig. 4).

    Parameters
    ----------
    path
        Of a .png, .svg or .pdf.
    x : (T,)
        Angle of each frame.
    boundaries : (L + 1,)
        First frame of each label, and T.
    labels
        L labels.

    Raises
    ------
    InputError
        Boundaries and labels do not fit x, or the ending is another one.
    """
    values, edges = _checked(path, x, boundaries, labels)
    with _axes(path, title) as axes:
        axes.plot(np.arange(len(values)) / fps, values, color=_INK)
        _labelled(axes, edges, labels, fps, ylabel)


def spliced(
    path: Path,
    pieces: ArrayLike,
    boundaries: Whole,
    labels: Sequence[str],
    fps: float,
    *,
    generated: ArrayLike | None = None,
    generated_boundaries: Whole | None = None,
    ylabel: str = "angle (degrees)",
    title: str = "",
    ylim: tuple[float, float] | None = None,
    source: str = "recorded",
) -> None:
    """The same labels cut from recordings and put end to end ([H], fig. 5), the generated curve in grey
    behind.

    Parameters
    ----------
    pieces : (T,)
        Angle of each frame of the pieces; each piece is a line of its own, so a step at a join is a gap in
        height.
    boundaries : (L + 1,)
        Where the pieces begin, and T.
    generated : (G,)
        Generated angle; stretched label by label to the pieces' lengths.
    generated_boundaries : (L + 1,)
        Where its labels begin, and G.
    ylim
        Range of the angles, to draw two plots alike.
    source
        What the legend calls the pieces, as "recorded (simulated)".
    """
    values, edges = _checked(path, pieces, boundaries, labels)
    with _axes(path, title) as axes:
        if generated is not None and generated_boundaries is not None:
            other, bounds = _checked(path, generated, generated_boundaries, labels)
            time = np.interp(np.arange(len(other)), bounds, edges) / fps
            axes.plot(time, other, color=_GREY, lw=2.0, label="generated, stretched label by label")
        for k, (start, end) in enumerate(pairwise(edges)):
            piece = slice(int(start), int(end))
            marker = {"marker": "o", "ms": 2.2} if end - start == 1 else {}
            axes.plot(
                np.arange(start, end) / fps,
                values[piece],
                color=_ACCENT,
                label=None if k else source,
                **marker,
            )
        _labelled(axes, edges, labels, fps, ylabel)
        if ylim is not None:
            axes.set_ylim(*ylim)
        if generated is not None:
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)


def staircase(
    path: Path,
    x: ArrayLike,
    mean: ArrayLike,
    variance: ArrayLike,
    boundaries: Whole,
    labels: Sequence[str],
    fps: float,
    *,
    ylabel: str = "angle (degrees)",
    title: str = "",
) -> None:
    """What a model does: the means of its states as steps, ±σ around them, the trajectory over them.

    Parameters
    ----------
    x : (T,)
        The trajectory.
    mean, variance : (T,)
        Of the state of each frame, the static feature.
    """
    values, edges = _checked(path, x, boundaries, labels)
    steps, width = np.asarray(mean, dtype=np.float64), np.sqrt(np.asarray(variance, dtype=np.float64))
    if steps.shape != values.shape or width.shape != values.shape:
        raise InputError(f"{path}: {len(values)} frames, {steps.shape} means and {width.shape} variances")
    time = (np.arange(len(values) + 1) - 0.5) / fps
    last = np.concatenate
    with _axes(path, title) as axes:
        low, high = steps - width, steps + width
        axes.fill_between(
            time, last([low, low[-1:]]), last([high, high[-1:]]), step="post", color=_PAPER, alpha=0.16, lw=0,
            label="±σ of the states",
        )  # fmt: skip
        axes.step(
            time, last([steps, steps[-1:]]), where="post", color=_PAPER, lw=0.9, label="mean of the states"
        )
        axes.plot(np.arange(len(values)) / fps, values, color=_INK, label="generated")
        _labelled(axes, edges, labels, fps, ylabel)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3)


def by_states(path: Path, curves: Mapping[str, Mapping[int, float]], *, ylabel: str, title: str = "") -> None:
    """A figure of models with 1, 2, … states, one curve for each form of covariance; [H]'s 3 states are marked.

    Parameters
    ----------
    curves
        Name → number of states → value. Each has axes of its own: full covariances may do much worse.
    """
    if not curves or not all(curves.values()):
        raise InputError(f"{path}: no model to show")
    with _axes(path, title, across=len(curves)) as axes:
        for one, (name, values) in zip(axes, curves.items(), strict=True):
            states = sorted(values)
            one.axvline(3, color=_GREY, lw=0.6, zorder=0)
            one.plot(states, [values[n] for n in states], "o-", color=_INK, ms=3.2)
            one.set_title(name, fontsize=8.0)
            one.set_xticks(states)
            one.set_xlabel("states")
        axes[0].set_ylabel(ylabel)


def measures(
    path: Path,
    bars: Sequence[Bar],
    *,
    xlabel: str,
    title: str = "",
    chance: float | None = None,
    log: bool = False,
) -> None:
    """Measures side by side: bars with intervals, the paper's figures as diamonds, chance as a line.

    Parameters
    ----------
    xlabel
        What is shown, and whose queries, as "mean rank of the target (simulated queries)".
    log
        Logarithmic axis.
    """
    if not bars:
        raise InputError(f"{path}: no measure to show")
    with _axes(path, title, height=0.7 + 0.27 * len(bars)) as axes:
        y = np.arange(len(bars))
        axes.barh(y, [b.value for b in bars], height=0.62, color="#c9ced6", label="here")
        for k, b in enumerate(bars):
            if b.low is not None and b.high is not None:
                axes.plot([b.low, b.high], [k, k], color=_INK, lw=1.0, solid_capstyle="butt")
            axes.annotate(
                f"{b.value:.3g}",
                (max(b.value, b.high or b.value), k),
                (4, 0),
                textcoords="offset points",
                va="center",
            )
        printed = [(b.paper, k) for k, b in enumerate(bars) if b.paper is not None]
        if printed:
            axes.plot(*zip(*printed, strict=True), "D", color=_PAPER, ms=4, label="printed in the paper")
        if chance is not None:
            axes.axvline(chance, color=_ACCENT, lw=0.8, ls=(0, (4, 3)), label="chance")
        axes.set_yticks(y, [b.name for b in bars])
        axes.invert_yaxis()
        axes.set_xlabel(xlabel)
        if log:
            axes.set_xscale("log")
        axes.margins(x=0.12)
        axes.tick_params(axis="y", length=0)
        handles, names = axes.get_legend_handles_labels()
        if len(names) > 1:
            axes.legend(handles, names, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=3)


def _checked(path: Path, x: ArrayLike, boundaries: Whole, labels: Sequence[str]) -> tuple[Floats, Floats]:
    values = np.asarray(x, dtype=np.float64)
    edges = np.asarray(boundaries, dtype=np.float64)
    if values.ndim != 1 or not len(values) or not np.isfinite(values).all():
        raise InputError(f"{path}: a curve of shape {values.shape}, expected (T,) finite numbers")
    if (
        edges.shape != (len(labels) + 1,)
        or edges[0] != 0
        or edges[-1] != len(values)
        or (np.diff(edges) <= 0).any()
    ):
        raise InputError(
            f"{path}: {len(labels)} labels and boundaries of shape {edges.shape}, "
            f"expected {len(labels) + 1} that rise from 0 to {len(values)}"
        )
    return values, edges


def _labelled(axes: Any, edges: Floats, labels: Sequence[str], fps: float, ylabel: str) -> None:
    """Label boundaries as vertical lines, labels above, time below."""
    for edge in edges[1:-1]:
        axes.axvline((edge - 0.5) / fps, color=_GREY, lw=0.6, zorder=0)
    for start, end, label in zip(edges[:-1], edges[1:], labels, strict=True):
        axes.text(
            (0.5 * (start + end) - 0.5) / fps, 1.015, label, transform=axes.get_xaxis_transform(),
            ha="center", va="bottom",
        )  # fmt: skip
    axes.set_xlim(-0.5 / fps, (edges[-1] - 0.5) / fps)
    axes.set_xlabel("time (s)")
    axes.set_ylabel(ylabel)


def _settings() -> Any:
    """matplotlib's own defaults and our style, whatever the user has set."""
    return {**dict(matplotlib.rcParamsDefault), **_STYLE, "backend": "agg"}


@contextmanager
def _axes(path: Path, title: str, height: float = 2.1, across: int | None = None) -> Iterator[Any]:
    """Axes to draw on, or so many side by side; saved whole to the path, without stamps."""
    kind = os.fspath(path).rsplit(".", 1)[-1].lower()
    if kind not in _STAMPS:
        raise InputError(f"{path}: cannot be written; plots are .png, .svg or .pdf")
    with matplotlib.rc_context(_settings()):
        plot = Figure(figsize=(6.3, height))
        FigureCanvasAgg(plot)
        axes = plot.add_subplot() if across is None else plot.subplots(1, across, squeeze=False)[0]
        plot.subplots_adjust(wspace=0.3)
        yield axes
        if title:
            plot.suptitle(title, x=0.01, y=0.96 + 0.08 / height, ha="left", va="bottom", fontsize=8.5)
        with store.replaced(path) as temporary:
            plot.savefig(temporary, dpi=220, metadata=_STAMPS[kind], bbox_inches="tight", pad_inches=0.05)
