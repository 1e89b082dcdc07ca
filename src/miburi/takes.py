"""Takes of a corpus before they are read, and the settings of their groups.

A group's settings come as a mapping, the keys of `config.Group`, with `{recordings}` filled in.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from miburi.errors import InputError
from miburi.paths import stem

Group = Mapping[str, Any]

COMPANIONS = ("skeleton", "calibration", "columns")
"""Keys of a group that name files which reading a take needs."""


@dataclass(frozen=True)
class Take:
    """A recording before it is read.

    Parameters
    ----------
    name
        Of the take.
    subject
        Who performs; one name for all where the corpus does not tell.
    recording
        Path of the file.
    group
        Place of its group in `groups`.
    seconds
        About how long it is.
    """

    name: str
    subject: str
    recording: str
    group: int
    seconds: float


def matched(expression: str, group: str, path: str, where: str) -> str:
    """What a named group of an expression finds in a path; "" for no expression."""
    if not expression:
        return ""
    found = re.search(expression, path)
    if found is None:
        raise InputError(f"config: {where}.{group}: {expression!r} does not match {path!r}")
    return found.group(group)


def filled(template: str, take: Take, group: Group) -> str:
    """A path of a group's settings with `{subject}` and `{take}` filled in."""
    subject = group["stand_ins"].get(take.subject, take.subject)
    return template.replace("{subject}", subject).replace("{take}", take.name)


def label_file(take: Take, group: Group) -> str:
    """Path of a hand take's labels."""
    if group["labels"]:
        return filled(group["labels"], take, group)
    recording = Path(take.recording)
    return str(recording.with_name(stem(recording) + ".lab"))
