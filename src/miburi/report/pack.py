"""Numbers as text in a page: motions as int16 differences, gzip and base64, which the browser takes apart again."""

from __future__ import annotations

import base64
import gzip
import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from miburi.errors import InputError
from miburi.kinematics import resample
from miburi.motion import Motion
from miburi.render import figure

UNITS = {"hand": 0.0004, "body": 0.002}
"""Metres that one step of the packed numbers stands for."""

_HEAD = 0.052
"""Radius of a head, metres."""


def squeezed(data: bytes) -> str:
    """Bytes as gzip in base64; the same bytes give the same text."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def packed_json(value: Any) -> str:
    """A structure as compact JSON in gzip and base64."""
    return squeezed(json.dumps(value, separators=(",", ":"), ensure_ascii=False, sort_keys=True).encode())


def packed(values: ArrayLike, unit: float) -> str:
    """Columns of numbers that change slowly from row to row.

    Parameters
    ----------
    values : (T, C)
        Finite numbers.
    unit
        What one step stands for; values are rounded to it.

    Returns
    -------
    str
        Base64 of gzip of: column after column the differences from row to row (the first from zero) in steps,
        modulo 2¹⁶, zigzag-coded (0, −1, 1, −2 … → 0, 1, 2, 3 …); the low bytes of all, then the high bytes.

    Raises
    ------
    InputError
        A value does not fit into 16 bits.
    """
    steps = np.rint(np.asarray(values, dtype=np.float64) / unit)
    if not np.isfinite(steps).all() or np.abs(steps).max(initial=0.0) > 32767:
        raise InputError(f"numbers beyond ±{32767 * unit:g} do not fit into a page's 16 bits")
    columns = steps.astype(np.int64).T
    change = np.diff(columns, axis=1, prepend=0).astype(np.int16).astype(np.int32)
    code = ((change << 1) ^ (change >> 15)).astype(np.uint16).ravel()
    return squeezed((code & 255).astype(np.uint8).tobytes() + (code >> 8).astype(np.uint8).tobytes())


@dataclass
class Clips:
    """Motions of a page, each once: what the page knows of them at once, and their packed numbers.

    Parameters
    ----------
    fps
        At most so many frames a second are packed; the browser interpolates between them.
    room
        Characters of packed numbers that may still be added.
    """

    fps: float = 30.0
    room: int = 2_600_000
    skeletons: list[dict[str, Any]] = field(default_factory=list)
    about: dict[str, dict[str, Any]] = field(default_factory=dict)
    data: dict[str, str] = field(default_factory=dict)

    def add(self, name: str, motion: Motion, floor: float | None = None) -> bool:
        """Pack a motion under a name; False if there is no room for it.

        Parameters
        ----------
        floor
            Height of the ground, metres; absent: below all but the lowest frames of this motion.
        """
        if name in self.data:
            return True
        hand = figure.is_hand(motion.skeleton)
        unit = UNITS["hand" if hand else "body"]
        rate = motion.fps if hand else min(motion.fps, self.fps)
        shown = figure.group([resample(motion, rate)])
        points = shown.points - shown.points.mean(axis=(0, 1)) * (0.0 if hand else np.array([1.0, 0.0, 1.0]))
        text = packed(points.reshape(len(points), -1), unit)
        if len(text) > self.room:
            return False
        self.room -= len(text)
        self.data[name] = text
        self.about[name] = {
            "skeleton": self._skeleton(motion, shown, hand),
            "frames": len(points),
            "fps": round(rate, 4),
            "unit": unit,
            "floor": round(shown.floor if floor is None else floor, 4),
            "front": round(float(np.arctan2(shown.view[0], shown.view[2])), 3),
        }
        return True

    def _skeleton(self, motion: Motion, shown: figure.Group, hand: bool) -> int:
        limbs = figure.limbs(motion.skeleton)
        one = {
            "kind": "hand" if hand else "body",
            "points": shown.points.shape[1],
            "bones": shown.bones.tolist(),
            "radii": [round(r, 4) for r in self._radii(motion, shown, hand, limbs)],
            "limbs": [limbs[b] for b in shown.bones[:, 1]],
        }
        if one not in self.skeletons:
            self.skeletons.append(one)
        return self.skeletons.index(one)

    @staticmethod
    def _radii(motion: Motion, shown: figure.Group, hand: bool, limbs: list[int]) -> list[float]:
        """Of the bones; the head is thicker than what carries it."""
        joints = len(motion.skeleton)
        head = [not hand and b >= joints and limbs[b] == 0 for b in shown.bones[:, 1]]
        return [_HEAD if h else float(r) for h, r in zip(head, shown.bone_radii, strict=True)]

    def seconds(self, name: str) -> float:
        """How long a packed motion lasts."""
        return float(self.about[name]["frames"] / self.about[name]["fps"])
