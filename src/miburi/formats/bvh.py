"""Biovision hierarchies (.bvh), as found in the wild and strictly checked; a writer.

What a file means
-----------------
* A joint's rotation is the product of its rotation channels in the order in which they stand; its position channels
  **replace** its OFFSET (axes without a channel keep it), wherever they stand among the rotations. So the root is at
  its position channels, not at OFFSET + channels: `Skeleton.offsets[0]` holds the OFFSET and `Motion.root` the
  channels less it. Position channels of inner joints become `Motion.translations`, or nothing where they never
  differ from the OFFSET.
* `End Site` (also a leaf `JOINT Site` without channels) becomes an end. Joints of the same name are told apart by
  a number: the second `Bone` is `Bone.2`.
* The format names no unit and no upward axis: see `miburi.formats.units`.
* Frame times are rounded decimals: 0.008333 is read as 120 frames/s, where a whole number of frames per second
  rounds or cuts to the digits that stand there (four at least).
"""

from __future__ import annotations

import gzip
import re
from dataclasses import dataclass
from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from miburi import store
from miburi.errors import InputError
from miburi.formats import angles, text, units
from miburi.motion import Floats, Motion, Skeleton

MARK = " \t "
"""Stands after HIERARCHY in files that `write` made, unseen by other readers: centimetres, Y up, and an End Site
whose OFFSET is `0 0 0` only closes a joint without ends."""

_TOKEN = re.compile(rb"[{}]|[^\s{}]+")
_MOTION = re.compile(rb"^[ \t]*MOTION[ \t]*$", re.MULTILINE | re.IGNORECASE)
_FRAMES = re.compile(rb"\s*Frames:[ \t]*(\S*)[ \t]*\n\s*Frame[ \t]+Time:[ \t]*(\S*)[ \t]*(?:\n|$)", re.IGNORECASE)


@dataclass
class _Header:
    joints: list[str]
    parents: list[int]
    offsets: list[list[float]]
    channels: list[list[tuple[int, int]]]  # of each joint: (kind, axis), kind 0 position, 1 rotation
    ends: list[int]
    end_offsets: list[list[float]]
    marked: bool


class _Tokens:
    """The header's words, one after the other, with the line of the last one."""

    def __init__(self, path: text.File, data: bytes) -> None:
        self.path, self.data = path, data
        self.matches = list(_TOKEN.finditer(data))
        self.at = 0

    def peek(self) -> str:
        return text.decode(self.matches[self.at].group()) if self.at < len(self.matches) else ""

    def next(self, expected: str) -> str:
        if self.at >= len(self.matches):
            line = text.line_of(self.data, len(self.data.rstrip()))
            raise InputError(f"{self.path}, line {line}: the hierarchy ends here, expected {expected}")
        self.at += 1
        return text.decode(self.matches[self.at - 1].group())

    def line(self) -> int:
        return text.line_of(self.data, self.matches[max(self.at - 1, 0)].start()) if self.matches else 1

    def fail(self, found: str, expected: str) -> NoReturn:
        raise InputError(f"{self.path}, line {self.line()}: found {text.shown(found)}, expected {expected}")

    def name(self) -> str:
        """The rest of the line, up to a brace: names may hold blanks."""
        first = self.next("a joint's name")
        if first in "{}":
            self.fail(first, "a joint's name")
        words, line = [first], self.line()
        while self.at < len(self.matches) and self.peek() not in "{}":
            self.at += 1
            if self.line() != line:
                self.at -= 1
                break
            words.append(text.decode(self.matches[self.at - 1].group()))
        return " ".join(words)

    def brace(self) -> None:
        if (found := self.next("'{'")) != "{":
            self.fail(found, "'{'")

    def numbers(self, count: int, what: str) -> list[float]:
        values = []
        for _ in range(count):
            token = self.next(what)
            try:
                value = float(token)
            except ValueError:
                self.fail(token, what)
            if not np.isfinite(value):
                self.fail(token, what)
            values.append(value)
        return values


def _channels(tokens: _Tokens, joint: str) -> list[tuple[int, int]]:
    count = tokens.next("the number of channels")
    if not count.isdecimal() or int(count) > 6:
        tokens.fail(count, f"the number of channels of joint {joint!r}, 0 to 6")
    found: list[tuple[int, int]] = []
    for _ in range(int(count)):
        word = tokens.next("a channel")
        low = word.lower()
        if low[:1] not in ("x", "y", "z") or low[1:] not in ("position", "rotation"):
            tokens.fail(word, f"a channel of joint {joint!r} such as Xposition or Zrotation")
        channel = (int(low[1:] == "rotation"), "xyz".index(low[0]))
        if channel in found:
            raise InputError(f"{tokens.path}, line {tokens.line()}: joint {joint!r} has the channel {word} twice")
        found.append(channel)
    return found


def _hierarchy(path: text.File, data: bytes) -> _Header:
    """Parse everything before MOTION."""
    tokens = _Tokens(path, data)
    if (first := tokens.next("HIERARCHY")).upper() != "HIERARCHY":
        tokens.fail(first, "HIERARCHY: this is no BVH file")
    found = _Header([], [], [], [], [], [], data.split(b"\n", 1)[0].endswith(b"HIERARCHY" + MARK.encode()))
    open_: list[int] = []
    seen: dict[str, int] = {}
    while not found.joints or open_ or tokens.at < len(tokens.matches):
        word = tokens.next("'}', JOINT, End Site, OFFSET or CHANNELS" if found.joints else "ROOT")
        key = word.upper()
        if key == "ROOT" and found.joints:
            name = tokens.name()
            raise InputError(
                f"{path}, line {tokens.line()}: a second ROOT {name!r}; one skeleton a file can be read, split the file"
            )
        if key in ("ROOT", "JOINT") and bool(open_) == (key == "JOINT"):
            name = tokens.name()
            seen[name] = seen.get(name, 0) + 1
            while seen[name] > 1 and f"{name}.{seen[name]}" in seen:
                seen[name] += 1
            tokens.brace()
            _joint(tokens, found, name if seen[name] == 1 else f"{name}.{seen[name]}", open_)
            seen.setdefault(found.joints[-1], 1)
        elif key == "END" and open_:
            tokens.name()
            tokens.brace()
            offset, placeholder = _offset(tokens)
            if (closing := tokens.next("'}'")) != "}":
                tokens.fail(closing, "'}' after the OFFSET of an End Site")
            if not (found.marked and placeholder):
                found.ends.append(open_[-1])
                found.end_offsets.append(offset)
        elif key == "}" and open_:
            open_.pop()
        else:
            tokens.fail(word, "'}', JOINT or End Site" if open_ else "ROOT" if not found.joints else "MOTION")
    return _sites_are_ends(found)


def _offset(tokens: _Tokens) -> tuple[list[float], bool]:
    """An OFFSET, and whether it is written `0 0 0`."""
    if (word := tokens.next("OFFSET")).upper() != "OFFSET":
        tokens.fail(word, "OFFSET")
    values = tokens.numbers(3, "an OFFSET of 3 numbers")
    return values, all(m.group() == b"0" for m in tokens.matches[tokens.at - 3 : tokens.at])


def _joint(tokens: _Tokens, found: _Header, name: str, open_: list[int]) -> None:
    """The OFFSET and CHANNELS of a joint, in either order."""
    found.joints.append(name)
    found.parents.append(open_[-1] if open_ else -1)
    channels: list[tuple[int, int]] | None = None
    offset: list[float] | None = None
    while tokens.peek().upper() in ("OFFSET", "CHANNELS"):
        if tokens.peek().upper() == "OFFSET" and offset is None:
            offset, _ = _offset(tokens)
        elif tokens.peek().upper() == "CHANNELS" and channels is None:
            tokens.next("CHANNELS")
            channels = _channels(tokens, name)
        else:
            word = tokens.next("")
            raise InputError(f"{tokens.path}, line {tokens.line()}: joint {name!r} has two {word.upper()}")
    if offset is None or channels is None:
        missing = "OFFSET" if offset is None else "CHANNELS"
        raise InputError(f"{tokens.path}, line {tokens.line()}: joint {name!r} has no {missing}")
    found.offsets.append(offset)
    found.channels.append(channels)
    open_.append(len(found.joints) - 1)


def _sites_are_ends(h: _Header) -> _Header:
    """Leaves without channels that are called Site are ends in disguise."""
    inner = {*h.parents, *h.ends}
    sites = [
        j
        for j, name in enumerate(h.joints)
        if re.fullmatch(r"(end ?)?site(\.\d+)?", name.lower()) and not h.channels[j] and j not in inner and j > 0
    ]
    if not sites:
        return h
    rows = sorted([*zip(h.ends, h.end_offsets, strict=True), *((h.parents[j], h.offsets[j]) for j in sites)])
    kept = [j for j in range(len(h.joints)) if j not in set(sites)]
    new = {old: k for k, old in enumerate(kept)} | {-1: -1}
    return _Header(
        [h.joints[j] for j in kept],
        [new[h.parents[j]] for j in kept],
        [h.offsets[j] for j in kept],
        [h.channels[j] for j in kept],
        [new[p] for p, _ in rows],
        [o for _, o in rows],
        h.marked,
    )


def _rate(written: str) -> float:
    """Frames per second of a frame time as it is written."""
    seconds = float(written)
    if not (np.isfinite(seconds) and seconds > 0):
        raise ValueError
    mantissa, _, exponent = written.lower().partition("e")
    digits = mantissa.replace(".", "").lstrip("+-0")
    decimals = len(mantissa.partition(".")[2]) - int(exponent or 0)
    whole = round(1 / seconds)
    if len(digits) >= 4 and whole > 0 and abs(1 / whole - seconds) < 1.0 * 10.0**-decimals:
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
    header = _hierarchy(path, data[: motion_at.start()] if motion_at else data)
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
            f"{path}, line {line}: found {text.shown(rest)}, expected 'Frames: n' and 'Frame Time: s' on two lines"
        )
    line = text.line_of(data, match.start(1))
    count, seconds = text.decode(match.group(1)), text.decode(match.group(2))
    if not (count.isascii() and count.isdecimal()) or int(count[:20]) == 0:
        raise InputError(f"{path}, line {line}: Frames: says {text.shown(count)}, expected a positive whole number")
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
    values = text.numbers(path, data, begin, channels)
    if len(values) != frames:
        line = text.line_of(data, begin) - 2
        rows = "1 row" if len(values) == 1 else f"{len(values)} rows"
        raise InputError(f"{path}, line {line}: Frames: says {frames}, the file has {rows} of numbers")
    return values


def _motion(path: text.File, header: _Header, values: Floats, fps: float) -> Motion:
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
    root, translations = _translations(values, offsets, places)
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
    values: Floats, offsets: Floats, places: list[tuple[int, int, int]]
) -> tuple[Floats, NDArray[np.float64] | None]:
    """What position channels add to the offsets: the root's path, and the inner joints' if they move."""
    root = np.zeros((len(values), 3))
    inner = []
    for j, axis, column in places:
        if j == 0:
            root[:, axis] = values[:, column] - offsets[0, axis]
        else:
            inner.append((j, axis, column))
    # an OFFSET may be rounded more coarsely than the channels that repeat it
    still = 1e-5 * max(float(np.abs(offsets).max()), 1e-12)
    moved = [(j, a, c) for j, a, c in inner if np.abs(values[:, c] - offsets[j, a]).max() > still]
    if not moved:
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
    table = np.hstack(columns) + 0.0  # no −0
    row = " ".join(["%.6f"] * table.shape[1])
    body = "\n".join(row % tuple(frame) for frame in table.tolist())
    data = ("\n".join(lines) + "\n" + body + "\n").encode()
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
        lines += [f"{tab}{'JOINT' if j else 'ROOT'} {s.joints[j]}", tab + "{", f"{tab}\tOFFSET {_three(s.offsets[j])}"]
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


