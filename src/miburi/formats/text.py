"""What all text formats need: a file's bytes, its names, and where in it something is wrong."""

from __future__ import annotations

import gzip
import io
import os
import re
import zlib
from pathlib import Path
from typing import BinaryIO

import numpy as np

from miburi.errors import InputError
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
