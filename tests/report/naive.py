"""What the page's Python does, written out."""

from __future__ import annotations

import base64
import gzip

import numpy as np

from miburi.figures import BODY_JOINTS


def unpacked_naive(text: str, rows: int) -> list[list[int]]:
    """Steps, row after row, of packed numbers."""
    data = gzip.decompress(base64.b64decode(text))
    count = len(data) // 2
    columns = []
    for c in range(count // rows):
        value, column = 0, []
        for k in range(c * rows, (c + 1) * rows):
            code = data[k] + 256 * data[count + k]
            value += code // 2 if code % 2 == 0 else -(code + 1) // 2
            value = (value + 32768) % 65536 - 32768
            column.append(value)
        columns.append(column)
    return [[column[r] for column in columns] for r in range(rows)]


def contributions_naive(query: np.ndarray, frames: np.ndarray, dims: int) -> list[float]:
    """Shares of trunk, left arm, right arm, left leg, right leg, frame by frame and value by value."""
    limb = {"shoulder": "arm", "elbow": "arm", "hand": "arm", "hip": "leg", "knee": "leg", "foot": "leg"}
    parts = ["trunk", "l arm", "r arm", "l leg", "r leg"]
    sums = dict.fromkeys(parts, 0.0)
    for x, model in ((query, frames), (frames, query)):
        mean = model.mean(axis=0)
        _, _, directions = np.linalg.svd(model - mean, full_matrices=False)
        for frame in x:
            rest = frame - mean
            for direction in directions[:dims]:
                rest = rest - (direction @ (frame - mean)) * direction
            for k, value in enumerate(rest):
                joint = BODY_JOINTS[k // 3] if k < 3 * len(BODY_JOINTS) else "waist"
                side, _, part = joint.partition("_")
                sums[f"{side} {limb[part]}" if part else "trunk"] += value**2 / len(x)
    total = sum(sums.values())
    return [sums[p] / total for p in parts]
