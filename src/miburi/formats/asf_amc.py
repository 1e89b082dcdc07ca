"""Acclaim skeletons (.asf) and motions (.amc): the CMU and HDM05 databases.

Conventions
-----------
* An ASF gives each bone a direction and length in world axes at rest, and the axes C in which it turns
  ("axis 0 0 20 XYZ": about x first, then y, then z, so C = Rz Ry Rx). An AMC gives the angles of its degrees
  of freedom, M, in the order of `dof`, the first applied first. A bone turns by L = C M C⁻¹ against its
  parent; its tail is the parent's tail + (product of L down to it) · direction · length.
* Here a joint sits where its bone begins, is called after the bone, and turns by L; so all frames are the
  world's at rest. Bones without children end in `ends`.
* Lengths: (1 / `length` of :units) inches, as in CMU's and HDM05's files; `unit` comes first.
* AMC names no rate: 120 frames/s, unless it says :SAMPLES-PER-SECOND or `fps` is given.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from miburi.compiled import njit
from miburi.errors import InputError
from miburi.formats import angles, scan, text
from miburi.formats.asf import Acclaim, Bone, read_asf
from miburi.motion import Floats, Motion, Skeleton

FPS = 120.0
"""Frames per second of an AMC file that names none: the rate of the CMU and HDM05 databases."""


def find_asf(path: text.File) -> Path:
    """The skeleton of an AMC file: `{subject}.asf` beside it (14_01.amc: 14.asf), else the folder's only one.

    Raises
    ------
    InputError
        There is none; the sentence says what was looked for.
    """
    folder = Path(path).parent
    subject = text.stem(path).rsplit("_", 1)[0]
    for name in (f"{subject}.asf", f"{subject}.asf.gz"):
        if (folder / name).is_file():
            return folder / name
    there = sorted(p for p in folder.glob("*") if text.suffix(p) == ".asf") if folder.is_dir() else []
    if len({text.stem(p) for p in there}) == 1:
        return there[0]
    several = f"{len(there)} others" if there else "no other"
    raise InputError(
        f"{path}: its skeleton is missing: looked for {subject}.asf and {subject}.asf.gz in {folder}, "
        f"which has {several}; "
        "name it (config key `skeleton`)"
    )


def read(
    path: text.File,
    *,
    skeleton: text.File | Acclaim | Skeleton | None = None,
    fps: float | None = None,
    unit: float | None = None,
) -> Motion:
    """Read an Acclaim motion, plain or gzipped.

    Parameters
    ----------
    skeleton
        Path of the ASF, or what `read_asf` gave; absent: see `find_asf`.
    fps
        Frames per second; absent: what the file says, else 120.
    unit
        Metres per unit of length; absent: as the ASF says.

    Returns
    -------
    Motion
        Metres, Y up; joints are the root and the bones.

    Raises
    ------
    InputError
        The file is damaged or does not fit its skeleton; the sentence names the line.
    """
    if isinstance(skeleton, Skeleton):
        raise InputError(f"{path}: a Skeleton does not hold the axes of an ASF; give the path of the ASF")
    acclaim = (
        skeleton
        if isinstance(skeleton, Acclaim)
        else read_asf(find_asf(path) if skeleton is None else skeleton, unit=unit)
    )
    data = text.load(path)
    begin, degrees, rate = _header(path, data, acclaim.degrees)
    bones = {b.name: b for b in acclaim.bones}
    names, values = _frames(path, data, begin, bones, acclaim.skeleton.name)
    missing = [b.name for b in acclaim.bones if b.dof and b.name not in names]
    if missing:
        line = text.line_of(data, begin)
        raise InputError(f"{path}, line {line}: the frames have no {missing[0]!r}, which the skeleton moves")
    return _motion(path, acclaim, names, values, degrees, fps if fps is not None else rate)


def _header(path: text.File, data: bytes, degrees: bool) -> tuple[int, bool, float]:
    """Where the frames begin, whether angles are degrees, frames per second."""
    rate = FPS
    at = 0
    while at < len(data):
        end = data.find(b"\n", at)
        end = len(data) if end < 0 else end
        words = text.decode(data[at:end]).split()
        key = words[0].upper() if words else ""
        if key.isdecimal():
            return at, degrees, rate
        line = text.line_of(data, at)
        if key == ":DEGREES":
            degrees = True
        elif key == ":RADIANS":
            degrees = False
        elif key == ":SAMPLES-PER-SECOND":
            try:
                rate = float(words[1])
            except (IndexError, ValueError):
                raise InputError(f"{path}, line {line}: {key} names no number") from None
        elif key and not key.startswith(("#", ":FULLY-SPECIFIED")):
            raise InputError(
                f"{path}, line {line}: found {text.shown(' '.join(words))}, expected "
                ":FULLY-SPECIFIED, :DEGREES, :RADIANS "
                "or the number of a frame"
            )
        at = end + 1
    raise InputError(
        f"{path}, line {text.line_of(data, len(data.rstrip()))}: the file ends before the first frame"
    )


def _frames(
    path: text.File, data: bytes, begin: int, bones: dict[str, Bone], skeleton: str
) -> tuple[list[str], Floats]:
    """Names of the bones in the order of the file, and their values (T, C)."""
    names = _first_frame(path, data, begin, bones, skeleton)
    columns = 1 + sum(len(bones[n].dof) for n in names)
    flat = _flattened(data, begin, names, bones)
    try:
        values = None if flat is None else scan.numbers(path, flat, 0, columns)
    except InputError:  # the walk through the lines says which
        values = None
    if values is None:  # blank or indented lines, bones in another order …, or something is wrong
        values = scan.numbers(path, _in_order(path, data, begin, names, bones, skeleton), 0, columns)
    steps = np.diff(values[:, 0])
    if (wrong := np.flatnonzero(steps != 1)).size:
        k = int(wrong[0])
        line = _line_of_frame(data, begin, k + 1)
        raise InputError(
            f"{path}, line {line}: frame {values[k + 1, 0]:.0f} follows frame {values[k, 0]:.0f}"
        )
    return names, values[:, 1:]


def _line_of_frame(data: bytes, begin: int, frame: int) -> int:
    """Line of the number of the frame that is the `frame`th, from 0."""
    starts = [m.start() for m in re.finditer(rb"^[ \t]*\d+[ \t]*$", data[begin:], re.MULTILINE)]
    return text.line_of(data, begin + starts[min(frame, len(starts) - 1)])


def _first_frame(
    path: text.File, data: bytes, begin: int, bones: dict[str, Bone], skeleton: str
) -> list[str]:
    """Names of the bones of the first frame."""
    names: list[str] = []
    line = text.line_of(data, begin)
    at = data.find(b"\n", begin) + 1
    while at:
        end = data.find(b"\n", at)
        words = text.decode(data[at : len(data) if end < 0 else end]).split()
        line += 1
        if words and words[0].isdecimal():
            break
        if words and not words[0].startswith("#"):
            _check_line(path, line, words, bones, skeleton)
            if words[0] in names:
                raise InputError(f"{path}, line {line}: joint {words[0]!r} stands twice in a frame")
            names.append(words[0])
        at = end + 1
    if not names:
        raise InputError(f"{path}, line {line}: the first frame has no joints")
    return names


def _check_line(path: text.File, line: int, words: list[str], bones: dict[str, Bone], skeleton: str) -> None:
    if words[0] not in bones:
        raise InputError(
            f"{path}, line {line}: joint {text.shown(words[0])} is not in its skeleton {skeleton}"
        )
    found, expected = len(words) - 1, len(bones[words[0]].dof)
    if found != expected:
        s = "" if found == 1 else "s"
        raise InputError(
            f"{path}, line {line}: joint {words[0]!r} has {found} value{s}, its skeleton {skeleton} "
            f"gives it {expected}"
        )


@njit
def _blank(flat, names, bounds, counts):  # type: ignore[no-untyped-def]
    """Blank names and ends of lines within frames; whether every frame has the same lines as the first."""
    n = len(flat)
    per = len(counts)
    i = 0
    k = 0
    while i < n:
        if k > 0:
            for c in range(bounds[k - 1], bounds[k]):
                if i >= n or flat[i] != names[c]:
                    return False
                flat[i] = 32
                i += 1
            if i >= n or (flat[i] != 32 and flat[i] != 9):
                return False
        found = 0
        inside = False
        while flat[i] != 10:
            blank = flat[i] == 32 or flat[i] == 9
            if not blank and not inside:
                found += 1
            inside = not blank
            i += 1
        if found != counts[k]:
            return False
        k += 1
        if k < per:
            flat[i] = 32
        else:
            k = 0
        i += 1
    return k == 0


def _flattened(data: bytes, begin: int, names: list[str], bones: dict[str, Bone]) -> bytes | None:
    """The frames without names, a line each, if every frame has the same lines; None if not."""
    flat = np.frombuffer(data[begin:].rstrip() + b"\n", dtype=np.uint8).copy()
    raw = [_raw(name) for name in names]
    bounds = np.cumsum([0, *map(len, raw)])
    counts = np.array([1] + [len(bones[n].dof) for n in names])
    regular = _blank(flat, np.frombuffer(b"".join(raw), dtype=np.uint8), bounds, counts)
    return flat.tobytes() if regular else None


def _raw(name: str) -> bytes:
    """A bone's name as it stands in the file (names that are not UTF-8 were decoded as Latin-1)."""
    try:
        return name.encode("ascii")
    except UnicodeEncodeError:
        return name.encode()


def _in_order(
    path: text.File, data: bytes, begin: int, names: list[str], bones: dict[str, Bone], skeleton: str
) -> bytes:
    """The frames without names, a line each, from a file that is written unevenly; or what is wrong with
    it."""
    rows: list[bytes] = []
    frame: dict[str, bytes] = {}
    head = b""
    number = last = text.line_of(data, begin) - 1

    def close() -> None:
        if missing := [n for n in names if n not in frame]:
            raise InputError(f"{path}, line {last}: frame {head.decode()} ends without {missing[0]!r}")
        rows.append(b" ".join([head, *(frame[n] for n in names)]))

    for line in data[begin:].split(b"\n"):
        number += 1
        words = line.split(None, 1)
        if not words or words[0].startswith(b"#"):
            continue
        if len(words) == 1 and words[0].isdigit():
            if head:
                close()
            head, frame, last = words[0], {}, number
            continue
        name = text.decode(words[0])
        _check_line(path, number, text.decode(line).split(), bones, skeleton)
        if name in frame or name not in names:
            other = "stands twice in a frame" if name in frame else "is not in the first frame"
            raise InputError(f"{path}, line {number}: joint {name!r} {other}")
        for token in words[1].split():
            if text.real(token) is None:
                raise InputError(f"{path}, line {number}: {text.shown(token)} is not a finite number")
        frame[name], last = words[1].strip(), number
    close()
    return b"\n".join(rows)


def _motion(
    path: text.File, acclaim: Acclaim, names: list[str], values: Floats, degrees: bool, fps: float
) -> Motion:
    """L = C M C⁻¹ of all joints and frames."""
    n = len(acclaim.bones)
    columns = np.full((n, 3), -1, dtype=np.int64)
    axes = np.zeros((n, 3), dtype=np.int64)
    root = np.zeros((len(values), 3))
    translations = np.zeros((len(values), n, 3))
    moves = False
    column = 0
    by_name = {b.name: j for j, b in enumerate(acclaim.bones)}
    for name in names:
        j = by_name[name]
        bone = acclaim.bones[j]
        turns = [column + k for k, d in enumerate(bone.dof) if d[0] == "r"]
        # the first listed is applied first, so it stands last in the product
        for slot, c in enumerate(reversed(turns)):
            columns[j, slot] = c
            axes[j, slot] = "xyz".index(bone.dof[c - column][1])
        for k, d in enumerate(bone.dof):
            if d[0] == "t" and j == 0:
                root[:, "xyz".index(d[1])] = values[:, column + k] * acclaim.unit
            elif d[0] == "t":
                moves = True
                translations[:, j, "xyz".index(d[1])] = values[:, column + k] * acclaim.unit
        column += len(bone.dof)
    bases = np.array([b.axis for b in acclaim.bones])
    local = angles.rotations(values, columns, axes, degrees=degrees, bases=bases)
    if moves:
        translations = np.einsum("jab,tjb->tja", bases, translations)
    return Motion(acclaim.skeleton, fps, root, local, translations if moves else None, name=text.stem(path))


__all__ = ["FPS", "Acclaim", "Bone", "find_asf", "read", "read_asf"]
