"""Acclaim skeletons (.asf): read by `miburi.formats.asf_amc`, which says what their conventions are."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple, NoReturn

import numpy as np
from scipy.spatial.transform import Rotation

from miburi.errors import InputError
from miburi.formats import text
from miburi.motion import Floats, Skeleton


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
            self.fail(
                f"found {text.shown(' '.join(words))}, expected {what}: {count} number{'s' * (count > 1)}"
            )
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
            lines.fail(
                f"found {text.shown(' '.join(words))}, expected a section such as :bonedata: this is "
                "no ASF file"
            )
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
            bone, last = {}, ""
            places: dict[str, int] = {}
        elif bone is None:
            lines.fail(f"found {text.shown(words[0])}, expected 'begin' of a bone")
        elif key == "end":
            missing = [k for k in ("name", "direction", "length", "axis") if k not in bone]
            if missing:
                lines.fail(f"bone {' '.join(bone.get('name', ['?']))!r} has no {missing[0]}")
            if len(bone["name"]) != 1:
                lines.fail(f"found the name {' '.join(bone['name'])!r}, expected one word")
            _check_bone(lines, bone, places)
            yield bone
            bone = None
        elif key.startswith("(") and last == "limits":
            bone["limits"] += words
        else:
            last = key
            places[key] = lines.at
            bone[key] = words[1:]
    if bone is not None:
        lines.fail("the bone data end in the middle of a bone")


def _check_bone(lines: _Lines, bone: dict[str, list[str]], places: dict[str, int]) -> None:
    """Numbers and degrees of freedom of one bone, while their lines are known."""
    end = lines.at
    name = bone["name"][0]
    lines.at = places["direction"]
    lines.numbers(bone["direction"], 3, f"the direction of {name!r}")
    lines.at = places["length"]
    (length,) = lines.numbers(bone["length"], 1, f"the length of {name!r}")
    if length < 0:
        lines.fail(f"bone {name!r} has the length {length}, expected at least 0")
    lines.at = places["axis"]
    _axis(lines, bone["axis"], name, True)
    lines.at = places.get("dof", end)
    dof = [d.lower() for d in bone.get("dof", [])]
    if "l" in dof:
        lines.fail(f"bone {name!r} changes its length (dof l), which is not supported")
    if bad := [d for d in dof if not re.fullmatch("[rt][xyz]", d)] or [d for d in dof if dof.count(d) > 1]:
        lines.fail(
            f"bone {name!r} has the degree of freedom {bad[0]!r}, expected rx, ry, rz, tx, ty or tz, "
            "each once"
        )
    lines.at = places.get("limits", end)
    _limits(lines, bone, name, len(dof))
    lines.at = end


def _limits(
    lines: _Lines, bone: dict[str, list[str]], name: str, dof: int
) -> tuple[tuple[float, float], ...]:
    words = " ".join(bone.get("limits", [])).replace("(", " ").replace(")", " ").split()
    if not words:
        return ((-np.inf, np.inf),) * dof
    try:
        values = [float(w) for w in words]
    except ValueError:
        values = []
    if len(values) != 2 * dof or np.isnan(values).any():
        lines.fail(
            f"bone {name!r} has the limits {text.shown(' '.join(words))}, expected {dof} pairs of numbers"
        )
    return tuple(zip(values[::2], values[1::2], strict=True))


def _axis(lines: _Lines, words: list[str], name: str, degrees: bool) -> Floats:
    """C of a bone: angles in the order of the letters, the first applied first."""
    order = words[-1].lower() if words else ""
    if sorted(order) != ["x", "y", "z"]:
        lines.fail(
            f"found {text.shown(' '.join(words))}, expected the axis of {name!r}: 3 numbers and an "
            "order as XYZ"
        )
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
    kept = {"root": place} | {
        n: np.zeros(3) if parents[n] == "root" else tails[parents[n]] for n in order[1:]
    }
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
    dof = tuple(d.lower() for d in root.get("order", ["tx", "ty", "tz", "rx", "ry", "rz"]))
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
