"""One self-contained HTML page: tables with the paper's figures beside ours, pictures, films."""

from __future__ import annotations

import base64
import csv
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import jinja2

_KINDS = {".png": "image/png", ".mp4": "video/mp4"}


@dataclass(frozen=True)
class Table:
    """A table of text; `head` rows stand on the page, the others are folded away."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    head: tuple[tuple[str, ...], ...] = ()

    @property
    def numeric(self) -> tuple[bool, ...]:
        """Whether each column holds numbers alone, which stand to the right."""
        return tuple(all(_is_number(row[k]) for row in self.rows) for k in range(len(self.columns)))


@dataclass(frozen=True)
class Picture:
    """A picture as a data URI, and what it shows in words."""

    data: str
    alt: str


@dataclass(frozen=True)
class Film:
    """A film: a data URI, or a path from the page."""

    source: str
    alt: str


@dataclass(frozen=True)
class Corpus:
    """What a corpus holds."""

    name: str
    kind: str
    simulated: bool
    takes: int
    seconds: float


@dataclass(frozen=True)
class Section:
    """A part of the page: what it shows in plain words, how to make it anew, and the things themselves."""

    name: str
    title: str
    words: str
    target: str = ""
    table: Table | None = None
    pictures: tuple[Picture, ...] = ()
    films: tuple[Film, ...] = ()


def page(sections: Sequence[Section], corpora: Sequence[Corpus]) -> str:
    """The page as text; the same sections give the same bytes.

    Parameters
    ----------
    sections
        In their order.
    corpora
        What the run was made from; the page says which of them are simulated.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("miburi.report", "."),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    simulated = [c.name for c in corpora if c.simulated]
    return (
        environment.get_template("page.html")
        .render(sections=sections, corpora=corpora, simulated=simulated)
        .rstrip("\n")
        + "\n"
    )


def read_table(path: str | os.PathLike[str], most: int | None = None, mean: str = "") -> Table:
    """A CSV as a table; rows whose column `mean` says "mean" or "all" stand on the page before the others."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = [tuple(row) for row in csv.reader(file)]
    columns, body = rows[0] if rows else (), rows[1:]
    at = columns.index(mean) if mean in columns else None
    head = tuple(r for r in body if at is not None and r[at] in ("mean", "all"))
    return Table(columns, tuple(body[:most]), head)


def embedded(path: str | os.PathLike[str]) -> str:
    """A picture or film as a data URI."""
    kind = _KINDS[Path(path).suffix]
    return f"data:{kind};base64,{base64.b64encode(Path(path).read_bytes()).decode()}"


def _is_number(text: str) -> bool:
    try:
        float(text or "0")
    except ValueError:
        return False
    return True
