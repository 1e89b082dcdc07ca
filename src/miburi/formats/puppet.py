"""Logs of the sensor puppet ([P]): 17 angles in degrees against time, or raw counts with a calibration.

First line `# miburi puppet log 1, fps=60`, then a header and rows of comma-separated numbers:
`time_s,l_shoulder_z,…,imu_roll`. Raw counts of the potentiometers stand in columns `…_adc` instead
(`l_elbow_x_adc`) and are turned into degrees, gain · (count − offset), by a calibration file

    # miburi puppet calibration 1
    sensors:
      l_elbow_x: {gain: 0.2933, offset: 102}

Axes: x to the puppet's left, y up, z forward. At zero all limbs hang straight down. Signs are anatomical and
the same for both sides (abduction, flexion and outward rotation are positive): with s = +1 on the left and
−1 on the right, upper arm Rz(s z) Rx(−x) Ry(s y), forearm Rx(−x), thigh Rz(s z) Rx(−x), shank Rx(x), trunk
Ry(yaw) Rx(pitch) Rz(roll).
"""

from __future__ import annotations

import re
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from miburi import store
from miburi.errors import InputError
from miburi.figures import PERSON
from miburi.formats import angles, tables, text
from miburi.motion import Floats, Motion

COLUMNS = (
    *(f"{s}_shoulder_{a}" for s in "lr" for a in "zxy"),
    "l_elbow_x",
    "r_elbow_x",
    *(f"{s}_hip_{a}" for s in "lr" for a in "zx"),
    "l_knee_x",
    "r_knee_x",
    "imu_yaw",
    "imu_pitch",
    "imu_roll",
)
"""The 17 angles in the order of a log."""

SIGNATURE = "miburi puppet log 1"

# joint -> (axis, column, sign) from left to right in its rotation
_TURNS: dict[str, list[tuple[str, str, int]]] = {
    "waist": [("y", "imu_yaw", 1), ("x", "imu_pitch", 1), ("z", "imu_roll", 1)],
}
for _s, _sign in (("l", 1), ("r", -1)):
    _TURNS[f"{_s}_shoulder"] = [
        ("z", f"{_s}_shoulder_z", _sign),
        ("x", f"{_s}_shoulder_x", -1),
        ("y", f"{_s}_shoulder_y", _sign),
    ]
    _TURNS[f"{_s}_elbow"] = [("x", f"{_s}_elbow_x", -1)]
    _TURNS[f"{_s}_hip"] = [("z", f"{_s}_hip_z", _sign), ("x", f"{_s}_hip_x", -1)]
    _TURNS[f"{_s}_knee"] = [("x", f"{_s}_knee_x", 1)]


def read(path: text.File, *, fps: float | None = None, calibration: text.File | None = None) -> Motion:
    """Read a puppet log.

    Where the clock is uneven (a step differs from 1 / fps by more than 2 %), the angles are interpolated
    linearly at 1 / fps; otherwise rows are frames.

    Parameters
    ----------
    fps
        Frames per second of the clock, instead of the first line's.
    calibration
        Of raw counts; absent: the only .yaml beside the log.

    Returns
    -------
    Motion
        Of `figures.PERSON`, standing at the origin, turned by the IMU.

    Raises
    ------
    InputError
        The log is damaged; the sentence names the line or the column.
    """
    data = text.load(path)
    info = tables.signature(path, data, SIGNATURE)
    rate = tables.rate(path, info, fps)
    columns = tables.header(path, data)
    _check_columns(path, columns)
    time, degrees = _degrees(path, columns, tables.read(path, data)[1], calibration)
    first = text.line_of(data, tables.start(data))
    degrees[:, 14] = np.degrees(np.unwrap(np.radians(degrees[:, 14])))
    degrees[:, 16] = np.degrees(np.unwrap(np.radians(degrees[:, 16])))
    _, degrees = tables.even(path, time, degrees, rate, first)
    return motion(degrees, rate, name=text.stem(path))


def _degrees(
    path: text.File, columns: list[str], values: Floats, calibration: text.File | None
) -> tuple[Floats, Floats]:
    """Time and the 17 angles of a table."""
    raw = [c for c in COLUMNS if f"{c}_adc" in columns]
    gains = _calibration(path, calibration, raw) if raw else {}
    out = np.empty((len(values), len(COLUMNS)))
    for k, name in enumerate(COLUMNS):
        if name in gains:
            gain, offset = gains[name]
            out[:, k] = gain * (values[:, columns.index(f"{name}_adc")] - offset)
        else:
            out[:, k] = values[:, columns.index(name)]
    return values[:, columns.index("time_s")], out


def _check_columns(path: text.File, columns: list[str]) -> None:
    known = {"time_s", *COLUMNS, *(f"{c}_adc" for c in COLUMNS)}
    if extra := [c for c in columns if c not in known]:
        raise InputError(f"{path}, line 2: there is no column {extra[0]!r} in a puppet log")
    if "time_s" not in columns:
        raise InputError(f"{path}, line 2: the column 'time_s' is missing")
    for name in COLUMNS:
        found = (name in columns) + (f"{name}_adc" in columns)
        if found == 2:
            raise InputError(f"{path}, line 2: the columns {name!r} and '{name}_adc' are both there")
        if found == 0:
            raise InputError(f"{path}, line 2: the column {name!r} is missing")


def _calibration(
    path: text.File, calibration: text.File | None, raw: list[str]
) -> Mapping[str, tuple[float, float]]:
    """Gain and offset of each raw column."""
    where = calibration or tables.only_yaml(path)
    document = tables.load_yaml(where)
    sensors = document.get("sensors")
    if not isinstance(sensors, Mapping):
        raise InputError(f"{where}: the key 'sensors' is missing")
    found = {}
    for name in raw:
        entry = sensors.get(name)
        if not isinstance(entry, Mapping):
            raise InputError(f"{where}: the key 'sensors.{name}' is missing, which {path} needs")
        found[name] = (
            tables.number(where, f"sensors.{name}.gain", entry.get("gain")),
            tables.number(where, f"sensors.{name}.offset", entry.get("offset")),
        )
    return found


def motion(degrees: ArrayLike, fps: float, name: str = "") -> Motion:
    """The person that 17 angles describe.

    Parameters
    ----------
    degrees : (T, 17)
        In the order of `COLUMNS`.

    Returns
    -------
    Motion
        Of `figures.PERSON`, at the origin.
    """
    values = np.asarray(degrees, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] != len(COLUMNS):
        raise InputError(f"puppet angles of shape {values.shape}, expected (T, {len(COLUMNS)})")
    n = len(PERSON)
    columns = np.full((n, 3), -1, dtype=np.int64)
    axes = np.zeros((n, 3), dtype=np.int64)
    signed = values.copy()
    for joint, turns in _TURNS.items():
        j = PERSON.index(joint)
        for k, (axis, column, sign) in enumerate(turns):
            columns[j, k] = COLUMNS.index(column)
            axes[j, k] = "xyz".index(axis)
            signed[:, columns[j, k]] = sign * values[:, columns[j, k]]
    return Motion(PERSON, fps, np.zeros((len(values), 3)), angles.rotations(signed, columns, axes), name=name)


def write_log(
    path: text.File,
    degrees: ArrayLike,
    fps: float,
    *,
    simulated: bool = False,
    time: ArrayLike | None = None,
    **more: object,
) -> None:
    """Write a puppet log.

    Parameters
    ----------
    degrees : (T, 17)
        In the order of `COLUMNS`; written with two decimals.
    simulated
        Nobody held a puppet: the first line says `simulated=1`.
    time : (T,), optional
        Seconds of each row; absent: row / fps.
    **more
        Further `key=value` pairs of the first line, such as `user="t03"`.
    """
    values = np.asarray(degrees, dtype=np.float64)
    if values.ndim != 2 or values.shape[1] != len(COLUMNS) or not np.isfinite(values).all():
        raise InputError(
            f"{path}: puppet angles of shape {values.shape}, expected finite (T, {len(COLUMNS)})"
        )
    seconds = np.arange(len(values)) / fps if time is None else np.asarray(time, dtype=np.float64)
    if seconds.shape != (len(values),) or (np.diff(seconds) <= 0).any():
        raise InputError(f"{path}: the times of a puppet log must be one a row and increase")
    head = tables.first_line(SIGNATURE, {"fps": fps} | ({"simulated": 1} if simulated else {}) | more)
    row = "%.4f" + ",%.2f" * len(COLUMNS)
    table = np.column_stack([seconds, values]).tolist()
    rows = [re.sub(r"-(0\.0+)\b", r"\1", row % tuple(r)) for r in table]
    store.write_text(path, "\n".join([head, ",".join(["time_s", *COLUMNS]), *rows]) + "\n")


def is_simulated(path: text.File) -> bool:
    """Whether a log's first line says that nobody held a puppet."""
    return tables.signature(path, text.load(path), SIGNATURE).get("simulated") == "1"
