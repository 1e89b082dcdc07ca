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


def write(picture: Picture, words: str, at: tuple[float, float], anchor: str, letters: int) -> Picture:
    """The picture with words at (x, y) pixels, in letters of so many.

    `anchor` is Pillow's: "lt" means that the words' upper left corner is there. Words that would reach beyond
    the right edge are set smaller.
    """
    words = words.replace(" ", "  ")  # labels of one letter run together with the typeface's narrow spaces
    room = picture.shape[1] - at[0] if anchor[0] == "l" else 2 * min(at[0], picture.shape[1] - at[0])
    while letters > 6 and _font(letters).getlength(words) > room:
        letters -= 1
    image = Image.fromarray(picture)
    ImageDraw.Draw(image).text(at, words, fill=_INK, font=_font(letters), anchor=anchor)
    return np.asarray(image)


def size(height: int) -> int:
    """Pixels of the letters of words about pictures of this height."""
    return max(10, height // 20)


def below(picture: Picture, words: str) -> Picture:
    """The picture with words in its lower left corner."""
    height = len(picture)
    letters = size(height)
    return write(picture, words, (letters, height - 0.5 * letters), "ls", letters)
