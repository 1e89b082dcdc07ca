"""What glove and puppet logs share: a first line with keys, a header, comma-separated numbers, an even
clock."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import yaml

from miburi.errors import InputError
from miburi.formats import scan, text
from miburi.motion import Floats

LONGEST_GAP_S = 10.0
"""A clock may not stand still or jump for longer."""


_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # the same language, parsed natively


def first_line(signature: str, keys: Mapping[str, object]) -> str:
    """`# signature, key=value, …`; numbers are written as short as they are exact."""
    for key, value in keys.items():
        if any(c in f"{key}{value}" for c in ",=\n\r"):
            raise InputError(f"the key {key!r} of a log cannot be {value!r}")
    values = [
        f"{k}={v:g}" if isinstance(v, float) and float(f"{v:g}") == v else f"{k}={v}" for k, v in keys.items()
    ]
    return ", ".join([f"# {signature}", *values])


def signature(path: text.File, data: bytes, expected: str) -> dict[str, str]:
    """The keys of a log's first line.

    Raises
    ------
    InputError
        The first line is another one.
    """
    first = text.decode(data.split(b"\n", 1)[0]).strip()
    parts = [p.strip() for p in first.lstrip("#").split(",")]
    if not first.startswith("#") or parts[0] != expected:
        raise InputError(f"{path}, line 1: found {text.shown(first)}, expected '# {expected}, …'")
    keys: dict[str, str] = {}
    for part in parts[1:]:
        key, equals, value = part.partition("=")
        if part and (not equals or key.strip() in keys):
            raise InputError(f"{path}, line 1: found {text.shown(part)}, expected key=value, each key once")
        if part:
            keys[key.strip()] = value.strip()
    return keys


def rate(path: text.File, keys: Mapping[str, str], fps: float | None) -> float:
    """Frames per second: `fps`, else what the first line says."""
    if fps is not None:
        return fps
    if "fps" not in keys:
        raise InputError(f"{path}, line 1: it does not say fps=…")
    return number(path, "fps in line 1", keys["fps"], above=0.0)


def number(where: text.File, key: str, value: object, *, above: float | None = None) -> float:
    """A finite number of a file, or InputError that names its key."""
    try:
        found = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        found = float("nan")
    if isinstance(value, bool) or not np.isfinite(found) or (above is not None and found <= above):
        more = "" if above is None else f" above {above:g}"
        raise InputError(f"{where}: {key} is {value!r}, expected a number{more}")
    return found


def start(data: bytes) -> int:
    """Where the rows of numbers begin: after the first line and the header."""
    first = data.find(b"\n") + 1
    second = data.find(b"\n", first) + 1
    return second if first and second else len(data)


def header(path: text.File, data: bytes) -> list[str]:
    """Names of a log's columns: its second line.

    Raises
    ------
    InputError
        There is none, or a column stands twice.
    """
    lines = data.split(b"\n", 2)
    columns = [c.strip() for c in text.decode(lines[1]).split(",")] if len(lines) > 1 else []
    if not columns or not all(columns):
        raise InputError(
            f"{path}, line 2: found {text.shown(lines[1] if len(lines) > 1 else b'')}, expected a header"
        )
    if len(set(columns)) != len(columns):
        twice = next(c for c in columns if columns.count(c) > 1)
        raise InputError(f"{path}, line 2: the column {twice!r} stands twice")
    return columns


def read(path: text.File, data: bytes) -> tuple[list[str], Floats]:
    """Header and numbers of a log's comma-separated table.

    Raises
    ------
    InputError
        A column stands twice, a value is missing or no number; the sentence names line and column.
    """
    columns = header(path, data)
    begin = start(data)
    plain = data[begin:].replace(b",", b" ")
    try:
        values = scan.numbers(path, plain, 0, len(columns))
    except InputError:
        values = None
    # as many commas as there should be: a row of "1,,2" must not pass as two values
    if values is None or data.count(b",", begin) != (len(columns) - 1) * len(values):
        complain(path, data, begin, columns)
    if len(values) == 0:
        raise InputError(f"{path}, line 3: the log ends before its first row")
    return columns, values


def complain(path: text.File, data: bytes, begin: int, columns: list[str]) -> NoReturn:
    """Name the line and column that are wrong."""
    number = text.line_of(data, begin)
    for line in data[begin:].split(b"\n"):
        cells = [c.strip() for c in line.split(b",")]
        if line.strip():
            if len(cells) != len(columns):
                s = "" if len(cells) == 1 else "s"
                raise InputError(f"{path}, line {number}: {len(cells)} value{s}, expected {len(columns)}")
            for cell, column in zip(cells, columns, strict=True):
                if text.real(cell) is None:
                    raise InputError(
                        f"{path}, line {number}: column {column!r} is {text.shown(cell)}, expected a "
                        "finite number"
                    )
        number += 1
    raise InputError(f"{path}, line {text.line_of(data, begin)}: the rows are no comma-separated numbers")


def even(
    path: text.File, time: Floats, values: Floats, fps: float, first: int, *, strict: bool = True
) -> tuple[Floats, Floats]:
    """Rows of an uneven clock, at an even one.

    Parameters
    ----------
    time : (T,)
        Seconds.
    values : (T, C)
        Interpolated linearly.
    first
        Line of the first row, for errors.
    strict
        Refuse equal times; otherwise the last row of those that share a time counts.

    Returns
    -------
    time, values
        As given, where each step is 1 / fps to 2 %; else every 1 / fps from the first row on.
    """
    steps = np.diff(time)
    wrong = np.flatnonzero((steps <= 0) if strict else (steps < 0))
    if wrong.size:
        k = int(wrong[0])
        raise InputError(
            f"{path}, line {first + k + 1}: the time {time[k + 1]:g} s does not follow {time[k]:g} s "
            f"in line {first + k}"
        )
    far = np.flatnonzero(steps > LONGEST_GAP_S)
    if far.size:
        k = int(far[0])
        raise InputError(
            f"{path}, line {first + k + 1}: the clock jumps by {steps[k]:g} s, at most "
            f"{LONGEST_GAP_S:g} s pass"
        )
    # times are written to a tenth of a millisecond
    if len(time) < 2 or np.abs(steps - 1 / fps).max() <= 0.02 / fps + 1.01e-4:
        return time, values
    if not strict:
        last = np.append(steps > 0, True)
        time, values = time[last], values[last]
    at = time[0] + np.arange(int(np.floor((time[-1] - time[0]) * fps + 1e-9)) + 1) / fps
    return at, np.column_stack([np.interp(at, time, column) for column in values.T])


def load_yaml(path: text.File) -> dict[str, Any]:
    """A YAML file whose top is a mapping.

    Raises
    ------
    InputError
        It is none.
    """
    try:
        document = yaml.load(text.decode(text.load(path)), _LOADER)
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = f", line {mark.line + 1}" if mark is not None else ""
        raise InputError(
            f"{path}{line}: is no YAML ({getattr(error, 'problem', None) or 'unreadable'})"
        ) from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: is no YAML ({error})") from None
    if not isinstance(document, dict):
        raise InputError(f"{path}: found no keys, expected a mapping")
    return document


def only_yaml(path: text.File) -> Path:
    """The only .yaml beside a log.

    Raises
    ------
    InputError
        There is none, or there are several.
    """
    folder = Path(path).parent
    there = sorted(p for p in folder.glob("*") if p.suffix in (".yaml", ".yml")) if folder.is_dir() else []
    if len(there) != 1:
        found = "there is none" if not there else f"there are {', '.join(p.name for p in there)}"
        raise InputError(
            f"{path}: its calibration is missing: expected one .yaml in {folder}, {found}; name it "
            "(config key `calibration`)"
        )
    return there[0]
