"""Annotations: a tab-separated table of what happens when, `take, start_s, end_s, keyword` and any more
columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from miburi import store
from miburi.errors import InputError
from miburi.formats import text

COLUMNS = ("take", "start_s", "end_s", "keyword")


class Annotation(NamedTuple):
    """A piece of a take that has a keyword, seconds; `more` holds further columns as they were written."""

    take: str
    start_s: float
    end_s: float
    keyword: str
    more: Mapping[str, str] = {}


def read_annotations(path: text.File) -> list[Annotation]:
    """Read annotations, plain or gzipped, in the order of the file.

    Raises
    ------
    InputError
        A column is missing, or a row has a time that cannot be; the sentence names the line.
    """
    lines = text.decode(text.load(path)).split("\n")
    header = [c.strip() for c in lines[0].split("\t")]
    for column in COLUMNS:
        if column not in header:
            raise InputError(
                f"{path}, line 1: the column {column!r} is missing; there are {', '.join(header)}"
            )
    if len(set(header)) != len(header):
        twice = next(c for c in header if header.count(c) > 1)
        raise InputError(f"{path}, line 1: the column {twice!r} stands twice")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if not line.strip():
            continue
        cells = [c.strip() for c in line.split("\t")]
        if len(cells) > len(header):
            raise InputError(f"{path}, line {number}: {len(cells)} columns, expected {len(header)}")
        row = dict(zip(header, cells + [""] * (len(header) - len(cells)), strict=True))
        rows.append(_annotation(f"{path}, line {number}", row))
    return rows


def _annotation(where: str, row: dict[str, str]) -> Annotation:
    times = []
    for column in ("start_s", "end_s"):
        try:
            value = float(row[column])
        except ValueError:
            value = float("nan")
        if not np.isfinite(value) or value < 0:
            raise InputError(f"{where}: {column} is {text.shown(row[column])}, expected seconds from 0 on")
        times.append(value)
    start, end = times
    if end <= start:
        raise InputError(f"{where}: the end {end:g} s is not after the start {start:g} s")
    for column in ("take", "keyword"):
        if not row[column]:
            raise InputError(f"{where}: the {column} is empty")
    more = {k: v for k, v in row.items() if k not in COLUMNS}
    return Annotation(row["take"], start, end, row["keyword"], more)


def write_annotations(path: text.File, rows: Sequence[Annotation]) -> None:
    """Write annotations, in the order given; times with as many digits as they have, at most 6."""
    extra = list(dict.fromkeys(k for r in rows for k in r.more))
    lines = ["\t".join([*COLUMNS, *extra])]
    for number, r in enumerate(rows, 2):
        cells = [
            r.take,
            _seconds(r.start_s),
            _seconds(r.end_s),
            r.keyword,
            *(r.more.get(k, "") for k in extra),
        ]
        if any(c in cell for cell in cells for c in "\t\n\r"):
            raise InputError(f"{path}, line {number}: a tab or a line's end cannot stand in a cell")
        row = dict(zip([*COLUMNS, *extra], cells, strict=True))
        _annotation(f"{path}, line {number}", row)
        lines.append("\t".join(cells))
    store.write_text(path, "\n".join(lines) + "\n")


def _seconds(value: float) -> str:
    return f"{value:.6f}".rstrip("0").rstrip(".") or "0"
