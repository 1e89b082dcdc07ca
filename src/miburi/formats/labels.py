"""Label files: which gesture is made from when to when.

Read are, told by ending and content:

* `.lab`: HTK, `start end label` in units of 100 ns, in frames or in seconds (`unit`; absent: seconds if a
  time has a point, 100 ns if the intervals last 20 000 units or more in the middle, else frames);
* `.tsv`: a header `start_frame end_frame label`; the end is exclusive, or inclusive, as
  `end_frame_exclusive` or `end_frame_inclusive` says; under a plain `end_frame` it is inclusive if intervals
  follow each other with the next frame and never with the same one;
* `.txt`: an Audacity label track, seconds;
* `.TextGrid` (Praat, by praatio) and `.eaf` (ELAN, by pympi-ling): the extra `labels` installs both
  libraries.

Times become frame boundaries by rounding t · fps to the nearest whole number, a half upwards.
"""

from __future__ import annotations

import importlib
import logging
from collections.abc import Sequence
from itertools import pairwise
from types import ModuleType
from typing import Literal

import numpy as np

from miburi import store
from miburi.errors import InputError
from miburi.formats import text

log = logging.getLogger(__name__)

Unit = Literal["100ns", "frames", "seconds"]
Interval = tuple[int, int, str]
_Row = tuple[int, float, float, str]  # line (or number of the interval), start, end, label


def read_labels(
    path: text.File,
    *,
    fps: float,
    unit: Unit | None = None,
    frames: int | None = None,
    tier: str | None = None,
) -> list[Interval]:
    """Read a label file.

    Parameters
    ----------
    fps
        Frames per second of the take.
    unit
        Of the times in an HTK file; absent: found as said above.
    frames
        Length of the take; labels beyond it are refused.
    tier
        Tier of a TextGrid or ELAN file; absent: the only one.

    Returns
    -------
    list of (start, end, label)
        Frames, start inclusive, end exclusive, sorted; gaps are allowed.

    Raises
    ------
    InputError
        An interval is empty, overlaps the next or lies beyond the end, or the file is damaged.
    """
    if unit not in (None, "100ns", "frames", "seconds"):
        raise InputError(f"label_unit is {unit!r}, expected 100ns, frames or seconds")
    ending = text.suffix(path)
    if ending == ".lab":
        rows, scale = _htk(path, fps, unit)
    elif ending == ".tsv":
        rows, scale = _tsv(path), 1.0
    elif ending == ".txt":
        rows, scale = _audacity(path), fps
    elif ending == ".textgrid":
        rows, scale = _textgrid(path, tier), fps
    elif ending == ".eaf":
        rows, scale = _elan(path, tier), fps
    else:
        raise InputError(f"{path}: cannot be read as labels; known are .lab, .tsv, .txt, .TextGrid and .eaf")
    return _checked(path, rows, scale, frames, "interval" if ending in (".textgrid", ".eaf") else "line")


def _checked(
    path: text.File, rows: list[_Row], scale: float, frames: int | None, place: str
) -> list[Interval]:
    """Rows as sorted intervals of frames."""
    found: list[tuple[int, int, str, int]] = []
    for number, start, end, label in rows:
        where = f"{path}, {place} {number}"
        if not (np.isfinite(start) and np.isfinite(end)) or start < 0 or max(start, end) * scale > 2**53:
            raise InputError(f"{where}: the times {start:g} and {end:g} cannot be")
        first, last = int(np.floor(start * scale + 0.5)), int(np.floor(end * scale + 0.5))
        if last <= first:
            raise InputError(f"{where}: the label {label!r} from {start:g} to {end:g} has no frame")
        if not label:
            raise InputError(f"{where}: the label is empty")
        if frames is not None and last > frames:
            raise InputError(f"{where}: the label {label!r} ends with frame {last}, the take has {frames}")
        found.append((first, last, label, number))
    found.sort()
    for (_, end, one, _), (start, _, other, number) in pairwise(found):
        if start < end:
            raise InputError(
                f"{path}, {place} {number}: {other!r} begins at frame {start}, before {one!r} ends at {end}"
            )
    return [(s, e, label) for s, e, label, _ in found]


def _words(path: text.File, separator: str | None) -> list[tuple[int, list[str]]]:
    """Cells of each line that is not blank, with its number."""
    lines = enumerate(text.decode(text.load(path)).split("\n"), 1)
    return [(n, [c.strip() for c in line.split(separator)]) for n, line in lines if line.strip()]


def _time(where: str, word: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise InputError(f"{where}: found {text.shown(word)}, expected a time") from None


def _htk(path: text.File, fps: float, unit: Unit | None) -> tuple[list[_Row], float]:
    rows: list[_Row] = []
    pointed = False
    for number, words in _words(path, None):
        where = f"{path}, line {number}"
        if len(words) < 3:
            raise InputError(f"{where}: found {text.shown(' '.join(words))}, expected start, end and label")
        pointed |= "." in words[0] + words[1]
        rows.append((number, _time(where, words[0]), _time(where, words[1]), " ".join(words[2:])))
    if unit is None and rows:
        lengths = [end - start for _, start, end, _ in rows]
        unit = "seconds" if pointed else "100ns" if np.median(lengths) >= 20_000 else "frames"
        log.info("%s: times are read as %s", path, unit)
    return rows, {"100ns": fps * 1e-7, "frames": 1.0, "seconds": fps, None: 1.0}[unit]


def _tsv(path: text.File) -> list[_Row]:
    lines = _words(path, "\t")
    header = lines[0][1] if lines else []
    ends = [c for c in header if c in ("end_frame", "end_frame_exclusive", "end_frame_inclusive")]
    if "start_frame" not in header or "label" not in header or len(ends) != 1:
        raise InputError(
            f"{path}, line 1: found {text.shown(' '.join(header))}, expected the columns start_frame, "
            "end_frame and label"
        )
    rows: list[_Row] = []
    for number, cells in lines[1:]:
        where = f"{path}, line {number}"
        if len(cells) != len(header):
            raise InputError(f"{where}: {len(cells)} columns, expected {len(header)}")
        row = dict(zip(header, cells, strict=True))
        start, end = _time(where, row["start_frame"]), _time(where, row[ends[0]])
        if start != np.floor(start) or end != np.floor(end):
            raise InputError(f"{where}: found {row['start_frame']} and {row[ends[0]]}, expected whole frames")
        rows.append((number, start, end, row["label"]))
    inclusive = ends[0] == "end_frame_inclusive" or (ends[0] == "end_frame" and _looks_inclusive(path, rows))
    return [(n, s, e + 1, label) for n, s, e, label in rows] if inclusive else rows


def _looks_inclusive(path: text.File, rows: list[_Row]) -> bool:
    times = sorted((s, e) for _, s, e, _ in rows)
    steps = [following[0] - this[1] for this, following in pairwise(times)]
    inclusive = 0 not in steps and (1 in steps or any(s == e for s, e in times))
    log.info("%s: end_frame is read as %s", path, "inclusive" if inclusive else "exclusive")
    return inclusive


def _audacity(path: text.File) -> list[_Row]:
    rows: list[_Row] = []
    for number, cells in _words(path, "\t"):
        where = f"{path}, line {number}"
        if cells[0] == "\\":  # the frequencies of the label above
            continue
        if len(cells) != 3:
            raise InputError(
                f"{where}: {len(cells)} columns, expected start, end and label of an Audacity label track"
            )
        rows.append((number, _time(where, cells[0]), _time(where, cells[1]), cells[2]))
    return rows


def _library(path: text.File, module: str, package: str) -> ModuleType:
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f"{path}: needs the library {package}; install it with: pip install 'miburi[labels]'"
        ) from None


def _one_tier(path: text.File, tier: str | None, tiers: Sequence[str]) -> str:
    if tier is None and len(tiers) == 1:
        return tiers[0]
    if tier in tiers:
        return str(tier)
    asked = "which one is not said" if tier is None else f"there is no {tier!r}"
    raise InputError(f"{path}: {asked}; its tiers of intervals are {', '.join(tiers) or 'none'}")


def _textgrid(path: text.File, tier: str | None) -> list[_Row]:
    textgrid = _library(path, "praatio.textgrid", "praatio")
    text.load(path)
    try:
        grid = textgrid.openTextgrid(str(path), includeEmptyIntervals=False)
        names = [n for n in grid.tierNames if isinstance(grid.getTier(n), textgrid.IntervalTier)]
    except Exception as error:  # the library's own kinds are many
        raise InputError(f"{path}: is no TextGrid that praatio can read ({error})") from None
    entries = grid.getTier(_one_tier(path, tier, names)).entries
    return [(k, float(e.start), float(e.end), str(e.label).strip()) for k, e in enumerate(entries, 1)]


def _elan(path: text.File, tier: str | None) -> list[_Row]:
    elan = _library(path, "pympi.Elan", "pympi-ling")
    text.load(path)
    try:
        document = elan.Eaf(str(path))
        names = list(document.get_tier_names())
    except Exception as error:  # the library's own kinds are many
        raise InputError(f"{path}: is no ELAN file that pympi can read ({error})") from None
    entries = document.get_annotation_data_for_tier(_one_tier(path, tier, names))
    return [(k, e[0] / 1000, e[1] / 1000, str(e[2]).strip()) for k, e in enumerate(sorted(entries), 1)]


def write_labels(path: text.File, intervals: Sequence[Interval], *, fps: float) -> None:
    """Write labels: `.lab` (HTK, 100 ns), `.tsv` (frames, end exclusive) or `.txt` (Audacity, seconds).

    Parameters
    ----------
    intervals
        (start, end, label): frames, start inclusive, end exclusive.

    Raises
    ------
    InputError
        Intervals overlap or are empty, a label cannot be written, or the ending is another one.
    """
    rows = [(k, float(s), float(e), label) for k, (s, e, label) in enumerate(intervals, 1)]
    found = _checked(path, rows, 1.0, None, "interval")
    for _, _, label in found:
        if label != " ".join(label.split()):
            raise InputError(f"{path}: the label {label!r} cannot be written")
    ending = text.suffix(path)
    if ending == ".lab":
        lines = [f"{round(s / fps * 1e7)} {round(e / fps * 1e7)} {label}" for s, e, label in found]
    elif ending == ".tsv":
        lines = ["start_frame\tend_frame_exclusive\tlabel", *(f"{s}\t{e}\t{label}" for s, e, label in found)]
    elif ending == ".txt":
        lines = [f"{s / fps:.6f}\t{e / fps:.6f}\t{label}" for s, e, label in found]
    else:
        raise InputError(f"{path}: labels are written as .lab, .tsv or .txt")
    store.write_text(path, "\n".join(lines) + ("\n" if lines else ""))
