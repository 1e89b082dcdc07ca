"""Contact sheets: frames of a motion in rows, as PNG."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from miburi import store
from miburi.errors import InputError
from miburi.motion import Motion
from miburi.render import scene, text


class Strip(NamedTuple):
    """A row of a sheet: a title and the frames that it shows."""

    title: str
    frames: Sequence[int]


def evenly(first: int, last: int, count: int) -> list[int]:
    """`count` frames from the first to the last, both shown, as even as whole frames can be."""
    return [int(k) for k in np.rint(np.linspace(first, last, count))]


def rows(motion: Motion, *, columns: int = 8, count: int | None = None) -> list[Strip]:
    """Strips that show a whole motion: `count` frames (absent: two a second, 4 to 48) in rows of
    `columns`."""
    if columns < 1:
        raise InputError(f"a contact sheet of {columns} columns, expected 1 or more")
    wanted = min(max(4, round(2 * len(motion) / motion.fps)), 48) if count is None else count
    shown = evenly(0, len(motion) - 1, min(wanted, len(motion)))
    return [Strip("", shown[k : k + columns]) for k in range(0, len(shown), columns)]


def changes(
    labels: Sequence[str],
    boundaries: Sequence[int] | NDArray[np.int64],
    wanted: Sequence[str],
    columns: int = 8,
) -> list[Strip]:
    """A strip for the first time that each wanted label appears, from the hold before it to the hold after
    it ([H], fig. 6).

    Parameters
    ----------
    labels
        L labels of a string.
    boundaries : (L + 1,)
        Their first frames, and the frame after the last.
    wanted
        Labels of changes, as "rs".

    Raises
    ------
    InputError
        A wanted label is not in the string.
    """
    strips = []
    for number, label in enumerate(wanted, 1):
        if label not in labels:
            raise InputError(f"a strip of {label!r} is wanted, the string is {' '.join(labels)}")
        k = list(labels).index(label)
        start, end = int(boundaries[k]), int(boundaries[k + 1])
        before = (start - int(boundaries[k - 1])) // 3 if k > 0 else 0
        after = (int(boundaries[k + 2]) - end) // 3 if k + 2 < len(boundaries) else 0
        strips.append(Strip(f"({number}) {label}", evenly(start - before, end - 1 + after, columns)))
    return strips


def sheet(
    path: str | os.PathLike[str],
    motion: Motion,
    strips: Sequence[Strip],
    *,
    title: str = "",
    captions: Sequence[str] | None = None,
    width: int = 240,
    height: int = 240,
) -> None:
    """Write a contact sheet.

    Parameters
    ----------
    path
        Of the PNG.
    strips
        Its rows; all frames are seen by the same camera.
    title
        Stands above: what is shown, and whether it is simulated.
    captions
        A word for each frame of the motion (its label); under each picture stands the time and this word.
    width, height
        Pixels of each picture.

    Raises
    ------
    InputError
        A frame lies outside the motion, or there is no strip.
    """
    shown = [k for s in strips for k in s.frames]
    if not shown:
        raise InputError(f"{path}: a contact sheet without a frame")
    if min(shown) < 0 or max(shown) >= len(motion):
        raise InputError(f"{path}: frames {min(shown)} to {max(shown)}, the motion has {len(motion)}")
    if captions is not None and len(captions) != len(motion):
        raise InputError(f"{path}: {len(captions)} captions for {len(motion)} frames")
    cell, large = max(14, height // 12), max(16, height // 10)
    pictures = scene.frames(motion, width=width, height=height, at=shown)
    across = max(len(s.frames) for s in strips)
    page = [_heading(title, across * width, large)] if title else []
    for strip in strips:
        row = np.full((height + int(1.7 * cell), across * width, 3), 255, np.uint8)
        for c, k in enumerate(strip.frames):
            row[:height, c * width : (c + 1) * width] = next(pictures)
            words = f"{k / motion.fps:.2f} s" + (f"  {captions[k]}" if captions is not None else "")
            row = text.write(row, words, ((c + 0.5) * width, height + 0.2 * cell), "mt", cell).copy()
        if strip.title:
            page.append(_heading(strip.title, across * width, large))
        page.append(row)
    pictures.close()
    with store.replaced(path) as temporary:
        Image.fromarray(np.concatenate(page)).save(temporary, format="PNG", compress_level=6)


def _heading(words: str, width: int, letters: int) -> NDArray[np.uint8]:
    """A line of words."""
    line = np.full((int(1.6 * letters), width, 3), 255, np.uint8)
    return text.write(line, words, (0.5 * letters, 0.35 * letters), "lt", letters)
