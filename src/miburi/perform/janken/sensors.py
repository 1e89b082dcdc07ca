"""The glove's 22 sensors: calibration, joints, and what they measure of rock, paper and scissors.

The columns are in the order of the glove maker's kit without the absolute abduction of the index. The four
sensors of the outermost finger joints are not fitted (they give one count throughout), as on an 18-sensor
glove: the calibration lets these joints follow the middle ones. Degrees per count are those that a real
glove's recording shows (docs/janken.md).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from miburi.motion import Floats


class Sensor(NamedTuple):
    """A sensor of the glove: calibration, then the angle (degrees) it measures in rock, paper and scissors.

    `entry` is what the calibration says beside gain (degrees per count) and offset (count at 0°).
    """

    name: str
    gain: float
    offset: float
    entry: Mapping[str, Any]
    rock: float
    paper: float
    scissors: float


def _bend(joint: str, also: str = "") -> dict[str, Any]:
    entry: dict[str, Any] = {"joint": joint, "axis": "x"}
    return entry | {"also": [{"joint": also, "axis": "x", "factor": 0.62}]} if also else entry


def _spread(joints: Sequence[str], weights: Sequence[float]) -> dict[str, Any]:
    return {"joint": list(joints), "axis": "z", "weights": list(weights)}


_UNFITTED: Mapping[str, Any] = {}
SENSORS = (
    Sensor("thumb roll", -0.72, 60, {"joint": "thumb1", "axis": "y"}, -84, -22, -96),
    Sensor("thumb MCP", 0.84, 60, _bend("thumb2"), 20, 4, 48),
    Sensor("thumb IP", 0.82, 58, _bend("thumb3"), 52, -6, 56),
    Sensor("thumb-index", 0.25, 170, {"joint": "thumb1", "axis": "z"}, -8, -12, -30),
    Sensor("index MCP", 1.03, 75, _bend("index1"), 66, -10, -14),
    Sensor("index PIP", 0.95, 62, _bend("index2", "index3"), 99, 3, 8),
    Sensor("index DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor("middle MCP", 1.12, 7, _bend("middle1"), 74, -8, -6),  # its counts end at -7.8°
    Sensor("middle PIP", 0.95, 58, _bend("middle2", "middle3"), 104, 2, 6),
    Sensor("middle DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor(
        "middle-index",
        0.25,
        84,
        _spread(("middle1", "index1", "ring1", "little1"), (0.4, -0.6, 0.4, 0.4)),
        2,
        11,
        22,
    ),
    Sensor("ring MCP", 1.12, 72, _bend("ring1"), 74, -12, 58),
    Sensor("ring PIP", 1.12, 54, _bend("ring2", "ring3"), 112, 4, 100),
    Sensor("ring DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor("ring-middle", 0.31, 90, _spread(("ring1", "little1"), (1.0, 1.0)), 1, 8, 0),
    Sensor("little MCP", 0.84, 78, _bend("little1"), 66, -8, 55),
    Sensor("little PIP", 0.93, 56, _bend("little2", "little3"), 96, 4, 85),
    Sensor("little DIP", 0.0, 127, _UNFITTED, 0, 0, 0),
    Sensor("little-ring", 0.31, 88, _spread(("little1",), (1.0,)), 2, 10, 3),
    Sensor("palm arch", 0.53, 100, _UNFITTED, 16, 4, 11),
    Sensor("wrist pitch", 0.49, 110, {"joint": "wrist", "axis": "x"}, -9, 5, -3),
    Sensor("wrist yaw", 0.23, 118, {"joint": "wrist", "axis": "z"}, 2, -3, 0),
)
NAMES = tuple(f"s{k:02d}" for k in range(1, len(SENSORS) + 1))
FITTED = np.array([s.gain != 0 for s in SENSORS])
POSES: Mapping[str, Floats] = {
    "r": np.array([s.rock for s in SENSORS], dtype=np.float64),
    "p": np.array([s.paper for s in SENSORS], dtype=np.float64),
    "s": np.array([s.scissors for s in SENSORS], dtype=np.float64),
}
FINGER = np.array([0] * 4 + [1] * 3 + [2] * 4 + [3] * 4 + [4] * 4 + [5] * 3)
"""Which finger a sensor rides on: 0 thumb … 4 little, 5 palm and wrist."""
FINGERS = 6
KNUCKLE = np.array(["MCP" in s.name and "thumb" not in s.name for s in SENSORS])
MIDDLE = np.array(["PIP" in s.name for s in SENSORS])
FLEXES = np.array(["MCP" in s.name or "PIP" in s.name for s in SENSORS])


def calibration() -> dict[str, dict[str, Any]]:
    """The wearer's calibration: sensor → gain (degrees per count), offset (count), joint, axis; {}: no joint.

    Returns
    -------
    dict
        As `miburi.formats.glove` describes it under `sensors`.
    """
    return {
        name: {"gain": s.gain, "offset": s.offset, **s.entry} if s.entry else {}
        for name, s in zip(NAMES, SENSORS, strict=True)
    }
