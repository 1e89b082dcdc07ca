"""Tables of numbers as text with six decimals, at native speed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.motion import Floats

_MOST = 1e9  # beyond it, whole millionths and their digits do not fit


@njit
def _fill(table, out):  # type: ignore[no-untyped-def]
    at = 0
    rows, columns = table.shape
    for t in range(rows):
        for c in range(columns):
            value = np.int64(np.rint(table[t, c] * 1e6))
            if value < 0:
                out[at] = 45
                at += 1
                value = -value
            whole, part = value // 1000000, value % 1000000
            width, rest = 1, whole // 10
            while rest > 0:
                width += 1
                rest //= 10
            for k in range(width - 1, -1, -1):
                out[at + k] = 48 + whole % 10
                whole //= 10
            at += width
            out[at] = 46
            for k in range(6, 0, -1):
                out[at + k] = 48 + part % 10
                part //= 10
            at += 7
            out[at] = 32 if c < columns - 1 else 10
            at += 1
    return at


def six(table: Floats) -> bytes:
    """Rows of a table (T, C) as lines of numbers with six decimals, as `%.6f` writes them, but never −0.

    A number half-way between two decimals may be rounded to the other side.
    """
    largest = float(np.abs(table).max(initial=0.0))
    if not largest < _MOST:
        row = " ".join(["%.6f"] * table.shape[1]) + "\n"
        return "".join(row % tuple(frame) for frame in (np.round(table, 6) + 0.0).tolist()).encode()
    out: NDArray[np.uint8] = np.empty(table.size * (len(str(int(largest))) + 9), np.uint8)
    return out[: _fill(np.ascontiguousarray(table), out)].tobytes()
