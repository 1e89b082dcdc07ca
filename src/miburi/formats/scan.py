"""Tables of numbers in text, at native speed."""

from __future__ import annotations

from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.formats import text
from miburi.motion import Floats

# Powers of ten that a double holds exactly; a mantissa below 2^53 times or over one of them is rounded once,
# hence rightly (Clinger, "How to read floating point numbers accurately", 1990).
_TENS = np.array([10.0**k for k in range(23)])


@njit
def _scan(text, begin, columns, broken, tens, values, starts, hard):  # type: ignore[no-untyped-def]
    """Parse blank-separated numbers.

    Returns (count, hard ones, offset of the first token that is no number or stands in the wrong line, or
    −1). A row may go over several lines, but must begin a line.
    """
    n = len(text)
    i = begin
    count = 0
    doubtful = 0
    fresh = True
    while True:
        while i < n and (text[i] == 32 or text[i] == 9 or text[i] == 10):
            if text[i] == 10:
                fresh = True
            i += 1
        if i >= n:
            return count, doubtful, -1
        inside = count % columns != 0
        if count == len(values) or (not inside and not fresh) or (inside and fresh and not broken):
            return count, doubtful, i
        fresh = False
        start = i
        negative = text[i] == 45
        if negative or text[i] == 43:
            i += 1
        mantissa = np.uint64(0)
        digits = 0
        significant = 0
        exponent = 0
        while i < n and 48 <= text[i] <= 57:
            digits += 1
            if significant > 0 or text[i] != 48:
                significant += 1
            if significant <= 18:
                mantissa = mantissa * np.uint64(10) + np.uint64(text[i] - 48)
            i += 1
        if i < n and text[i] == 46:
            i += 1
            while i < n and 48 <= text[i] <= 57:
                digits += 1
                if significant > 0 or text[i] != 48:
                    significant += 1
                if significant <= 18:
                    mantissa = mantissa * np.uint64(10) + np.uint64(text[i] - 48)
                    exponent -= 1
                i += 1
        if digits == 0:
            return count, doubtful, start
        if i < n and (text[i] == 101 or text[i] == 69):
            i += 1
            down = i < n and text[i] == 45
            if i < n and (text[i] == 45 or text[i] == 43):
                i += 1
            if not (i < n and 48 <= text[i] <= 57):
                return count, doubtful, start
            power = 0
            while i < n and 48 <= text[i] <= 57:
                if power < 100000:
                    power = power * 10 + (text[i] - 48)
                i += 1
            exponent += -power if down else power
        if i < n and not (text[i] == 32 or text[i] == 9 or text[i] == 10):
            return count, doubtful, start
        if mantissa == 0 and significant == 0:
            value = 0.0
        elif significant <= 18 and mantissa <= np.uint64(9007199254740992) and -22 <= exponent <= 22:
            value = float(mantissa)
            value = value * tens[exponent] if exponent >= 0 else value / tens[-exponent]
        else:
            value = 0.0
            if doubtful < len(hard):
                hard[doubtful] = count
                starts[doubtful] = start
            doubtful += 1
        values[count] = -value if negative else value
        count += 1


def numbers(path: text.File, data: bytes, begin: int, columns: int, *, broken: bool = False) -> Floats:
    """The table of numbers that fills `data` from byte `begin` to its end.

    Numbers are rounded rightly. The memory used is in proportion to the text.

    Parameters
    ----------
    path
        Named in errors.
    columns
        Numbers in a row.
    broken
        A row may go over several lines; it begins on a line of its own all the same.

    Returns
    -------
    (rows, columns) float64

    Raises
    ------
    InputError
        Something is no finite number, or a row is too long or too short; the sentence names the line.
    """
    characters = np.frombuffer(data, dtype=np.uint8)
    values = np.empty((len(data) - begin) // 2 + 1)
    room = 4096
    starts, hard = np.empty(room, np.int64), np.empty(room, np.int64)
    count, doubtful, wrong = _scan(characters, begin, columns, broken, _TENS, values, starts, hard)
    if doubtful > room:
        starts, hard = np.empty(doubtful, np.int64), np.empty(doubtful, np.int64)
        count, doubtful, wrong = _scan(characters, begin, columns, broken, _TENS, values, starts, hard)
    if wrong >= 0 or count % columns:
        _complain(path, data, begin, columns, wrong)
    if doubtful > count // 100:  # a text of many digits: the C library rounds it faster in one go
        values = np.fromstring(data[begin:].decode("ascii"), sep=" ")
        hard = hard[:doubtful]
    elif doubtful:
        values[hard[:doubtful]] = _exactly(data, starts[:doubtful])
    if doubtful:
        bad = hard[:doubtful][~np.isfinite(values[hard[:doubtful]])]
        if len(bad):
            at = int(starts[:doubtful][hard[:doubtful] == bad[0]][0])
            raise InputError(
                f"{path}, line {text.line_of(data, at)}: {text.shown(_token(data, at))} is too large for a number"
            )
    return values[:count].reshape(-1, columns)


def _exactly(data: bytes, starts: NDArray[np.int64]) -> Floats:
    """Numbers with many digits, by the C library's own rounding."""
    tokens = np.array([_token(data, int(s)) for s in starts], dtype=np.bytes_)
    with np.errstate(over="ignore"):
        return tokens.astype(np.float64)


def _token(data: bytes, start: int) -> bytes:
    """The blank-separated piece that begins at `start`."""
    return data[start : start + 1000].split(None, 1)[0]


def _complain(path: text.File, data: bytes, begin: int, columns: int, wrong: int) -> NoReturn:
    """Say which line is wrong: a token that is no number, else the first row of another length."""
    number = text.line_of(data, begin)
    for line in data[begin:].split(b"\n"):
        tokens = line.split()
        for token in tokens:
            if text.real(token) is None:
                raise InputError(f"{path}, line {number}: {text.shown(token)} is not a finite number")
        if tokens and len(tokens) != columns:
            s = "" if len(tokens) == 1 else "s"
            raise InputError(f"{path}, line {number}: {len(tokens)} value{s}, expected {columns}")
        number += 1
    raise InputError(f"{path}, line {text.line_of(data, max(wrong, 0))}: expected rows of {columns} numbers")
