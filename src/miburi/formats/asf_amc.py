"""Acclaim skeletons (.asf) and motions (.amc): the CMU and HDM05 databases.

Conventions
-----------
* An ASF gives each bone a direction and length in world axes at rest, and the axes C in which it turns ("axis 0 0 20
  XYZ": about x first, then y, then z, so C = Rz Ry Rx). An AMC gives the angles of its degrees of freedom, M, in the
  order of `dof`, the first applied first. A bone turns by L = C M C⁻¹ against its parent; its tail is the parent's
  tail + (product of L down to it) · direction · length.
* Here a joint sits where its bone begins, is called after the bone, and turns by L; so all frames are the world's at
  rest. Bones without children end in `ends`.
* Lengths: (1 / `length` of :units) inches, as in CMU's and HDM05's files; `unit` comes first.
* AMC names no rate: 120 frames/s, unless it says :SAMPLES-PER-SECOND or `fps` is given.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from miburi.errors import InputError
from miburi.formats import angles, text
from miburi.motion import Floats, Motion, Skeleton

FPS = 120.0
"""Frames per second of an AMC file that names none: the rate of the CMU and HDM05 databases."""


class Bone(NamedTuple):
    """One joint of an Acclaim skeleton."""

    name: str
    dof: tuple[str, ...]  # rx ry rz tx ty tz, in the order of the AMC's values
    axis: Floats  # (3, 3), C
    limits: tuple[tuple[float, float], ...]  # of each degree of freedom; (−inf, inf) where none is given


@dataclass(frozen=True)
class Acclaim:
    """A skeleton with what is needed to read its motions.

    Parameters
    ----------
    skeleton
        Metres.
    bones
        The root and the bones, in the order of the skeleton's joints.
    unit
        Metres per unit of the AMC's root positions.
    degrees
        Unit of angles where the AMC names none.
    """

    skeleton: Skeleton
    bones: tuple[Bone, ...]
    unit: float
    degrees: bool


class _Lines:
    """Lines of an ASF with their numbers, comments and blank ones left out."""

    def __init__(self, path: text.File, data: bytes) -> None:
        self.path = path
        rows = enumerate(text.decode(data).split("\n"), 1)
        self.rows = [(n, r.split()) for n, r in rows if r.strip() and not r.lstrip().startswith("#")]
        self.at = 0

    def __iter__(self) -> Iterator[list[str]]:
        while self.at < len(self.rows):
            self.at += 1
            yield self.rows[self.at - 1][1]

    def peek(self) -> list[str]:
        return self.rows[self.at][1] if self.at < len(self.rows) else []

    def fail(self, sentence: str) -> NoReturn:
        line = self.rows[min(max(self.at, 1), len(self.rows)) - 1][0] if self.rows else 1
        raise InputError(f"{self.path}, line {line}: {sentence}")

    def numbers(self, words: list[str], count: int, what: str) -> list[float]:
        try:
            values = [float(w) for w in words]
        except ValueError:
            values = []
        if len(values) != count or not np.isfinite(values).all():
            self.fail(f"found {text.shown(' '.join(words))}, expected {what}: {count} number{'s' * (count > 1)}")
        return values


def read_asf(path: text.File, *, unit: float | None = None) -> Acclaim:
    """Read an Acclaim skeleton, plain or gzipped.

    Parameters
    ----------
    unit
        Metres per unit of length; absent: (1 / `length` of :units) inches.

    Raises
    ------
    InputError
        The file is damaged or asks for what is not supported; the sentence names the line.
    """
    lines = _Lines(path, text.load(path))
    units = {"length": "1.0", "angle": "deg"}
    root: dict[str, list[str]] = {}
    bones: list[dict[str, list[str]]] = []
    parents: dict[str, str] = {}
    found = set()
    for words in lines:
        key = words[0].lower()
        found.add(key)
        if not key.startswith(":"):
            lines.fail(f"found {text.shown(' '.join(words))}, expected a section such as :bonedata: this is no ASF file")
        if key == ":units":
            units |= {w[0].lower(): " ".join(w[1:]) for w in _section(lines)}
        elif key == ":root":
            root = {w[0].lower(): w[1:] for w in _section(lines)}
        elif key == ":bonedata":
            bones = list(_bones(lines))
        elif key == ":hierarchy":
            parents = _parents(lines)
        else:  # :version, :name, :documentation, :skin and what else there may be say nothing about motion
            list(_section(lines))
    for section in (":root", ":bonedata", ":hierarchy"):
        if section not in found:
            lines.fail(f"the file ends without {section}")
    return _acclaim(lines, units, root, bones, parents, unit)


def _section(lines: _Lines) -> Iterator[list[str]]:
    """Lines up to the next section."""
    while lines.peek() and not lines.peek()[0].startswith(":"):
        yield next(iter(lines))


def _bones(lines: _Lines) -> Iterator[dict[str, list[str]]]:
    """The bones: key → words; `limits` go over several lines."""
    bone: dict[str, list[str]] | None = None
    for words in _section(lines):
        key = words[0].lower()
        if key == "begin":
            if bone is not None:
                lines.fail("found 'begin', expected 'end' of the bone before")
            bone = {}
            last = ""
        elif bone is None:
            lines.fail(f"found {text.shown(words[0])}, expected 'begin' of a bone")
        elif key == "end":
            missing = [k for k in ("name", "direction", "length", "axis") if k not in bone]
            if missing:
                lines.fail(f"bone {' '.join(bone.get('name', ['?']))!r} has no {missing[0]}")
            if len(bone["name"]) != 1:
                lines.fail(f"found the name {' '.join(bone['name'])!r}, expected one word")
            _check_bone(lines, bone)
            yield bone
            bone = None
        elif key.startswith("(") and last == "limits":
            bone["limits"] += words
        else:
            last = key
            bone[key] = words[1:]
    if bone is not None:
        lines.fail("the bone data end in the middle of a bone")


def _check_bone(lines: _Lines, bone: dict[str, list[str]]) -> None:
    """Numbers and degrees of freedom of one bone, while the line is known."""
    name = bone["name"][0]
    lines.numbers(bone["direction"], 3, f"the direction of {name!r}")
    (length,) = lines.numbers(bone["length"], 1, f"the length of {name!r}")
    if length < 0:
        lines.fail(f"bone {name!r} has the length {length}, expected at least 0")
    _axis(lines, bone["axis"], name, True)
    dof = [d.lower() for d in bone.get("dof", [])]
    if "l" in dof:
        lines.fail(f"bone {name!r} changes its length (dof l), which is not supported")
    if bad := [d for d in dof if not re.fullmatch("[rt][xyz]", d)] or [d for d in dof if dof.count(d) > 1]:
        lines.fail(f"bone {name!r} has the degree of freedom {bad[0]!r}, expected rx, ry, rz, tx, ty or tz, each once")
    _limits(lines, bone, name, len(dof))


def _limits(lines: _Lines, bone: dict[str, list[str]], name: str, dof: int) -> tuple[tuple[float, float], ...]:
    words = " ".join(bone.get("limits", [])).replace("(", " ").replace(")", " ").split()
    if not words:
        return ((-np.inf, np.inf),) * dof
    try:
        values = [float(w) for w in words]
    except ValueError:
        values = []
    if len(values) != 2 * dof or np.isnan(values).any():
        lines.fail(f"bone {name!r} has the limits {text.shown(' '.join(words))}, expected {dof} pairs of numbers")
    return tuple(zip(values[::2], values[1::2], strict=True))


def _axis(lines: _Lines, words: list[str], name: str, degrees: bool) -> Floats:
    """C of a bone: angles in the order of the letters, the first applied first."""
    order = words[-1].lower() if words else ""
    if sorted(order) != ["x", "y", "z"]:
        lines.fail(f"found {text.shown(' '.join(words))}, expected the axis of {name!r}: 3 numbers and an order as XYZ")
    values = dict(zip("xyz", lines.numbers(words[:-1], 3, f"the axis of {name!r}"), strict=True))
    # lower case: extrinsic, about the fixed axes one after the other
    rotation = Rotation.from_euler(order, [values[a] for a in order], degrees=degrees)
    matrix: Floats = rotation.as_matrix()
    return matrix


def _parents(lines: _Lines) -> dict[str, str]:
    """Child → parent."""
    parents: dict[str, str] = {}
    for words in _section(lines):
        if words[0].lower() in ("begin", "end") and len(words) == 1:
            continue
        for child in words[1:]:
            if child in parents or child == "root":
                lines.fail(f"bone {child!r} has two parents" if child != "root" else "the root has a parent")
            parents[child] = words[0]
    return parents


def _acclaim(
    lines: _Lines,
    units: dict[str, str],
    root: dict[str, list[str]],
    bones: list[dict[str, list[str]]],
    parents: dict[str, str],
    unit: float | None,
) -> Acclaim:
    (length,) = lines.numbers([units["length"]], 1, "the length of :units")
    if length <= 0:
        lines.fail(f"the length of :units is {length}, expected above 0")
    metres = 0.0254 / length if unit is None else unit
    if units["angle"].lower()[:3] not in ("deg", "rad"):
        lines.fail(f"the angle of :units is {units['angle']!r}, expected deg or rad")
    degrees = units["angle"].lower()[:3] == "deg"
    by_name = {b["name"][0]: b for b in bones}
    if len(by_name) != len(bones):
        twice = next(n for n in by_name if sum(b["name"][0] == n for b in bones) > 1)
        lines.fail(f"bone {twice!r} stands twice")
    for child, parent in parents.items():
        for name in (child, parent):
            if name != "root" and name not in by_name:
                lines.fail(f"the hierarchy names {name!r}, which the bone data do not have")
    for name in by_name:
        if name not in parents:
            lines.fail(f"bone {name!r} is not in the hierarchy")
    order = _walk(lines, parents)
    tails = {
        n: np.array(lines.numbers(b["direction"], 3, "a direction"))
        * lines.numbers(b["length"], 1, "a length")[0]
        * metres
        for n, b in by_name.items()
    }
    place = np.array(lines.numbers(root.get("position", ["0"] * 3), 3, "the root's position")) * metres
    kept = {"root": place} | {n: np.zeros(3) if parents[n] == "root" else tails[parents[n]] for n in order[1:]}
    leaves = [n for n in order[1:] if n not in parents.values()]
    skeleton = Skeleton(
        tuple(order),
        np.array([-1] + [order.index(parents[n]) for n in order[1:]]),
        np.array([kept[n] for n in order]),
        text.stem(lines.path),
        np.array([order.index(n) for n in leaves], dtype=np.int32),
        np.array([tails[n] for n in leaves]).reshape(-1, 3),
    )
    found = [_root_bone(lines, root, degrees)]
    for name in order[1:]:
        bone = by_name[name]
        dof = tuple(d.lower() for d in bone.get("dof", []))
        limits = _limits(lines, bone, name, len(dof))
        found.append(Bone(name, dof, _axis(lines, bone["axis"], name, degrees), limits))
    return Acclaim(skeleton, tuple(found), metres, degrees)


def _root_bone(lines: _Lines, root: dict[str, list[str]], degrees: bool) -> Bone:
    dof = tuple(d.lower() for d in root.get("order", "TX TY TZ RX RY RZ".split()))
    if any(not re.fullmatch("[rt][xyz]", d) for d in dof) or len(set(dof)) != len(dof):
        lines.fail(f"the root's order is {' '.join(dof)!r}, expected TX TY TZ RX RY RZ in some order")
    axis = _axis(lines, [*root.get("orientation", ["0"] * 3), *root.get("axis", ["XYZ"])], "root", degrees)
    return Bone("root", dof, axis, ((-np.inf, np.inf),) * len(dof))


def _walk(lines: _Lines, parents: dict[str, str]) -> list[str]:
    """The root and its bones in the order of a walk through the tree."""
    children: dict[str, list[str]] = {}
    for child, parent in parents.items():
        children.setdefault(parent, []).append(child)
    order, stack = [], ["root"]
    while stack:
        name = stack.pop()
        order.append(name)
        stack.extend(reversed(children.get(name, [])))
    if lost := [n for n in parents if n not in order]:
        lines.fail(f"bone {lost[0]!r} does not hang on the root")
    return order


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
        f"{path}: its skeleton is missing: looked for {subject}.asf and {subject}.asf.gz in {folder}, which has {several}; "
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
        skeleton if isinstance(skeleton, Acclaim) else read_asf(find_asf(path) if skeleton is None else skeleton, unit=unit)
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
                f"{path}, line {line}: found {text.shown(' '.join(words))}, expected :FULLY-SPECIFIED, :DEGREES, :RADIANS "
                "or the number of a frame"
            )
        at = end + 1
    raise InputError(f"{path}, line {text.line_of(data, len(data.rstrip()))}: the file ends before the first frame")


def _frames(
    path: text.File, data: bytes, begin: int, bones: dict[str, Bone], skeleton: str
) -> tuple[list[str], Floats]:
    """Names of the bones in the order of the file, and their values (T, C)."""
    names = _first_frame(path, data, begin, bones, skeleton)
    columns = 1 + sum(len(bones[n].dof) for n in names)
    flat = _flattened(data, begin, names, bones)
    if flat is None:  # blank or indented lines, bones in another order …: put it in order line by line
        flat = _in_order(path, data, begin, names, bones, skeleton)
    values = text.numbers(path, flat, 0, columns)
    steps = np.diff(values[:, 0])
    if (wrong := np.flatnonzero(steps != 1)).size:
        k = int(wrong[0])
        line = _line_of_frame(data, begin, k + 1)
        raise InputError(f"{path}, line {line}: frame {values[k + 1, 0]:.0f} follows frame {values[k, 0]:.0f}")
    return names, values[:, 1:]


def _line_of_frame(data: bytes, begin: int, frame: int) -> int:
    """Line of the number of the frame that is the `frame`th, from 0."""
    starts = [m.start() for m in re.finditer(rb"^[ \t]*\d+[ \t]*$", data[begin:], re.MULTILINE)]
    return text.line_of(data, begin + starts[min(frame, len(starts) - 1)])


def _first_frame(path: text.File, data: bytes, begin: int, bones: dict[str, Bone], skeleton: str) -> list[str]:
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
        raise InputError(f"{path}, line {line}: joint {text.shown(words[0])} is not in its skeleton {skeleton}")
    found, expected = len(words) - 1, len(bones[words[0]].dof)
    if found != expected:
        s = "" if found == 1 else "s"
        raise InputError(
            f"{path}, line {line}: joint {words[0]!r} has {found} value{s}, its skeleton {skeleton} gives it {expected}"
        )


def _flattened(data: bytes, begin: int, names: list[str], bones: dict[str, Bone]) -> bytes | None:
    """The frames without names, a line each, if every frame has the same lines; None if not.

    All bytes are looked at as arrays: line k of each frame must begin with the k-th name and a blank.
    """
    body = data[begin:].rstrip() + b"\n"
    flat = np.frombuffer(body, dtype=np.uint8).copy()
    ends = np.flatnonzero(flat == 10)
    per = len(names) + 1
    if len(ends) % per:
        return None
    starts = np.concatenate([[0], ends[:-1] + 1]).reshape(-1, per)
    ends = ends.reshape(-1, per)
    for k, name in enumerate(names, 1):
        raw = np.frombuffer(_raw(name), dtype=np.uint8)
        if (ends[:, k] - starts[:, k] <= len(raw)).any():
            return None
        at = starts[:, k, None] + np.arange(len(raw))
        after = flat[starts[:, k] + len(raw)]
        if (flat[at] != raw).any() or ((after != 32) & (after != 9)).any():
            return None
        flat[at] = 32
    flat[ends[:, :-1]] = 32
    return flat.tobytes() if _even(flat, starts, ends, names, bones) else None


def _even(
    flat: NDArray[np.uint8], starts: NDArray[np.int64], ends: NDArray[np.int64], names: list[str], bones: dict[str, Bone]
) -> bool:
    """Whether every line has as many values as its bone has degrees of freedom."""
    blank = (flat == 32) | (flat == 9) | (flat == 10)
    begins = ~blank
    begins[1:] &= blank[:-1]
    tokens = np.concatenate([[0], np.cumsum(begins)])
    expected = np.array([1] + [len(bones[n].dof) for n in names])
    counts: NDArray[np.int64] = tokens[ends] - tokens[starts]
    return bool((counts == expected).all())


def _raw(name: str) -> bytes:
    """A bone's name as it stands in the file (names that are not UTF-8 were decoded as Latin-1)."""
    try:
        return name.encode("ascii")
    except UnicodeEncodeError:
        return name.encode()


def _in_order(
    path: text.File, data: bytes, begin: int, names: list[str], bones: dict[str, Bone], skeleton: str
) -> bytes:
    """The frames without names, a line each, from a file that is written unevenly; or what is wrong with it."""
    rows: list[bytes] = []
    frame: dict[str, bytes] = {}
    head = b""
    number = text.line_of(data, begin) - 1

    def close() -> None:
        if missing := [n for n in names if n not in frame]:
            raise InputError(f"{path}, line {number}: frame {head.decode()} ends without {missing[0]!r}")
        rows.append(b" ".join([head, *(frame[n] for n in names)]))

    for line in data[begin:].split(b"\n"):
        number += 1
        words = line.split(None, 1)
        if not words or words[0].startswith(b"#"):
            continue
        if len(words) == 1 and words[0].isdigit():
            if head:
                close()
            head, frame = words[0], {}
            continue
        name = text.decode(words[0])
        _check_line(path, number, text.decode(line).split(), bones, skeleton)
        if name in frame or name not in names:
            other = "stands twice in a frame" if name in frame else "is not in the first frame"
            raise InputError(f"{path}, line {number}: joint {name!r} {other}")
        for token in words[1].split():
            try:
                good = bool(np.isfinite(float(token)))
            except ValueError:
                good = False
            if not good:
                raise InputError(f"{path}, line {number}: {text.shown(token)} is not a finite number")
        frame[name] = words[1].strip()
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
    m = angles.rotations(values, columns, axes, degrees=degrees)
    # C M C⁻¹ turns M's axis by C and leaves its angle
    c = np.array([b.axis for b in acclaim.bones])
    local = np.concatenate([np.einsum("jab,tjb->tja", c, m[..., :3]), m[..., 3:]], axis=-1)
    if moves:
        translations = np.einsum("jab,tjb->tja", c, translations)
    return Motion(acclaim.skeleton, fps, root, local, translations if moves else None, name=text.stem(path))
