"""Tables with a column for each field of a dataclass."""

from __future__ import annotations

import csv
import os
from dataclasses import fields
from typing import Any, TypeVar

from miburi.errors import InputError

Row = TypeVar("Row")
_TYPES: dict[str, type] = {"int": int, "float": float}


def names(kind: type[Any]) -> list[str]:
    """Columns of a dataclass."""
    return [f.name for f in fields(kind)]


def read_rows(path: str | os.PathLike[str], kind: type[Row], delimiter: str = ",") -> list[Row]:
    """Read a table of a dataclass whose fields are whole numbers, numbers and text.

    Raises
    ------
    InputError
        A column is missing, or a cell is no number; the sentence names the line.
    """
    with open(path, encoding="utf-8", newline="") as file:
        table = csv.DictReader(file, delimiter=delimiter)
        for column in names(kind):
            if column not in (table.fieldnames or []):
                raise InputError(f"{path}, line 1: the column {column!r} is missing")
        return [_row(f"{path}, line {line}", kind, row) for line, row in enumerate(table, 2)]


def _row(where: str, kind: type[Row], row: dict[str, str]) -> Row:
    types = {f.name: _TYPES.get(str(f.type), str) for f in fields(kind)}  # type: ignore[arg-type]
    try:
        return kind(**{name: of(row[name]) for name, of in types.items()})
    except (TypeError, ValueError):
        raise InputError(f"{where}: a number cannot be read") from None
