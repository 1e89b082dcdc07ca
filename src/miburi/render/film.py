"""Films: MP4 by the ffmpeg that comes with imageio-ffmpeg, or animated WebP; the same bytes for the same motion."""

from __future__ import annotations

import os
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

import imageio_ffmpeg
import numpy as np
from PIL import Image

from miburi import store
from miburi.errors import InputError
from miburi.kinematics import resample
from miburi.motion import Motion
from miburi.render import figure, scene, text
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
    title: str = "",
    names: Sequence[str] = (),
    captions: Sequence[Caption] = (),
    own_captions: Sequence[Sequence[Caption]] = (),
) -> int:
    """Make a film of one motion, or of several side by side.

    Words stand above and below the figures, never over them.

    Parameters
    ----------
    path
        Of the film, .mp4 or .webp (which repeats for ever); it appears whole or not at all.
    fps
        Pictures per second; absent: the first motion's rate. Motions of another rate are resampled.
    width, height
        Even numbers of pixels.
    title
        Stands above throughout: what is shown, and whether it is simulated.
    names
        Of the figures that are shown side by side, written under each.
    captions
        (start_s, end_s, text): what is written below from when to when, seconds; the end is exclusive.
    own_captions
        Captions of each figure, written under it.

    Returns
    -------
    int
        Pictures in the film.

    Raises
    ------
    InputError
        Nothing to show, a size or rate that a film cannot have, or the film cannot be written.
    """
    shown = [motions] if isinstance(motions, Motion) else list(motions)
    if not shown:
        raise InputError(f"{path}: nothing to show, no motion is given")
    rate = shown[0].fps if fps is None else float(fps)
    if not 0 < rate <= 1000:
        raise InputError(f"{path}: {rate:g} pictures per second, expected more than 0 and at most 1000")
    if width % 2 or height % 2:
        raise InputError(f"{path}: pictures of {width} × {height} pixels, a film needs even numbers")
    if names and len(names) != len(shown):
        raise InputError(f"{path}: {len(names)} names for {len(shown)} figures")
    if own_captions and len(own_captions) != len(shown):
        raise InputError(f"{path}: captions of {len(own_captions)} figures for {len(shown)}")
    line = text.size(height)
    top = int(1.7 * line) if title else 0
    below = int(1.5 * line) * (bool(names) + bool(captions or own_captions))
    inner = height - top - below
    motions_at_rate = [resample(m, rate) for m in shown]
    page = np.full((height, width, 3), 255, np.uint8)
    if title:
        page = text.write(page, title, (line, 0.5 * line), "lt", line)
    places: list[float] = []
    if names or own_captions:
        figures = figure.group(motions_at_rate)
        places = figure.across(figures, figure.camera(figures, width / inner), width / inner)
    for name, x in zip(names, places, strict=False):
        page = text.write(page, name, (x * width, top + inner + 0.2 * line), "mt", line)
    under = [(x * width, c) for x, c in zip(places, own_captions, strict=False)]
    pictures = scene.frames(motions_at_rate, width=width, height=inner)
    with store.replaced(path) as temporary:
        try:
            pages = _pages(pictures, page, top, rate, captions, under)
            if Path(path).suffix == ".webp":
                return _animate(temporary, pages, rate)
            return encode(temporary, pages, rate, width, height)
        except _FfmpegFailed as error:
            raise InputError(f"{path}: the film cannot be written (ffmpeg: {error})") from error
        finally:
            pictures.close()


class _FfmpegFailed(Exception):
    """What ffmpeg said last."""


def encode(
    path: str | os.PathLike[str], pictures: Iterator[Picture], fps: float, width: int, height: int
) -> int:
    """Write pictures (height, width, 3) as an MP4; their number."""
    command = [
        *(imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-v", "error"),
        *("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:.10g}", "-i", "-"),
        *("-an", "-c:v", "libx264", "-pix_fmt", "yuv420p", *_BIT_EXACT, "-f", "mp4", os.fspath(path)),
    ]
    count = 0
    # what it says goes to a file: a pipe that nobody reads would block it
    with tempfile.TemporaryFile() as said:
        ffmpeg = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=said)
        assert ffmpeg.stdin is not None
        try:
            for picture in pictures:
                ffmpeg.stdin.write(np.ascontiguousarray(picture).data)
                count += 1
            ffmpeg.stdin.close()
        except BrokenPipeError:
            pass  # it has ended, and says why
        except BaseException:
            ffmpeg.kill()
            raise
        finally:
            status = ffmpeg.wait()
        if status:
            said.seek(0)
            words = said.read().decode(errors="replace").strip().splitlines()
            raise _FfmpegFailed(words[0] if words else f"it ended with status {status}")
    return count


def _animate(path: str | os.PathLike[str], pictures: Iterator[Picture], fps: float) -> int:
    """Write pictures as an animated WebP; their number."""
    first, *rest = [Image.fromarray(np.ascontiguousarray(p)) for p in pictures]
    # whole milliseconds that add up: a rate of 30 is 33, 34, 33 … ms
    ends = [round(1000 * (k + 1) / fps) for k in range(len(rest) + 1)]
    durations = [b - a for a, b in zip([0, *ends], ends, strict=False)]
    first.save(
        path, "WEBP", save_all=True, append_images=rest, duration=durations, loop=0, quality=60, method=4
    )
    return len(durations)


def decode(path: str | os.PathLike[str]) -> tuple[float, Picture]:
    """Pictures per second and pictures (T, height, width, 3) of a film."""
    reader = imageio_ffmpeg.read_frames(str(path))
    about = next(reader)
    width, height = about["size"]
    pictures = [np.frombuffer(p, np.uint8).reshape(height, width, 3) for p in reader]
    return float(about["fps"]), np.stack(pictures)


def _pages(
    pictures: Iterator[Picture],
    page: Picture,
    top: int,
    fps: float,
    captions: Sequence[Caption],
    under: Sequence[tuple[float, Sequence[Caption]]],
) -> Iterator[Picture]:
    """Pictures on a page of words, with the captions of their time: one for all, and one under each figure."""

    def now(all_of: Sequence[Caption], k: int) -> str:
        return next((w for start, end, w in all_of if start <= (k + 1e-6) / fps < end), "")

    height, letters = len(page), text.size(len(page))
    for k, picture in enumerate(pictures):
        words = now(captions, k)
        whole = text.below(page, words) if words else page
        for x, own in under:
            whole = text.write(whole, now(own, k), (x, height - 0.5 * letters), "ms", letters)
        whole = whole.copy()
        whole[top : top + len(picture)] = picture
        yield whole
