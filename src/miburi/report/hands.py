"""What the page shows of hands: generated and spliced motions beside their curves, and the models."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from miburi.figures import HAND
from miburi.hmm.model import Model
from miburi.hmm.splicing import Spliced
from miburi.hmm.synthesis import Synthesis, hand_motion
from miburi.report.pack import Clips, packed

DEGREE = 0.02
"""Degrees that one step of the packed angles stands for."""

ANGLES = tuple(f"{joint} {turn}" for joint in HAND.joints for turn in ("abduction", "flexion", "twist"))
"""Names of the 48 angles: joint-major, Z X Y."""

SHOWN = 3 * HAND.index("middle3") + 1
"""The angle of [H]'s figures 4 and 5."""


def gesture(
    name: str,
    synthesis: Synthesis,
    spliced: Spliced | None,
    source: str,
    clips: Clips,
    numbers: dict[str, str],
) -> dict[str, Any]:
    """A string: its curves and motions go to `numbers` and `clips`, what the page's script needs is returned.

    Parameters
    ----------
    name
        Of the string.
    spliced
        The same labels cut from the recordings.
    source
        "simulated" or "recorded" intervals.
    """
    fps, width = float(synthesis.fps or 30.0), synthesis.trajectory.shape[1]
    numbers[f"{name}/mean"] = packed(synthesis.mean[:, :width], DEGREE)
    numbers[f"{name}/sd"] = packed(np.sqrt(synthesis.variance[:, :width]), DEGREE)

    def curve(kind: str, one: Synthesis | Spliced) -> dict[str, Any]:
        full = f"{name}/{kind}"
        clips.add(full, hand_motion(one.trajectory, fps, full))
        numbers[full] = packed(one.trajectory, DEGREE)
        frames = len(one.trajectory)
        return {"clip": full, "numbers": full, "frames": frames, "boundaries": one.boundaries.tolist()}

    return {
        "name": name,
        "fps": fps,
        "unit": DEGREE,
        "joints": ANGLES if width == len(ANGLES) else [f"angle {k}" for k in range(width)],
        "joint": SHOWN if width == len(ANGLES) else 0,
        "labels": list(synthesis.labels),
        "generated": curve("generated", synthesis),
        "spliced": None if spliced is None else curve("spliced", spliced),
        "mean": f"{name}/mean",
        "sd": f"{name}/sd",
        "source": source,
    }


def models(found: Sequence[Model]) -> dict[str, Any]:
    """States, durations and likelihoods of labels' models."""
    width = found[0].mean.shape[1] // 3
    return {
        "joints": ANGLES if width == len(ANGLES) else [f"angle {k}" for k in range(width)],
        "models": [
            {
                "label": m.label,
                "fps": m.fps,
                "duration_mean": _round(m.duration_mean),
                "duration_sd": _round(np.sqrt(m.duration_variance)),
                "log_likelihood": _round(m.log_likelihood, 1),
                "mean": [_round(s, 2) for s in m.mean[:, :width]],
                "sd": [_round(s, 2) for s in np.sqrt(m.variance[:, :width])],
            }
            for m in found
        ],
    }


def model_rows(found: Sequence[Model]) -> list[tuple[str, ...]]:
    """Label, intervals, frames, states, mean length in seconds, iterations, log-likelihood per frame."""
    return [
        (
            m.label,
            str(m.intervals),
            str(m.frames),
            str(m.states),
            f"{float(m.duration_mean.sum()) / m.fps:.3f}" if m.fps else "",
            str(len(m.log_likelihood) - 1),
            f"{m.log_likelihood[-1] / m.frames:.3f}",
            "yes" if m.converged else "no",
        )
        for m in found
    ]


MODEL_COLUMNS = (
    "label",
    "intervals",
    "frames",
    "states",
    "duration_s",
    "iterations",
    "log_likelihood_per_frame",
    "converged",
)


def _round(values: Any, digits: int = 3) -> list[float]:
    return [round(float(v), digits) for v in values]
