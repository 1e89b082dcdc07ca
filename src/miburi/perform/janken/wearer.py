"""A simulated glove wearer who shows rock, paper and scissors ([H], section on the experiment).

Nobody wore a glove. Every interval has the length that the label counts of [H]'s table 2 leave it; `hand` moves
within it, `device` reads the hand, and both are written in the format of a real logger. What a real glove's
recording shows beside this one stands in docs/janken.md.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import yaml
from numpy.typing import NDArray

from miburi import store
from miburi.formats import glove
from miburi.formats.annotations import Annotation, write_annotations
from miburi.formats.labels import Interval, write_labels
from miburi.perform.janken import COUNTS, FPS, RECORDINGS, SMALL, WEARER, alternation
from miburi.perform.janken.device import Device
from miburi.perform.janken.hand import movement, wander
from miburi.perform.janken.sensors import NAMES, calibration

_SHORTEST = {1: 5, 2: 6}  # frames: a hold, a change


def perform(seed: int, *, small: bool = False) -> dict[str, tuple[NDArray[np.int64], list[Interval]]]:
    """The three recordings of a simulated glove wearer.

    Parameters
    ----------
    seed
        Another seed is another session of the same wearer.
    small
        About 40 % of each recording, for trying and testing.

    Returns
    -------
    dict of (counts, labels)
        By take: counts (T, 22) from 0 to 255 at 30 frames/s, and intervals (start, end, label), end
        exclusive, that cover every frame. In all 4197 frames and 245 intervals, those of [H]'s table 2
        label by label (not small).
    """
    lengths = {label: iter(_lengths(seed, label)) for label in COUNTS}
    device = Device.drawn(seed)
    recordings = {}
    for take in RECORDINGS:
        labels = alternation(take)
        ends = np.cumsum([next(lengths[label]) for label in labels])
        starts = np.concatenate([[0], ends[:-1]])
        intervals = [(int(s), int(e), n) for s, e, n in zip(starts, ends, labels, strict=True)]
        angles = movement(intervals, store.seed(seed, "janken", take, "hand"))
        counts = device.read(angles, store.seed(seed, "janken", take, "glove"))
        if small:
            intervals = intervals[: 2 * SMALL - 1]
            counts = counts[: intervals[-1][1]]
        recordings[take] = counts, intervals
    return recordings


def write(folder: str | os.PathLike[str], seed: int, *, small: bool = False) -> list[Path]:
    """Write the recordings: `{take}.csv`, `{take}.lab`, `wearer.yaml` and `annotations.tsv`.

    Returns
    -------
    list of Path
        What was written.
    """
    home = Path(folder)
    rows, written = [], []
    for take, (counts, labels) in perform(seed, small=small).items():
        log, lab = home / f"{take}.csv", home / f"{take}.lab"
        glove.write_log(log, counts, FPS, sensors=NAMES, simulated=True)
        write_labels(lab, labels, fps=FPS)
        rows += [Annotation(take, s / FPS, e / FPS, label) for s, e, label in labels]
        written += [log, lab]
    body = yaml.safe_dump({"sensors": calibration()}, sort_keys=False, default_flow_style=None, width=160)
    store.write_text(home / f"{WEARER}.yaml", f"# miburi glove calibration 1, simulated=1\n{body}")
    write_annotations(home / "annotations.tsv", rows)
    return [*written, home / f"{WEARER}.yaml", home / "annotations.tsv"]


def _lengths(seed: int, label: str) -> list[int]:
    """Lengths of a label's intervals, frames: log-normal, slowly wandering tempo, the sum of table 2
    exactly."""
    frames, intervals = COUNTS[label]
    rng = store.seed(seed, "janken", "lengths", label)
    tempo = wander(rng, intervals, 0.75)
    raw = np.exp(0.38 * (0.5 * tempo + 0.87 * rng.standard_normal(intervals)))
    least = _SHORTEST[len(label)]
    exact = least + raw / raw.sum() * (frames - least * intervals)
    whole = np.floor(exact).astype(np.int64)
    whole[np.argsort(whole - exact, kind="stable")[: frames - whole.sum()]] += 1  # largest remainders
    return [int(n) for n in whole]
