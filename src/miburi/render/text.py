"""Words in pictures, in the typeface that comes with Pillow."""

from __future__ import annotations

from functools import cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from PIL.ImageFont import FreeTypeFont

from miburi.render.scene import Picture

_INK = (40, 40, 45)


@cache
def _font(size: int) -> FreeTypeFont:
    font = ImageFont.load_default(size)
    if not isinstance(font, FreeTypeFont):
        raise RuntimeError("this Pillow was built without FreeType, so it has no typeface of its own")
    return font


def write(picture: Picture, words: str, at: tuple[float, float], anchor: str, size: int) -> Picture:
    """The picture with words at (x, y) pixels; `anchor` as in Pillow, "lt" is the words' upper left
    corner."""
    image = Image.fromarray(picture)
    ImageDraw.Draw(image).text(at, words, fill=_INK, font=_font(size), anchor=anchor)
    return np.asarray(image)


def below(picture: Picture, words: str) -> Picture:
    """The picture with words in its lower left corner."""
    height = len(picture)
    size = max(10, height // 18)
    return write(picture, words, (size, height - 0.6 * size), "ls", size)
