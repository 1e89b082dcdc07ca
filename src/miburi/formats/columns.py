"""Other loggers' tables of hand angles, read by a column map.

A map is YAML (ready ones are in config/gloves/), columns are counted from 0:

    fps: 24
    separator: ":"        # absent: blanks
    decimal: ","          # absent: "."
    header: 1             # lines before the numbers; absent: 0
    count: 22             # columns of the file, checked; absent: as many as the first row has
    unit: radians         # degrees (absent), radians, or counts, whose factors are degrees per count
    text: [22]            # columns that are no numbers
    brackets: true        # "[x y z w],[…": columns are the numbers inside, counted through
    lying: true           # a row of the file is a column here
    skip: 1               # samples at the start that say nothing
    time: {column: 15, unit: days}   # seconds (absent), milliseconds, days: rows are brought to `fps` by it
    columns:
      - {column: 4, joint: index1, axis: x, factor: -1}
      - {column: 3, joint: thumb1, axis: z, factor: 1, offset: -0.7}
      - {column: 10, joint: [middle1, index1], axis: z}
      - {quaternion: 8, about: z, joint: index2, axis: x}

Degrees are factor · (value − offset), the offset in the file's unit. `joint` as a list, `weights` and `also`
are as in a calibration (`miburi.formats.glove`). A quaternion (x y z w, four columns, counted in fours)
gives its angle of twist about one of its own axes, in degrees.
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from typing import Any

import numpy as np

from miburi.errors import InputError
from miburi.figures import HAND
from miburi.formats import scan, tables, text
from miburi.motion import Floats

_KEYS = (
    "fps",
    "separator",
    "decimal",
    "header",
    "count",
    "unit",
    "text",
    "brackets",
    "lying",
    "skip",
    "time",
    "columns",
)
_ENTRY = ("column", "quaternion", "about", "joint", "axis", "factor", "offset", "weights", "also")
_DEGREES = {"degrees": 1.0, "radians": 180 / np.pi, "counts": 1.0}
_SECONDS = {"seconds": 1.0, "milliseconds": 1e-3, "days": 86400.0}

Map = Mapping[str, Any]
NAME = "__name__"
"""Key under which a loaded map keeps where it came from, for messages."""


def check_keys(where: object, key: str, entry: Map, known: tuple[str, ...]) -> None:
    """InputError if a mapping has a key that is not known."""
    for found in entry:
        if found not in known and found != NAME:
            raise InputError(
                f"{where}: there is no key {key + '.' if key else ''}{found}; there are {', '.join(known)}"
            )


def angle_index(where: object, key: str, joint: object, axis: object) -> int:
    """Column of an angle among the 48: joint-major, Z X Y."""
    if joint not in HAND.joints:
        raise InputError(f"{where}: {key}.joint is {joint!r}, expected one of {', '.join(HAND.joints)}")
    if axis not in ("z", "x", "y"):
        raise InputError(f"{where}: {key}.axis is {axis!r}, expected z, x or y")
    return 3 * HAND.joints.index(str(joint)) + "zxy".index(str(axis))


def shares(where: object, key: str, entry: Map) -> Floats:
    """Share of a sensor in each of the 48 angles, from `joint`, `axis`, `weights` and `also`."""
    row = np.zeros(3 * len(HAND))
    joint = entry.get("joint")
    if joint is not None:
        joints = joint if isinstance(joint, list) else [joint]
        weights = entry.get("weights", [1.0] if len(joints) == 1 else [0.5, -0.5])
        if not isinstance(weights, list) or len(weights) != len(joints):
            raise InputError(
                f"{where}: {key}.weights is {weights!r}, expected one number for each of {len(joints)} joints"
            )
        for name, weight in zip(joints, weights, strict=True):
            index = angle_index(where, key, name, entry.get("axis"))
            row[index] += tables.number(str(where), f"{key}.weights", weight)
    also = entry.get("also", [])
    if not isinstance(also, list):
        raise InputError(f"{where}: {key}.also is {also!r}, expected a list of joint, axis and factor")
    for k, more in enumerate(also):
        inner = f"{key}.also[{k}]"
        if not isinstance(more, Mapping):
            raise InputError(f"{where}: {inner} is {more!r}, expected joint, axis and factor")
        check_keys(where, inner, more, ("joint", "axis", "factor"))
        index = angle_index(where, inner, more.get("joint"), more.get("axis"))
        row[index] += tables.number(str(where), f"{inner}.factor", more.get("factor", 1.0))
    return row


def load(columns: text.File | Map) -> Map:
    """A column map from its file, or as it is, checked.

    Raises
    ------
    InputError
        A key is unknown or has a value that it cannot have.
    """
    found = (
        dict(columns) if isinstance(columns, Mapping) else tables.load_yaml(columns) | {NAME: str(columns)}
    )
    where = found.setdefault(NAME, "columns")
    check_keys(where, "", found, _KEYS)
    for key, kind in (
        ("separator", str),
        ("decimal", str),
        ("brackets", bool),
        ("lying", bool),
        ("text", list),
    ):
        if not isinstance(found.get(key, kind()), kind):
            raise InputError(
                f"{where}: {key} is {found[key]!r}, expected {'a list' if kind is list else kind.__name__}"
            )
    for key in ("header", "skip", "count"):
        value = found.get(key, 0)
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= 1_000_000:
            raise InputError(f"{where}: {key} is {value!r}, expected a whole number")
    if any(not isinstance(c, int) or isinstance(c, bool) or c < 0 for c in found.get("text", [])):
        raise InputError(f"{where}: text is {found['text']!r}, expected numbers of columns")
    for key in ("separator", "decimal"):
        if len(found.get(key, " ")) != 1:
            raise InputError(f"{where}: {key} is {found[key]!r}, expected one character")
    if found.get("unit", "degrees") not in _DEGREES:
        raise InputError(f"{where}: unit is {found['unit']!r}, expected {', '.join(_DEGREES)}")
    if "fps" in found:
        tables.number(where, "fps", found["fps"], above=0.0)
    if not isinstance(found.get("columns"), list) or not found["columns"]:
        raise InputError(f"{where}: the key 'columns' is missing: a list of column, joint, axis and factor")
    _check_entries(where, found["columns"])
    if "time" in found:
        time = found["time"]
        if not isinstance(time, Mapping) or not isinstance(time.get("column"), int):
            raise InputError(f"{where}: time is {time!r}, expected a column and a unit")
        check_keys(where, "time", time, ("column", "unit"))
        if time.get("unit", "seconds") not in _SECONDS:
            raise InputError(f"{where}: time.unit is {time['unit']!r}, expected {', '.join(_SECONDS)}")
    return found


def _check_entries(where: str, entries: list[Any]) -> None:
    for k, entry in enumerate(entries):
        key = f"columns[{k}]"
        if not isinstance(entry, Mapping):
            raise InputError(f"{where}: {key} is {entry!r}, expected column, joint, axis and factor")
        check_keys(where, key, entry, _ENTRY)
        which = [c for c in ("column", "quaternion") if c in entry]
        index = entry.get(which[0]) if len(which) == 1 else None
        if not isinstance(index, int) or isinstance(index, bool) or index < 0:
            raise InputError(f"{where}: {key} needs the number of one column or quaternion, counted from 0")
        if which == ["quaternion"] and entry.get("about") not in ("x", "y", "z"):
            raise InputError(f"{where}: {key}.about is {entry.get('about')!r}, expected x, y or z")
        shares(where, key, entry)


def raw(path: text.File, columns: Map) -> tuple[list[str], Floats]:
    """Names (column numbers) and values (T, C) of a table's columns of numbers, in the file's unit."""
    data = text.load(path)
    begin = 0
    for _ in range(columns.get("header", 0)):
        at = data.find(b"\n", begin)
        begin = len(data) if at < 0 else at + 1
    plain = data.translate(_table(columns))
    first = plain[begin:].lstrip().split(b"\n", 1)[0].split()
    if not first:
        raise InputError(f"{path}, line {text.line_of(data, begin)}: the file ends before its first row")
    lying = columns.get("lying", False)
    count = len(first) if lying else columns.get("count") or len(first)
    skipped = set(columns.get("text", []))
    numeric = [c for c in range(count) if c not in skipped]
    values = (
        _mixed(path, plain, begin, count, numeric) if skipped else scan.numbers(path, plain, begin, count)
    )
    if lying:
        values = np.ascontiguousarray(values.T)
        numeric = list(range(values.shape[1]))
        if columns.get("count") not in (None, len(numeric)):
            raise InputError(f"{path}: {len(numeric)} rows, expected {columns['count']}")
    values = values[columns.get("skip", 0) :]
    if len(values) == 0:
        raise InputError(f"{path}: the table has no rows")
    return [str(c) for c in numeric], values


def _table(columns: Map) -> bytes:
    """Byte → byte: separators and brackets become blanks, the decimal mark a point."""
    table = bytearray(range(256))
    if "separator" in columns:
        table[ord(columns["separator"]) & 255] = 32
    if columns.get("brackets", False):
        for c in b"[],":
            table[c] = 32
    if "decimal" in columns:
        table[ord(columns["decimal"]) & 255] = ord(".")
    return bytes(table)


def _mixed(path: text.File, plain: bytes, begin: int, count: int, numeric: list[int]) -> Floats:
    """The columns of numbers of a table that has columns of text as well."""
    body = plain[begin:]
    line = text.line_of(plain, begin)
    lengths = np.array([len(row.split()) for row in body.split(b"\n")])
    wrong = np.flatnonzero((lengths != count) & (lengths > 0))
    if wrong.size:
        k = int(wrong[0])
        raise InputError(f"{path}, line {line + k}: {lengths[k]} values, expected {count}")
    try:
        values = np.loadtxt(io.BytesIO(body), usecols=numeric, comments=None, ndmin=2, encoding="latin-1")
    except ValueError as error:
        raise InputError(f"{path}: {error}") from None
    bad = np.argwhere(~np.isfinite(values))
    if len(bad):
        k = int(np.flatnonzero(lengths)[bad[0][0]])
        raise InputError(f"{path}, line {line + k}: column {numeric[bad[0][1]]} is no finite number")
    return np.asarray(values, dtype=np.float64)


def read(path: text.File, columns: Map, *, fps: float | None = None) -> tuple[Floats, float]:
    """The hand's angles in a table, and frames per second.

    Returns
    -------
    degrees : (T, 48)
        Joint-major, Z X Y.
    fps : float

    Raises
    ------
    InputError
        The table is damaged or does not have a column that the map names.
    """
    where = columns[NAME]
    if fps is None and "fps" not in columns:
        raise InputError(f"{where}: the key 'fps' is missing")
    rate = float(columns["fps"]) if fps is None else fps
    names, values = raw(path, columns)
    place = {int(n): k for k, n in enumerate(names)}

    def column(index: int, key: str) -> Floats:
        if index not in place:
            raise InputError(
                f"{path}: has no column of numbers {index}, which {where} names in {key}; it has {len(names)}"
            )
        return values[:, place[index]]

    scale = _DEGREES[columns.get("unit", "degrees")]
    degrees = np.zeros((len(values), 3 * len(HAND)))
    for k, entry in enumerate(columns["columns"]):
        key = f"columns[{k}]"
        factor = tables.number(where, f"{key}.factor", entry.get("factor", 1.0))
        offset = tables.number(where, f"{key}.offset", entry.get("offset", 0.0))
        if "quaternion" in entry:
            first = 4 * entry["quaternion"]
            about = column(first + "xyz".index(entry["about"]), key)
            angle = np.degrees(2 * np.arctan2(about, column(first + 3, key)))
            x = (angle + 180) % 360 - 180 - offset
        else:
            x = (column(entry["column"], key) - offset) * scale
        degrees += (factor * x)[:, None] * shares(where, key, entry)
    if "time" in columns:
        seconds = column(columns["time"]["column"], "time") * _SECONDS[columns["time"].get("unit", "seconds")]
        seconds = seconds - seconds[0]
        _, degrees = tables.even(path, seconds, degrees, rate, 1 + columns.get("header", 0), strict=False)
    return degrees, rate
