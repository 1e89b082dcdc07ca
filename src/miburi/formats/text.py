"""What all text formats need: a file's bytes, its numbers at native speed, and where in it something is
wrong."""

from __future__ import annotations

import gzip
import io
import os
import re
import zlib
from pathlib import Path
from typing import BinaryIO, NoReturn

import numpy as np
from numpy.typing import NDArray

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.motion import Floats
from miburi.paths import stem as stem
from miburi.paths import suffix as suffix

File = str | os.PathLike[str]

LARGEST = 1 << 31
"""Bytes of text that a recording may have once unpacked (a day of motion has less)."""


def load(path: File) -> bytes:
    """The text of a file, unpacked if it is gzipped (told by its content), lines ended by a newline.

    Raises
    ------
    InputError
        There is no such file, it cannot be read, its gzip is damaged, or it is larger than 2 GiB.
    """
    where = Path(path)
    try:
        with open(where, "rb") as file:
            data = _bounded(where, file)
    except FileNotFoundError:
        raise InputError(f"{where}: there is no such file") from None
    except IsADirectoryError:
        raise InputError(f"{where}: is a folder, expected a file") from None
    except OSError as error:
        raise InputError(f"{where}: cannot be read ({error.strerror})") from None
    if data[:2] == b"\x1f\x8b":
        try:
            with gzip.open(io.BytesIO(data)) as packed:
                data = _bounded(where, packed)
        except (OSError, EOFError, zlib.error) as error:
            raise InputError(f"{where}: its gzip is damaged ({error})") from None
    elif where.suffix.lower() == ".gz":
        raise InputError(f"{where}: ends in .gz but is not gzipped")
    if data[:3] == b"\xef\xbb\xbf":
        data = data[3:]
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n")
        data = data.replace(b"\r", b"\n")
    return data


def _bounded(where: Path, file: BinaryIO | gzip.GzipFile) -> bytes:
    """All of a file, piece by piece, as far as it is not too large."""
    pieces, size = [], 0
    while piece := file.read(1 << 24):
        pieces.append(piece)
        size += len(piece)
        if size > LARGEST:
            raise InputError(f"{where}: has more than {LARGEST >> 30} GiB of text")
    return b"".join(pieces)


def decode(data: bytes) -> str:
    """Text of names: UTF-8, or Latin-1 where the bytes are not UTF-8."""
    try:
        return data.decode()
    except UnicodeDecodeError:
        return data.decode("latin-1")


def line_of(data: bytes, offset: int) -> int:
    """Number, from 1, of the line that holds the byte at `offset`."""
    return data.count(b"\n", 0, offset) + 1


def shown(token: str | bytes, most: int = 40) -> str:
    """A piece of a file as a message shows it."""
    text = token if isinstance(token, str) else decode(token)
    return repr(text if len(text) <= most else text[: most - 1] + "…")


_REAL = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


def real(token: str | bytes) -> float | None:
    """A finite number as recordings write it; None for anything else (nan, inf, 1_000, 0x10, 1,5 …)."""
    written = token if isinstance(token, str) else token.decode("latin-1")
    value = float(written) if _REAL.fullmatch(written) else np.inf
    return value if np.isfinite(value) else None


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


def numbers(path: File, data: bytes, begin: int, columns: int, *, broken: bool = False) -> Floats:
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
    text = np.frombuffer(data, dtype=np.uint8)
    values = np.empty((len(data) - begin) // 2 + 1)
    room = 4096
    starts, hard = np.empty(room, np.int64), np.empty(room, np.int64)
    count, doubtful, wrong = _scan(text, begin, columns, broken, _TENS, values, starts, hard)
    if doubtful > room:
        starts, hard = np.empty(doubtful, np.int64), np.empty(doubtful, np.int64)
        count, doubtful, wrong = _scan(text, begin, columns, broken, _TENS, values, starts, hard)
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
                f"{path}, line {line_of(data, at)}: {shown(_token(data, at))} is too large for a number"
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


def _complain(path: File, data: bytes, begin: int, columns: int, wrong: int) -> NoReturn:
    """Say which line is wrong: a token that is no number, else the first row of another length."""
    number = line_of(data, begin)
    for line in data[begin:].split(b"\n"):
        tokens = line.split()
        for token in tokens:
            if real(token) is None:
                raise InputError(f"{path}, line {number}: {shown(token)} is not a finite number")
        if tokens and len(tokens) != columns:
            s = "" if len(tokens) == 1 else "s"
            raise InputError(f"{path}, line {number}: {len(tokens)} value{s}, expected {columns}")
        number += 1
    raise InputError(f"{path}, line {line_of(data, max(wrong, 0))}: expected rows of {columns} numbers")
