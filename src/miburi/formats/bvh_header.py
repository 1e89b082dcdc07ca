"""The hierarchy of a BVH file: its joints, their offsets and channels."""

from __future__ import annotations

import logging
import re
from dataclasses import dataclass
from typing import NoReturn

from miburi.errors import InputError
from miburi.formats import text

log = logging.getLogger(__name__)

MARK = " \t "
"""Stands after HIERARCHY in files that `write` made, unseen by other readers: centimetres, Y up, and an End
Site whose OFFSET is `0 0 0` only closes a joint without ends."""

_TOKEN = re.compile(rb"[{}]|[^\s{}]+")


@dataclass
class Header:
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
            value = text.real(token)
            if value is None:
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
            raise InputError(
                f"{tokens.path}, line {tokens.line()}: joint {joint!r} has the channel {word} twice"
            )
        found.append(channel)
    return found


def parse(path: text.File, data: bytes) -> Header:
    """Parse everything before MOTION."""
    tokens = _Tokens(path, data)
    if (first := tokens.next("HIERARCHY")).upper() != "HIERARCHY":
        tokens.fail(first, "HIERARCHY: this is no BVH file")
    found = Header([], [], [], [], [], [], data.split(b"\n", 1)[0].endswith(b"HIERARCHY" + MARK.encode()))
    open_: list[int] = []
    seen: dict[str, int] = {}
    while not found.joints or open_ or tokens.at < len(tokens.matches):
        word = tokens.next("'}', JOINT, End Site, OFFSET or CHANNELS" if found.joints else "ROOT")
        key = word.upper()
        if key == "ROOT" and found.joints:
            name = tokens.name()
            raise InputError(
                f"{path}, line {tokens.line()}: a second ROOT {name!r}; one skeleton a file can be "
                "read, split the file"
            )
        if key in ("ROOT", "JOINT") and bool(open_) == (key == "JOINT"):
            name = tokens.name()
            seen[name] = seen.get(name, 0) + 1
            while seen[name] > 1 and f"{name}.{seen[name]}" in seen:
                seen[name] += 1
            tokens.brace()
            unique = name if seen[name] == 1 else f"{name}.{seen[name]}"
            if unique != name:
                log.info("%s, line %d: another joint %r is called %r", path, tokens.line(), name, unique)
            _joint(tokens, found, unique, open_)
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


def _joint(tokens: _Tokens, found: Header, name: str, open_: list[int]) -> None:
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


def _sites_are_ends(h: Header) -> Header:
    """Leaves without channels that are called Site are ends in disguise."""
    inner = {*h.parents, *h.ends}
    sites = [
        j
        for j, name in enumerate(h.joints)
        if re.fullmatch(r"(end ?)?site(\.\d+)?", name.lower())
        and not h.channels[j]
        and j not in inner
        and j > 0
    ]
    if not sites:
        return h
    rows = sorted([*zip(h.ends, h.end_offsets, strict=True), *((h.parents[j], h.offsets[j]) for j in sites)])
    kept = [j for j in range(len(h.joints)) if j not in set(sites)]
    new = {old: k for k, old in enumerate(kept)} | {-1: -1}
    return Header(
        [h.joints[j] for j in kept],
        [new[h.parents[j]] for j in kept],
        [h.offsets[j] for j in kept],
        [h.channels[j] for j in kept],
        [new[p] for p, _ in rows],
        [o for _, o in rows],
        h.marked,
    )
