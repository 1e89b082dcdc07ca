"""Recordings in every format, by one pair of verbs: `read` and `write`."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from miburi.conventions import family
from miburi.errors import InputError
from miburi.formats import text
from miburi.formats.annotations import read_annotations, write_annotations
from miburi.formats.labels import read_labels, write_labels
from miburi.motion import Motion, Skeleton

# a format is imported by what reads it: stages that need a table of names only start in half the time
if TYPE_CHECKING:
    from miburi.formats import asf_amc, units

KNOWN = (
    ".bvh (Biovision), .amc (Acclaim, with its .asf), .csv (glove log, puppet log), other loggers' "
    ".csv, .txt and "
    ".dat with a column map; each also gzipped (.gz)"
)
"""The formats that can be read, for messages."""


def _option(corpus: Any, name: str) -> Any:
    """A corpus's setting; None where it is absent or empty."""
    return getattr(corpus, name, None) or None


def read(
    path: text.File,
    *,
    skeleton: text.File | Skeleton | asf_amc.Acclaim | None = None,
    fps: float | None = None,
    corpus: Any = None,
) -> Motion:
    """Read a recording; the format is told by the file's ending and content.

    Parameters
    ----------
    path
        .bvh, .amc, a glove or puppet log, or another logger's table; each also gzipped.
    skeleton
        AMC: path of the ASF, or what `asf_amc.read_asf` gave; absent: found beside the recording.
    fps
        Frames per second, where the recording names none or a wrong rate.
    corpus
        Settings: anything with attributes `fps`, `unit`, `up`, `joints`, `skeleton`, `calibration`, `columns`
        (a `miburi.config` group); those that are absent or empty are not set.

    Returns
    -------
    Motion
        Metres, Y up, right-handed.

    Raises
    ------
    InputError
        One sentence: which file and line, what was found, what was expected.
    """
    rate = fps if fps is not None else _option(corpus, "fps")
    ending = text.suffix(path)
    if ending == ".bvh":
        return _biovision(path, rate, corpus)[0]
    if ending == ".amc":
        return _acclaim(path, skeleton, rate, corpus)[0]
    if ending in (".csv", ".txt", ".dat", ".log"):
        return _table(path, rate, corpus)
    if ending == ".asf":
        raise InputError(f"{path}: is a skeleton without motion; read an .amc and give this as its skeleton")
    raise InputError(f"{path}: cannot be read as a recording; known are {KNOWN}")


def _biovision(path: text.File, fps: float | None, corpus: Any) -> tuple[Motion, units.Choice]:
    from miburi.formats import bvh

    settings = {name: _option(corpus, name) for name in ("unit", "up", "joints")}
    return bvh.load(path, fps=fps, **settings)


def _acclaim(
    path: text.File, skeleton: text.File | Skeleton | asf_amc.Acclaim | None, fps: float | None, corpus: Any
) -> tuple[Motion, units.Choice]:
    from miburi.formats import asf_amc, units

    unit, up = _option(corpus, "unit"), _option(corpus, "up")
    asf = skeleton if skeleton is not None else _option(corpus, "skeleton")
    if isinstance(asf, Skeleton):
        raise InputError(f"{path}: a Skeleton does not hold the axes of an ASF; give the path of the ASF")
    if not isinstance(asf, asf_amc.Acclaim):
        asf = asf_amc.read_asf(asf_amc.find_asf(path) if asf is None else asf, unit=unit)
    motion = asf_amc.read(path, skeleton=asf, fps=fps)
    choice = units.Choice(
        asf.unit,
        "length of the ASF" if unit is None else "stated",
        up or "y",
        "as Acclaim files have it" if up is None else "stated",
    )
    return units.turned(motion, choice.up), choice


def _table(path: text.File, fps: float | None, corpus: Any) -> Motion:
    """A log or another logger's table."""
    from miburi.formats import glove, puppet

    first = text.load(path)[:200].split(b"\n", 1)[0]
    if puppet.SIGNATURE.encode() in first:
        return puppet.read(path, fps=fps, calibration=_option(corpus, "calibration"))
    if glove.SIGNATURE.encode() in first:
        return glove.read(path, fps=fps, calibration=_option(corpus, "calibration"))
    if (columns := _option(corpus, "columns")) is not None:
        return glove.read_columns(path, columns, fps=fps)
    raise InputError(
        f"{path}, line 1: is neither a glove log nor a puppet log; another logger's table needs a "
        "column map (config key "
        f"`columns`); known are {KNOWN}"
    )


def write(path: text.File, motion: Motion) -> None:
    """Write a motion as .bvh or .bvh.gz: centimetres, Y up; the file appears whole or not at all.

    Raises
    ------
    InputError
        The path ends in something else, or the motion cannot be written.
    """
    if text.suffix(path) != ".bvh":
        raise InputError(f"{path}: cannot be written; a motion is written as .bvh or .bvh.gz")
    from miburi.formats import bvh

    bvh.write(path, motion)


def inspect(path: text.File, *, corpus: Any = None) -> dict[str, object]:
    """How a recording is understood: format, joints, frames, rate, unit, upward axis and what these rest
    on."""
    ending = text.suffix(path)
    rate = _option(corpus, "fps")
    choice = None
    if ending == ".bvh":
        motion, choice = _biovision(path, rate, corpus)
    elif ending == ".amc":
        motion, choice = _acclaim(path, None, rate, corpus)
    else:
        motion = read(path, corpus=corpus)
    facts: dict[str, object] = {
        "format": {".bvh": "BVH", ".amc": "AMC"}.get(ending, "table"),
        "joints": len(motion.skeleton),
        "frames": len(motion),
        "fps": motion.fps,
        "translations": motion.translations is not None,
        "convention": family(motion.skeleton),
    }
    return facts | (asdict(choice) if choice is not None else {})


__all__ = [
    "KNOWN",
    "inspect",
    "read",
    "read_annotations",
    "read_labels",
    "write",
    "write_annotations",
    "write_labels",
]
