"""Films: MP4 by the ffmpeg that comes with imageio-ffmpeg, the same bytes for the same motion."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

import imageio_ffmpeg
import numpy as np

from miburi import store
from miburi.errors import InputError
from miburi.kinematics import resample
from miburi.motion import Motion
from miburi.render import scene, text
from miburi.render.scene import Picture

# One thread and no stamps: x264's bytes depend on the number of threads.
_BIT_EXACT = (
    *("-crf", "20", "-preset", "medium", "-threads", "1"),
    *("-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"),
)
Caption = tuple[float, float, str]


def film(
    path: str | os.PathLike[str],
    motions: Motion | Sequence[Motion],
    *,
    fps: float | None = None,
    width: int = 640,
    height: int = 480,
    captions: Sequence[Caption] = (),
) -> int:
    """Make a film of one motion, or of several side by side.

    Parameters
    ----------
    path
        Of the MP4; it appears whole or not at all.
    fps
        Pictures per second; absent: the first motion's rate. Motions of another rate are resampled.
    width, height
        Even numbers of pixels.
    captions
        (start_s, end_s, text): what is written below from when to when, seconds; the end is exclusive.

    Returns
    -------
    int
        Pictures in the film.

    Raises
    ------
    InputError
        Nothing to show, or a size or rate that a film cannot have.
    """
    shown = [motions] if isinstance(motions, Motion) else list(motions)
    if not shown:
        raise InputError(f"{path}: nothing to show, no motion is given")
    rate = shown[0].fps if fps is None else float(fps)
    if not 0 < rate <= 1000:
        raise InputError(f"{path}: {rate:g} pictures per second, expected more than 0 and at most 1000")
    if width % 2 or height % 2:
        raise InputError(f"{path}: pictures of {width} × {height} pixels, a film needs even numbers")
    pictures = scene.frames([resample(m, rate) for m in shown], width=width, height=height)
    with store.replaced(path) as temporary:
        return encode(temporary, _captioned(pictures, rate, captions), rate, width, height)


def encode(
    path: str | os.PathLike[str], pictures: Iterator[Picture], fps: float, width: int, height: int
) -> int:
    """Write pictures (height, width, 3) as an MP4; their number."""
    writer = imageio_ffmpeg.write_frames(
        str(path),
        (width, height),
        fps=fps,
        codec="libx264",
        pix_fmt_in="rgb24",
        pix_fmt_out="yuv420p",
        quality=None,
        macro_block_size=2,
        output_params=list(_BIT_EXACT),
    )
    writer.send(None)
    count = 0
    try:
        for picture in pictures:
            writer.send(picture)
            count += 1
    finally:
        writer.close()
    return count


def decode(path: str | os.PathLike[str]) -> tuple[float, Picture]:
    """Pictures per second and pictures (T, height, width, 3) of a film."""
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    width, height = about["size"]
    pictures = [np.frombuffer(p, np.uint8).reshape(height, width, 3) for p in reader]
    return float(about["fps"]), np.stack(pictures)


def _captioned(pictures: Iterator[Picture], fps: float, captions: Sequence[Caption]) -> Iterator[Picture]:
    for k, picture in enumerate(pictures):
        words = [w for start, end, w in captions if start <= (k + 1e-6) / fps < end]
        yield text.below(picture, words[0]) if words else picture
