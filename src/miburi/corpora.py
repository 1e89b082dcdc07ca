"""Corpora: which takes there are and which shard each belongs to.

Everything here is known before any job runs: from the plan of a simulation, the table of the CMU database or the
files in a folder.
"""

from __future__ import annotations

import csv
import glob
import hashlib
import os
from collections.abc import Iterable, Sequence

from miburi import config as settings
from miburi.errors import InputError
from miburi.paths import stem, suffix
from miburi.takes import Take, matched

CMU_TAKES = "config/cmu/takes.tsv"
CMU_KEYWORDS = "config/cmu/keywords.tsv"

# Bytes of one second of motion, roughly; only the sizes of jobs depend on it.
_BYTES = {".amc": 96e3, ".bvh": 60e3, ".csv": 3e3}
_COMPRESSED = 0.3
_CMU_SECONDS = 17.0


def groups(name: str, corpus: settings.Corpus) -> list[settings.Group]:
    """The groups of a corpus; a simulated or fetched corpus has one, in data/raw/{corpus}."""
    if corpus.groups:
        return list(corpus.groups)
    folder = f"data/raw/{name}"
    if corpus.perform == "janken":
        return [settings.Group(folder=folder, files=["*.csv"], calibration=f"{folder}/wearer.yaml")]
    if corpus.perform == "everyday":
        return [
            settings.Group(
                folder=folder, files=["*.bvh"], annotations=f"{folder}/annotations.tsv", bounds=["*"]
            )
        ]
    rates = {row["take"]: float(row["fps"]) for row in _cmu(corpus.fetch)}
    return [
        settings.Group(
            folder=folder,
            files=["*.amc"],
            skeleton=folder + "/{subject}.asf",
            keywords=CMU_KEYWORDS,
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
            Take(r["take"], r["subject"], f"data/raw/{name}/{r['take']}.amc", 0, _CMU_SECONDS)
            for r in _cmu(corpus.fetch)
        ]
    else:
        found = [
            take
            for i, group in enumerate(corpus.groups)
            for take in _files(f"corpora.{name}.groups.{i}", i, group, config)
        ]
    return sorted(_once(name, found, corpus.once), key=lambda t: t.name)


def _performed(name: str, corpus: settings.Corpus, seed: int) -> list[Take]:
    folder = f"data/raw/{name}"
    if corpus.perform == "janken":
        from miburi.perform import janken

        plan = janken.plan(seed, small=corpus.small)
        return [Take(p.take, p.wearer, f"{folder}/{p.take}.csv", 0, p.seconds) for p in plan]
    from miburi.perform import bodies

    return [
        Take(p.take, p.performer, f"{folder}/{p.take}.bvh", 0, p.seconds)
        for p in bodies.plan(seed, small=corpus.small)
    ]


def _cmu(subjects: Sequence[str]) -> list[dict[str, str]]:
    """Rows of the table of the CMU database's takes, of some subjects."""
    with open(CMU_TAKES, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t"))
    known = {row["subject"] for row in rows}
    for subject in subjects:
        if subject not in known:
            raise InputError(
                f"config: fetch: {CMU_TAKES} has no subject {subject!r}; it has {', '.join(sorted(known))}"
            )
    return [row for row in rows if row["subject"] in subjects]


def _files(where: str, number: int, group: settings.Group, config: settings.Config) -> list[Take]:
    """Takes of a group, by its patterns."""
    folder = group.folder.replace("{recordings}", config.recordings)
    if not os.path.isdir(folder):
        raise InputError(
            f"config: {where}.folder: there is no folder {folder!r}{_hint(group.folder, config)}"
        )
    excluded = {p for pattern in group.exclude for p in glob.glob(pattern, root_dir=folder, recursive=True)}
    found = []
    for pattern in group.files:
        paths = sorted(set(glob.glob(pattern, root_dir=folder, recursive=True)) - excluded)
        if not paths:
            raise InputError(
                f"config: {where}.files: no file in {folder!r} matches {pattern!r}{_hint(group.folder, config)}"
            )
        for path in paths:
            name = matched(group.take, "take", path, where) or stem(path.replace("/", "-"))
            subject = matched(group.subject, "subject", path, where) or "all"
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


def _seconds(path: str) -> float:
    share = _COMPRESSED if path.endswith(".gz") else 1.0
    return os.path.getsize(path) / (_BYTES.get(suffix(path), 30e3) * share)


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
