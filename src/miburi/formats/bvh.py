"""Biovision hierarchies (.bvh), as found in the wild and strictly checked; a writer.

What a file means
-----------------
* A joint's rotation is the product of its rotation channels in the order in which they stand; its position
  channels replace its OFFSET (axes without a channel keep it), wherever they stand among the rotations. So
  the root is at its position channels, not at OFFSET + channels: `Skeleton.offsets[0]` holds the OFFSET and
  `Motion.root` the channels less it. Position channels of inner joints become `Motion.translations`, or
  nothing where they never differ from the OFFSET, or where those of all inner joints stay below a thousandth
  of the longest OFFSET (some programs write displacements; they would put every joint onto its parent).
* `End Site` (also a leaf `JOINT Site` without channels) becomes an end. Joints of the same name are told
  apart by a number: the second `Bone` is `Bone.2`.
* The format names no unit and no upward axis: see `miburi.formats.units`.
* Frame times are rounded decimals: 0.008333 is read as 120 frames/s, where a whole number of frames per
  second rounds or cuts to the digits that stand there (four at least).
"""

from __future__ import annotations

import gzip
import re

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.errors import InputError
from miburi.formats import angles, numerals, scan, text, units
from miburi.formats.bvh_header import MARK, Header, parse
from miburi.motion import Floats, Motion, Skeleton

_MOTION = re.compile(rb"^[ \t]*MOTION[ \t]*$", re.MULTILINE | re.IGNORECASE)
_FRAMES = re.compile(rb"\s*Frames:[ \t]*(\S*)\s+Frame\s+Time:[ \t]*(\S*)[ \t]*(?:\n|$)", re.IGNORECASE)


def _rate(written: str) -> float:
    """Frames per second of a frame time as it is written."""
    seconds = text.real(written)
    if seconds is None or not 1e-6 <= seconds <= 1e6:
        raise ValueError
    mantissa, _, exponent = written.lower().partition("e")
    digits = mantissa.replace(".", "").lstrip("+-0")
    decimals = len(mantissa.partition(".")[2]) - int(exponent or 0)
    whole = round(1 / seconds)
    if len(digits) >= 4 and whole > 0 and abs(1 / whole - seconds) < 10.0**-decimals:
        return float(whole)
    return 1 / seconds


def read(
    path: text.File,
    *,
    fps: float | None = None,
    unit: float | None = None,
    up: str | None = None,
    joints: dict[str, str] | None = None,
) -> Motion:
    """Read a BVH file, plain or gzipped.

    Parameters
    ----------
    fps
        Frames per second instead of those of the file's frame time.
    unit
        Metres per unit of the file; absent: found by the size of the body (`miburi.formats.units`).
    up
        The file's upward axis, "x", "y" or "z"; absent: found by how the body stands.
    joints
        Canonical joint → name in this file, where `miburi.conventions` does not know the names.

    Returns
    -------
    Motion
        Metres, Y up; named after the file.

    Raises
    ------
    InputError
        The file is damaged; the sentence names the line, what was found and what was expected.
    """
    return load(path, fps=fps, unit=unit, up=up, joints=joints)[0]


def load(
    path: text.File,
    *,
    fps: float | None = None,
    unit: float | None = None,
    up: str | None = None,
    joints: dict[str, str] | None = None,
) -> tuple[Motion, units.Choice]:
    """As `read`, with the unit and the upward axis that were chosen, and why."""
    data = text.load(path)
    motion_at = _MOTION.search(data)
    header = parse(path, data[: motion_at.start()] if motion_at else data)
    if motion_at is None:
        line = text.line_of(data, len(data.rstrip()))
        raise InputError(f"{path}, line {line}: the file ends without MOTION")
    frames, rate, begin = _declared(path, data, motion_at.end())
    values = _values(path, data, begin, frames, sum(map(len, header.channels)))
    motion = _motion(path, header, values, rate if fps is None else fps)
    if header.marked and unit is None and up is None:
        return units.apply(motion, units.Choice(0.01, "stated in the file", "y", "stated in the file"))
    return units.apply(motion, units.choose(motion, unit=unit, up=up, joints=joints))


def _declared(path: text.File, data: bytes, at: int) -> tuple[int, float, int]:
    """Frames, frames per second and where the numbers begin."""
    match = _FRAMES.match(data, at)
    if match is None:
        rest = data[at:].strip().split(b"\n")[0]
        line = text.line_of(data, at + len(data[at:]) - len(data[at:].lstrip()))
        raise InputError(
            f"{path}, line {line}: found {text.shown(rest)}, expected 'Frames: n' and 'Frame Time: s' "
            "on two lines"
        )
    line = text.line_of(data, match.start(1))
    count, seconds = text.decode(match.group(1)), text.decode(match.group(2))
    if not (count.isascii() and count.isdecimal()) or int(count[:20]) == 0:
        raise InputError(
            f"{path}, line {line}: Frames: says {text.shown(count)}, expected a positive whole number"
        )
    try:
        rate = _rate(seconds)
    except ValueError:
        line = text.line_of(data, match.start(2))
        raise InputError(
            f"{path}, line {line}: Frame Time: says {text.shown(seconds)}, expected seconds above 0"
        ) from None
    return int(count[:20]), rate, match.end()


def _values(path: text.File, data: bytes, begin: int, frames: int, channels: int) -> Floats:
    if channels == 0:
        raise InputError(f"{path}: no joint has channels, so nothing moves")
    values = scan.numbers(path, data, begin, channels, broken=True)
    if len(values) != frames:
        line = text.line_of(data, begin) - 2
        rows = "1 row" if len(values) == 1 else f"{len(values)} rows"
        raise InputError(f"{path}, line {line}: Frames: says {frames}, the file has {rows} of numbers")
    return values


def _motion(path: text.File, header: Header, values: Floats, fps: float) -> Motion:
    """The motion in the file's own unit and axes."""
    n = len(header.joints)
    columns = np.full((n, 3), -1, dtype=np.int64)
    axes = np.zeros((n, 3), dtype=np.int64)
    places: list[tuple[int, int, int]] = []
    column = 0
    for j, channels in enumerate(header.channels):
        turn = 0
        for kind, axis in channels:
            if kind:
                columns[j, turn], axes[j, turn] = column, axis
                turn += 1
            else:
                places.append((j, axis, column))
            column += 1
    offsets = np.array(header.offsets)
    root, translations = _translations(values, offsets, places, header.marked)
    name = text.stem(path)
    skeleton = Skeleton(
        tuple(header.joints),
        np.array(header.parents),
        offsets,
        name,
        np.array(header.ends, dtype=np.int32),
        np.array(header.end_offsets).reshape(-1, 3),
    )
    return Motion(skeleton, fps, root, angles.rotations(values, columns, axes), translations, name=name)


def _translations(
    values: Floats, offsets: Floats, places: list[tuple[int, int, int]], marked: bool
) -> tuple[Floats, NDArray[np.float64] | None]:
    """What position channels add to the offsets: the root's path, and the inner joints' if they move."""
    root = np.zeros((len(values), 3))
    inner = []
    for j, axis, column in places:
        if j == 0:
            root[:, axis] = values[:, column] - offsets[0, axis]
        else:
            inner.append((j, axis, column))
    tiny = 1e-5 * max(float(np.abs(offsets).max()), 1e-12)
    nothing = 1e-3 * float(np.abs(offsets[1:]).max(initial=0.0))
    if not marked and all(np.abs(values[:, c]).max() <= nothing for _, _, c in inner):
        return root, None
    # an OFFSET may be rounded more coarsely than the channels that repeat it
    if all(np.abs(values[:, c] - offsets[j, a]).max() <= tiny for j, a, c in inner):
        return root, None
    translations = np.zeros((len(values), *offsets.shape))
    for j, axis, column in inner:
        translations[:, j, axis] = values[:, column] - offsets[j, axis]
    return root, translations


def write(path: text.File, motion: Motion) -> None:
    """Write a motion as BVH: centimetres, Y up, angles Z X Y; gzipped if the path ends in .gz.

    Reading it again gives the same skeleton (joints in the order of the tree) and the same places to 1e-6 m.

    Raises
    ------
    InputError
        The motion has no frames, or a joint's name cannot stand in a BVH file.
    """
    s = motion.skeleton
    if len(motion) == 0:
        raise InputError(f"{path}: take {motion.name!r} has no frames to write")
    for joint in s.joints:
        if not joint or joint != " ".join(joint.split()) or {"{", "}"} & set(joint):
            raise InputError(f"{path}: joint {joint!r} cannot be named so in a BVH file")
    order = _tree(s)
    lines = ["HIERARCHY" + MARK, *_lines(motion, order), "MOTION", f"Frames: {len(motion)}"]
    lines.append(f"Frame Time: {_frame_time(motion.fps)}")
    turns = angles.zxy(motion.rotations[:, order])
    columns = [100 * (motion.root + s.offsets[0])]
    for k, j in enumerate(order):
        if k and motion.translations is not None:
            columns.append(100 * (motion.translations[:, j] + s.offsets[j]))
        columns.append(turns[:, k])
    data = ("\n".join(lines) + "\n").encode() + numerals.six(np.hstack(columns))
    with store.replaced(path) as temporary:
        temporary.write_bytes(gzip.compress(data, 6, mtime=0) if str(path).lower().endswith(".gz") else data)


def _frame_time(fps: float) -> str:
    """Seconds per frame in as many digits as give the same rate again."""
    seconds = 1 / fps
    for candidate in (seconds, np.nextafter(seconds, 0), np.nextafter(seconds, 1e9)):
        if _rate(repr(float(candidate))) == fps:
            return repr(float(candidate))
    return repr(seconds)


def _tree(s: Skeleton) -> list[int]:
    """Joints in the order of a walk through the tree."""
    children: list[list[int]] = [[] for _ in s.joints]
    for j, p in enumerate(s.parents.tolist()):
        if p >= 0:
            children[p].append(j)
    order, stack = [], [0]
    while stack:
        j = stack.pop()
        order.append(j)
        stack.extend(reversed(children[j]))
    return order


def _lines(motion: Motion, order: list[int]) -> list[str]:
    """The hierarchy's lines."""
    s = motion.skeleton
    parents = s.parents.tolist()
    ends: list[list[int]] = [[] for _ in s.joints]
    for e, j in enumerate(s.ends.tolist()):
        ends[j].append(e)
    lines: list[str] = []
    open_: list[int] = []
    for j in order:
        while open_ and open_[-1] != parents[j]:
            open_.pop()
            lines.append("\t" * len(open_) + "}")
        tab = "\t" * len(open_)
        lines += [
            f"{tab}{'JOINT' if j else 'ROOT'} {s.joints[j]}",
            tab + "{",
            f"{tab}\tOFFSET {_three(s.offsets[j])}",
        ]
        places = "6 Xposition Yposition Zposition" if j == 0 or motion.translations is not None else "3"
        lines.append(f"{tab}\tCHANNELS {places} Zrotation Xrotation Yrotation")
        offsets = [_three(s.end_offsets[e]) for e in ends[j]] or (["0 0 0"] if j not in parents else [])
        for offset in offsets:
            lines += [f"{tab}\tEnd Site", f"{tab}\t{{", f"{tab}\t\tOFFSET {offset}", f"{tab}\t}}"]
        open_.append(j)
    return lines + ["\t" * k + "}" for k in reversed(range(len(open_)))]


def _three(metres: Floats) -> str:
    """An OFFSET in centimetres, never written `0 0 0`."""
    return " ".join(repr(round(100 * float(v), 9) + 0.0) for v in metres)
