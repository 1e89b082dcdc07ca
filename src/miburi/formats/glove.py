"""Glove logs: raw counts with a calibration, or another logger's table with a column map.

*Log.* First line `# miburi glove log 1, fps=30, sensors=22` (12-bit gloves add `max=4095`), header
`frame,s01,…,s22`, rows of raw counts from 0 to 255 (to `max`).

*Calibration.* YAML; a sensor's degrees are gain · (count − offset):

    # miburi glove calibration 1
    sensors:
      s05: {gain: 0.71, offset: 96, joint: index1, axis: x}
      s06: {gain: 0.69, offset: 101, joint: index2, axis: x, also: [{joint: index3, axis: x, factor: 0.7}]}
      s12: {gain: 0.2, offset: 80, joint: [middle1, index1], axis: z}
      s21: {}

`axis` is z, x or y of the joint (`figures.HAND`: flexion +x, a right hand's fingers spread towards the
little finger about +z). A sensor that couples two joints lists both: half of its angle goes to the first and
half, with the other sign, to the second; `weights: [0.7, -0.3]` says it otherwise. `also` gives shares to
joints that have no sensor of their own. What several sensors say of one angle is added. `{}` marks a sensor
that belongs to no joint.

*Column map.* See `miburi.formats.columns`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi import store
from miburi.errors import InputError
from miburi.figures import HAND
from miburi.formats import columns as maps
from miburi.formats import tables, text
from miburi.kinematics import hand_rotations
from miburi.motion import Floats, Motion

SIGNATURE = "miburi glove log 1"


@dataclass(frozen=True)
class Calibration:
    """How counts become angles: degrees (T, 48) = ((counts − offsets) · gains) @ weights.

    Parameters
    ----------
    sensors
        S names.
    gains : (S,)
        Degrees per count.
    offsets : (S,)
        Counts at 0°.
    weights : (S, 48)
        Share of each sensor in each angle, joint-major, Z X Y.
    """

    sensors: tuple[str, ...]
    gains: Floats
    offsets: Floats
    weights: Floats


class Sensor(NamedTuple):
    """What a sensor of a log looks like.

    `saturated` is the share of frames at 0 or at the highest count (in a foreign table, whose range is not
    known: at the lowest or highest value that it reaches); `dead` says that it never changes.
    """

    name: str
    dead: bool
    saturated: float
    lowest: float
    highest: float
    distinct: int


def read(path: text.File, *, fps: float | None = None, calibration: text.File | None = None) -> Motion:
    """Read a glove log.

    Parameters
    ----------
    fps
        Frames per second, instead of the first line's.
    calibration
        Path of the wearer's calibration; absent: the only .yaml beside the log.

    Returns
    -------
    Motion
        Of `figures.HAND`, at the origin, with `angles`.

    Raises
    ------
    InputError
        The log or its calibration is damaged; the sentence names line, column or key.
    """
    rate, sensors, counts, _ = read_counts(path)
    where = calibration or tables.only_yaml(path)
    by = read_calibration(where)
    if missing := [s for s in by.sensors if s not in sensors]:
        raise InputError(f"{path}, line 2: the column {missing[0]!r} is missing, which {where} calibrates")
    if unknown := [s for s in sensors if s not in by.sensors]:
        raise InputError(f"{where}: the key 'sensors.{unknown[0]}' is missing, which {path} has")
    ordered = counts[:, [sensors.index(s) for s in by.sensors]]
    return motion(
        ((ordered - by.offsets) * by.gains) @ by.weights, rate if fps is None else fps, text.stem(path)
    )


def motion(degrees: ArrayLike, fps: float, name: str = "") -> Motion:
    """The hand that angles describe.

    Parameters
    ----------
    degrees : (T, 48)
        Joint-major, Z X Y.
    """
    values = np.asarray(degrees, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] != 3 * len(HAND):
        raise InputError(f"hand angles of shape {values.shape}, expected (T, {3 * len(HAND)})")
    return Motion(HAND, fps, np.zeros((len(values), 3)), hand_rotations(values), angles=values, name=name)


def read_counts(path: text.File) -> tuple[float, list[str], Floats, int]:
    """A glove log as it is: frames per second, names of the sensors, counts (T, S) and the highest count.

    Raises
    ------
    InputError
        A column is missing, a value is no count, or a frame is; the sentence names line and column.
    """
    data = text.load(path)
    keys = tables.signature(path, data, SIGNATURE)
    rate = tables.rate(path, keys, None)
    maximum = int(tables.number(path, "max in line 1", keys.get("max", "255"), above=0.0))
    names = tables.header(path, data)
    if names[0] != "frame":
        raise InputError(f"{path}, line 2: the first column is {names[0]!r}, expected 'frame'")
    sensors = names[1:]
    expected = keys.get("sensors", str(len(sensors)))
    if expected != str(len(sensors)) or not sensors:
        raise InputError(f"{path}, line 2: {len(sensors)} columns of sensors, line 1 says {expected}")
    _, values = tables.read(path, data)
    first = text.line_of(data, tables.start(data))
    _check_frames(path, values[:, 0], first)
    _check_counts(path, sensors, values[:, 1:], maximum, first)
    return rate, sensors, values[:, 1:], maximum


def _check_frames(path: text.File, frames: Floats, first: int) -> None:
    wrong = np.flatnonzero(np.diff(frames) != 1)
    if wrong.size:
        k = int(wrong[0])
        raise InputError(f"{path}, line {first + k + 1}: frame {frames[k + 1]:g} follows frame {frames[k]:g}")


def _check_counts(path: text.File, sensors: list[str], counts: Floats, maximum: int, first: int) -> None:
    wrong = np.argwhere((counts < 0) | (counts > maximum) | (counts != np.floor(counts)))
    if len(wrong):
        k, s = wrong[0]
        raise InputError(
            f"{path}, line {first + k}: column {sensors[s]!r} is {counts[k, s]:g}, expected a whole "
            f"count from 0 to {maximum}"
        )


def read_calibration(path: text.File) -> Calibration:
    """Read a wearer's calibration.

    Raises
    ------
    InputError
        A key is missing, unknown or no number; the sentence names it.
    """
    document = tables.load_yaml(path)
    entries = document.get("sensors")
    if not isinstance(entries, Mapping) or not entries:
        raise InputError(f"{path}: the key 'sensors' is missing: sensor → gain, offset, joint, axis")
    gains, offsets, weights = [], [], []
    for name, entry in entries.items():
        key = f"sensors.{name}"
        if not isinstance(entry, Mapping):
            raise InputError(
                f"{path}: {key} is {text.shown(str(entry))}, expected gain, offset, joint and axis"
            )
        maps.check_keys(path, key, entry, ("gain", "offset", "joint", "axis", "weights", "also"))
        used = bool(entry)
        gains.append(tables.number(path, f"{key}.gain", entry.get("gain")) if used else 0.0)
        offsets.append(tables.number(path, f"{key}.offset", entry.get("offset")) if used else 0.0)
        weights.append(maps.shares(path, key, entry))
    return Calibration(tuple(str(n) for n in entries), np.array(gains), np.array(offsets), np.array(weights))


def write_log(
    path: text.File,
    counts: ArrayLike,
    fps: float,
    *,
    maximum: int = 255,
    sensors: Sequence[str] | None = None,
    simulated: bool = False,
    **more: object,
) -> None:
    """Write a glove log.

    Parameters
    ----------
    counts : (T, S)
        Whole numbers from 0 to `maximum`.
    sensors
        Names; absent: s01, s02, …
    simulated
        Nobody wore a glove: the first line says `simulated=1`.
    **more
        Further `key=value` pairs of the first line.
    """
    values: NDArray[np.float64] = np.asarray(counts, dtype=np.float64)
    if values.ndim != 2 or not values.size:
        raise InputError(f"{path}: counts of shape {values.shape}, expected (T, S)")
    names = [f"s{k:02d}" for k in range(1, values.shape[1] + 1)] if sensors is None else list(sensors)
    if len(names) != values.shape[1]:
        raise InputError(f"{path}: {len(names)} names for {values.shape[1]} sensors")
    _check_counts(path, names, values, maximum, 3)
    keys: dict[str, object] = {"fps": fps, "sensors": len(names)}
    if maximum != 255:
        keys["max"] = maximum
    head = tables.first_line(SIGNATURE, keys | ({"simulated": 1} if simulated else {}) | more)
    table = np.column_stack([np.arange(len(values)), values]).astype(np.int64).tolist()
    rows = [",".join(map(str, row)) for row in table]
    store.write_text(path, "\n".join([head, ",".join(["frame", *names]), *rows]) + "\n")


def sensor_report(path: text.File, columns: text.File | Mapping[str, Any] | None = None) -> list[Sensor]:
    """Which sensors of a log are dead or saturated.

    Parameters
    ----------
    columns
        Column map of another logger's table; absent: the file is a miburi glove log.

    Returns
    -------
    list of Sensor
        In the order of the columns.
    """
    if columns is None:
        _, names, values, maximum = read_counts(path)
        low, high = np.zeros(len(names)), np.full(len(names), float(maximum))
    else:
        names, values = maps.raw(path, maps.load(columns))
        low, high = values.min(axis=0), values.max(axis=0)
    report = []
    for k, name in enumerate(names):
        x = values[:, k]
        dead = bool(len(x) > 1 and x.min() == x.max())
        at_end = float(np.mean((x == low[k]) | (x == high[k])))
        report.append(Sensor(name, dead, at_end, float(x.min()), float(x.max()), len(np.unique(x))))
    return report


def read_columns(
    path: text.File, columns: text.File | Mapping[str, Any], *, fps: float | None = None
) -> Motion:
    """Read another logger's table by a column map (`miburi.formats.columns`).

    Returns
    -------
    Motion
        Of `figures.HAND`, at the origin, with `angles`.
    """
    degrees, rate = maps.read(path, maps.load(columns), fps=fps)
    return motion(degrees, rate, text.stem(path))
