"""Takes of a corpus: how each is read, and what happens in it.

A group's settings come as a mapping, the keys of `config.Group`, with `{recordings}` filled in.
"""

from __future__ import annotations

import csv
import logging
import os
from collections.abc import Mapping, Sequence
from types import SimpleNamespace

from miburi import formats
from miburi.errors import InputError
from miburi.formats.annotations import Annotation, read_annotations
from miburi.formats.labels import read_labels
from miburi.formats.plausibility import rest_frames
from miburi.motion import Motion
from miburi.takes import COMPANIONS, Group, Take, filled, label_file, matched

log = logging.getLogger(__name__)


def read_take(take: Take, group: Group) -> Motion:
    """Read a take as its group says; errors as `formats.read`."""
    chosen = dict(group)
    for key in COMPANIONS:
        chosen[key] = filled(chosen[key], take, group)
    chosen["fps"] = group["rates"].get(take.name, group["fps"])
    motion = formats.read(take.recording, corpus=SimpleNamespace(**chosen))
    if group["skip_frames"] >= len(motion):
        raise InputError(f"{take.recording}: has {len(motion)} frames, skip_frames is {group['skip_frames']}")
    motion = motion[group["skip_frames"] :] if group["skip_frames"] else motion
    if group["drop_rest_pose"] and motion.angles is None and (rest := rest_frames(motion)):
        log.info("%s: %d leading frames are a rest pose and left out", take.recording, rest)
        return motion[rest:]
    return motion


def annotate_hand(
    found: Sequence[Take], parts: Mapping[int, Group], lengths: Mapping[str, tuple[int, float]]
) -> list[Annotation]:
    """Labels of takes as annotations, with the columns `start_frame` and `end_frame` (exclusive).

    Parameters
    ----------
    lengths
        Take → frames and frames per second; takes that are not there are left out.

    Raises
    ------
    InputError
        A label file is missing or damaged.
    """
    rows = []
    for take in found:
        if take.name not in lengths:
            continue
        frames, fps = lengths[take.name]
        group = parts[take.group]
        path = label_file(take, group)
        if not os.path.exists(path):
            raise InputError(
                f"{path}: there is no such file; it should hold the labels of the take {take.name!r}"
            )
        for start, end, label in read_labels(path, fps=fps, unit=group["label_unit"], frames=frames):
            rows.append(_annotation(take, start, end, fps, label))
    return rows


def annotate_bodies(
    found: Sequence[Take], parts: Mapping[int, Group], lengths: Mapping[str, tuple[int, float]]
) -> list[Annotation]:
    """Keywords of takes: of the whole take from its path, or of intervals from annotation files."""
    rows = []
    for number, group in sorted(parts.items()):
        mine = {t.name: t for t in found if t.group == number and t.name in lengths}
        for take in mine.values():
            frames, fps = lengths[take.name]
            if group["keyword"]:
                path = os.path.relpath(take.recording, group["folder"])
                rows.append(
                    _annotation(take, 0, frames, fps, matched(group["keyword"], "keyword", path, "groups"))
                )
        if group["keywords"]:
            for name, keyword in read_keywords(group["keywords"]):
                if name in mine:
                    rows.append(_annotation(mine[name], 0, *lengths[name], keyword))
        if group["annotations"]:
            path = group["annotations"]
            for row in read_annotations(path):
                if row.take not in mine:
                    continue
                frames, fps = lengths[row.take]
                start, end = round(row.start_s * fps), min(round(row.end_s * fps), frames)
                # one frame too long is rounding, more is another recording
                if start >= end or row.end_s * fps > frames + max(1.5, 0.1 * fps):
                    raise InputError(
                        f"{path}: {row.keyword!r} from {row.start_s:g} to {row.end_s:g} s lies outside the take "
                        f"{row.take!r} of {frames / fps:g} s"
                    )
                rows.append(_annotation(mine[row.take], start, end, fps, row.keyword))
    return sorted(rows, key=lambda r: (r.take, r.start_s, r.end_s, r.keyword))


def read_keywords(path: str) -> list[tuple[str, str]]:
    """A TSV of takes and the keywords of the whole of them."""
    with open(path, encoding="utf-8", newline="") as file:
        table = csv.DictReader(file, delimiter="\t")
        for column in ("take", "keyword"):
            if column not in (table.fieldnames or []):
                raise InputError(f"{path}, line 1: the column {column!r} is missing")
        return [(row["take"], row["keyword"]) for row in table]


def _annotation(take: Take, start: int, end: int, fps: float, keyword: str) -> Annotation:
    more = {"start_frame": str(start), "end_frame": str(end), "subject": take.subject}
    return Annotation(take.name, start / fps, end / fps, keyword, more)
