"""Corpora: which takes there are, which shard each belongs to, how each is read and what happens in it.

Everything here is known before any job runs: from the plan of a simulation, the table of the CMU database or the
files in a folder.
"""

from __future__ import annotations

import csv
import glob
import hashlib
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from miburi import config as settings
from miburi.errors import InputError
from miburi.formats import text
from miburi.formats.annotations import Annotation, read_annotations
from miburi.motion import Motion

CMU_TAKES = "config/cmu/takes.tsv"
CMU_ANNOTATIONS = "config/cmu/annotations.tsv"

# Bytes of one second of motion, roughly; only the sizes of jobs depend on it.
_BYTES = {".amc": 96e3, ".bvh": 60e3, ".csv": 3e3}
_COMPRESSED = 0.3


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


def groups(name: str, corpus: settings.Corpus) -> list[settings.Group]:
    """The groups of a corpus; a simulated or fetched corpus has one, in data/raw/{corpus}."""
    if corpus.groups:
        return list(corpus.groups)
    folder = f"data/raw/{name}"
    if corpus.perform == "janken":
        return [settings.Group(folder=folder, files=["*.csv"], calibration=f"{folder}/wearer.yaml")]
    if corpus.perform == "everyday":
        return [settings.Group(folder=folder, files=["*.bvh"], annotations=f"{folder}/annotations.tsv")]
    rates = {row["take"]: float(row["fps"]) for row in _cmu(corpus.fetch)}
    return [
        settings.Group(
            folder=folder,
            files=["*.amc"],
            skeleton=folder + "/{subject}.asf",
            annotations=CMU_ANNOTATIONS,
            fps=120.0,
            rates={take: fps for take, fps in rates.items() if fps != 120.0},
        )
    ]


def takes(name: str, config: settings.Config) -> list[Take]:
    """The takes of a corpus, sorted by name.

    Raises
    ------
    InputError
        A folder or a file is missing, or two files hold the same take.
    """
    corpus = config.corpora[name]
    if corpus.perform:
        found = _performed(name, corpus, config.seed)
    elif corpus.fetch:
        found = [
            Take(r["take"], r["subject"], f"data/raw/{name}/{r['take']}.amc", 0, float(r["seconds"]))
            for r in _cmu(corpus.fetch)
        ]
    else:
        found = [
            take for i, group in enumerate(corpus.groups) for take in _files(f"corpora.{name}.groups.{i}", i, group, config)
        ]
    return sorted(_once(name, found, corpus.once), key=lambda t: t.name)


def _performed(name: str, corpus: settings.Corpus, seed: int) -> list[Take]:
    folder = f"data/raw/{name}"
    if corpus.perform == "janken":
        from miburi.perform import janken

        plan = janken.plan(seed, small=corpus.small)
        return [Take(p.take, "wearer", f"{folder}/{p.take}.csv", 0, p.seconds) for p in plan]
    from miburi.perform import bodies

    return [Take(p.take, p.performer, f"{folder}/{p.take}.bvh", 0, p.seconds) for p in bodies.plan(seed, small=corpus.small)]


def _cmu(subjects: Sequence[str]) -> list[dict[str, str]]:
    """Rows of the table of the CMU database's takes, of some subjects."""
    with open(CMU_TAKES, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    known = {row["subject"] for row in rows}
    for subject in subjects:
        if subject not in known:
            raise InputError(f"config: fetch: {CMU_TAKES} has no subject {subject!r}; it has {', '.join(sorted(known))}")
    return [row for row in rows if row["subject"] in subjects]


def _files(where: str, number: int, group: settings.Group, config: settings.Config) -> list[Take]:
    """Takes of a group, by its patterns."""
    folder = filled(group.folder, config)
    if not os.path.isdir(folder):
        raise InputError(f"config: {where}.folder: there is no folder {folder!r}{_hint(group.folder, config)}")
    excluded = {p for pattern in group.exclude for p in glob.glob(pattern, root_dir=folder, recursive=True)}
    found = []
    for pattern in group.files:
        paths = sorted(set(glob.glob(pattern, root_dir=folder, recursive=True)) - excluded)
        if not paths:
            raise InputError(f"config: {where}.files: no file in {folder!r} matches {pattern!r}{_hint(group.folder, config)}")
        for path in paths:
            name = _matched(group.take, "take", path, where) or text.stem(path.replace("/", "-"))
            subject = _matched(group.subject, "subject", path, where) or "all"
            full = os.path.join(folder, path)
            found.append(Take(name, subject, full, number, _seconds(full)))
    return found


def _hint(template: str, config: settings.Config) -> str:
    if "{recordings}" not in template:
        return ""
    return (
        f"; real recordings are looked for in {config.recordings!r} (config key `recordings`), "
        "data/README.md says where to get them"
    )


def filled(template: str, config: settings.Config, **names: str) -> str:
    """A path of the config with `{recordings}` and other names filled in."""
    for key, value in {"recordings": config.recordings, **names}.items():
        template = template.replace("{" + key + "}", value)
    return template


def _matched(expression: str, group: str, path: str, where: str) -> str:
    if not expression:
        return ""
    found = re.search(expression, path)
    if found is None:
        raise InputError(f"config: {where}.{group}: {expression!r} does not match {path!r}")
    return found.group(group)


def _seconds(path: str) -> float:
    share = _COMPRESSED if path.endswith(".gz") else 1.0
    return os.path.getsize(path) / (_BYTES.get(text.suffix(path), 30e3) * share)


def _once(name: str, found: Iterable[Take], once: bool) -> list[Take]:
    first: dict[str, Take] = {}
    for take in found:
        other = first.setdefault(take.name, take)
        if other is not take and not once:
            raise InputError(
                f"config: corpora.{name}: take {take.name!r} is in {other.recording} and in {take.recording}; "
                "tell them apart by `take`, or say `once: true` to read the first"
            )
    return list(first.values())


def shards(found: Sequence[Take], seconds: float) -> dict[str, list[Take]]:
    """Put takes into shards of at most about `seconds`, so that a change of one take touches one shard.

    Subjects are told apart by the bits of a hash of their names, as many as are needed; where one subject is too
    much, its takes by the bits of theirs. A shard that grows too big splits in two and the others stay.

    Returns
    -------
    name → takes
        Names are the bits, `all` where one shard holds everything.
    """
    result: dict[str, list[Take]] = {}

    def split(part: list[Take], bits: str, by_take: bool, depth: int) -> None:
        one = len({t.subject for t in part}) == 1
        if sum(t.seconds for t in part) <= seconds or len(part) == 1:
            result[bits or "all"] = part
            return
        if one and not by_take:
            split(part, f"{bits}-" if bits else "", True, 0)
            return
        sides: dict[str, list[Take]] = {"0": [], "1": []}
        for take in part:
            sides[_bit(take.name if by_take else take.subject, depth)].append(take)
        for bit, side in sides.items():
            if side:
                split(side, bits + bit, by_take, depth + 1)

    split(list(found), "", False, 0)
    return {name.rstrip("-"): part for name, part in sorted(result.items())}


def _bit(name: str, depth: int) -> str:
    digest = int.from_bytes(hashlib.sha256(name.encode()).digest(), "big")
    return str(digest >> (255 - depth) & 1)


def read_take(take: Take, group: settings.Group, recordings: str) -> Motion:
    """Read a take as its group says; errors as `formats.read`."""
    from miburi import formats

    names = {"recordings": recordings, "subject": group.stand_ins.get(take.subject, take.subject)}
    paths = {}
    for key in ("skeleton", "calibration", "columns"):
        path = getattr(group, key)
        for name, value in names.items():
            path = path.replace("{" + name + "}", value)
        paths[key] = path
    rate = group.rates.get(take.name, group.fps)
    return formats.read(take.recording, corpus=group.model_copy(update={**paths, "fps": rate}))


def companions(take: Take, group: settings.Group, config: settings.Config) -> list[str]:
    """Files beside the recording that reading it needs and that the config names: skeleton, calibration, columns."""
    subject = group.stand_ins.get(take.subject, take.subject)
    return [filled(p, config, subject=subject) for p in (group.skeleton, group.calibration, group.columns) if p]


def label_file(take: Take, group: settings.Group, recordings: str) -> str:
    """Path of a hand take's labels."""
    if group.labels:
        return group.labels.replace("{recordings}", recordings).replace("{take}", take.name)
    recording = Path(take.recording)
    return str(recording.with_name(text.stem(recording) + ".lab"))


def annotate_hand(
    found: Sequence[Take], parts: Sequence[settings.Group], lengths: Mapping[str, tuple[int, float]], recordings: str
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
    from miburi.formats.labels import read_labels

    rows = []
    for take in found:
        if take.name not in lengths:
            continue
        frames, fps = lengths[take.name]
        group = parts[take.group]
        path = label_file(take, group, recordings)
        if not os.path.exists(path):
            raise InputError(f"{path}: there is no such file; it should hold the labels of the take {take.name!r}")
        for start, end, label in read_labels(path, fps=fps, unit=group.label_unit, frames=frames):
            rows.append(_annotation(take, start, end, fps, label))
    return rows


def annotate_bodies(
    found: Sequence[Take], parts: Sequence[settings.Group], lengths: Mapping[str, tuple[int, float]], recordings: str
) -> list[Annotation]:
    """Keywords of takes: of the whole take from its path, or of intervals from annotation files."""
    rows = []
    for number, group in enumerate(parts):
        mine = {t.name: t for t in found if t.group == number and t.name in lengths}
        folder = group.folder.replace("{recordings}", recordings)
        for take in mine.values():
            frames, fps = lengths[take.name]
            if group.keyword:
                path = os.path.relpath(take.recording, folder)
                rows.append(_annotation(take, 0, frames, fps, _matched(group.keyword, "keyword", path, "groups")))
        if group.annotations:
            path = group.annotations.replace("{recordings}", recordings)
            for line, row in enumerate(read_annotations(path), 2):
                if row.take not in mine:
                    continue
                frames, fps = lengths[row.take]
                start, end = round(row.start_s * fps), min(round(row.end_s * fps), frames)
                # one frame too long is rounding, more is another recording
                if start >= end or row.end_s * fps > frames + max(1.5, 0.1 * fps):
                    raise InputError(
                        f"{path}, line {line}: {row.keyword!r} from {row.start_s:g} to {row.end_s:g} s lies outside the "
                        f"take {row.take!r} of {frames / fps:g} s"
                    )
                rows.append(_annotation(mine[row.take], start, end, fps, row.keyword))
    return sorted(rows, key=lambda r: (r.take, r.start_s, r.end_s, r.keyword))


def _annotation(take: Take, start: int, end: int, fps: float, keyword: str) -> Annotation:
    more = {"start_frame": str(start), "end_frame": str(end), "subject": take.subject}
    return Annotation(take.name, start / fps, end / fps, keyword, more)
