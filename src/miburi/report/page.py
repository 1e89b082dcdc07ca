"""Self-contained HTML: text is escaped, style, script and motions lie in the page itself."""

from __future__ import annotations

import base64
import csv
import io
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup
from PIL import Image

from miburi.report.pack import Clips

_KINDS = {".png": "image/png", ".webp": "image/webp", ".mp4": "video/mp4"}


@dataclass(frozen=True)
class Table:
    """A table of text; `head` rows stand on the page, the others are folded away."""

    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    head: tuple[tuple[str, ...], ...] = ()

    @cached_property
    def numeric(self) -> tuple[bool, ...]:
        """Whether each column holds numbers alone, which stand to the right."""
        return tuple(all(_is_number(row[k]) for row in self.rows) for k in range(len(self.columns)))

    @cached_property
    def key(self) -> int:
        """The column that says what a row is about, the first of words: it stays in view on a phone."""
        return self.numeric.index(False) if False in self.numeric else 0

    def records(self) -> list[dict[str, str]]:
        """Rows by the names of columns."""
        return [dict(zip(self.columns, row, strict=True)) for row in self.rows]


def read_table(path: str | os.PathLike[str], most: int | None = None, mean: str = "") -> Table:
    """A CSV as a table; rows whose column `mean` says "mean" or "all" stand on the page before the others."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = [tuple(row) for row in csv.reader(file)]
    columns, body = rows[0] if rows else (), rows[1:]
    at = columns.index(mean) if mean in columns else None
    head = tuple(r for r in body if at is not None and r[at] in ("mean", "all"))
    return Table(columns, tuple(body[:most]), head)


def embedded(path: str | os.PathLike[str]) -> str:
    """A picture or film as a data URI; a PNG becomes a WebP, which takes a fraction of it."""
    where, data = Path(path), Path(path).read_bytes()
    kind = _KINDS[where.suffix]
    if where.suffix == ".png":
        buffer = io.BytesIO()
        Image.open(where).convert("RGB").save(buffer, "WEBP", quality=82, method=4)
        if len(buffer.getvalue()) < len(data):
            kind, data = _KINDS[".webp"], buffer.getvalue()
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def render(
    template: str, clips: Clips, packs: Mapping[str, str], numbers: Mapping[str, str], **facts: Any
) -> str:
    """A page as text; the same facts give the same bytes.

    Parameters
    ----------
    template
        A file of `templates/`.
    clips
        Motions that the page plays.
    packs, numbers
        Packed structures and packed numbers by the names that the page's script asks for.
    **facts
        What the template shows.
    """
    page = _environment().get_template(template)
    text = page.render(
        style=_part("page.css"),
        script=_part("page.js"),
        clips=clips,
        clip_facts=_json({"skeletons": clips.skeletons, "clips": clips.about}),
        packs=packs,
        numbers=numbers,
        **facts,
    )
    return text.rstrip("\n") + "\n"


@cache
def _environment() -> jinja2.Environment:
    return jinja2.Environment(
        loader=jinja2.PackageLoader("miburi.report", "templates"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )


@cache
def _part(name: str) -> Markup:
    """Style or script of the page, as `npm run build` in web/ made it."""
    text = (files("miburi.report") / "templates" / name).read_text(encoding="utf-8")
    return Markup(text.replace("</script", "<\\/script"))


def _json(value: Any) -> Markup:
    """JSON that cannot end its script element."""
    text = json.dumps(value, separators=(",", ":"), ensure_ascii=False, sort_keys=True)
    return Markup(text.replace("<", "\\u003c"))


def _is_number(text: str) -> bool:
    try:
        float(text or "0")
    except ValueError:
        return False
    return True
