"""The artefacts of a run → the parts of its page. Whatever is absent is left out."""

from __future__ import annotations

import csv
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from miburi import artefacts, store
from miburi.artefacts import Segment
from miburi.evaluate.queries import Query, read_queries, spans
from miburi.evaluate.ranks import read_ranks
from miburi.formats import puppet
from miburi.formats.annotations import read_annotations
from miburi.motion import Motion
from miburi.render import figure
from miburi.report import bodies
from miburi.report.pack import Clips, packed_json
from miburi.report.page import Table
from miburi.retrieval.index import Index

_PERCENT = "\u00a0%"


def corpus_of(path: str) -> str:
    """The corpus that results/{corpus}/… belongs to."""
    parts = Path(path).parts
    return parts[parts.index("results") + 1]


def of_corpus(paths: Sequence[str], corpus: str) -> list[str]:
    """Those of a corpus."""
    return [p for p in paths if corpus_of(p) == corpus]


def read_rows(path: str) -> list[dict[str, str]]:
    """A CSV by the names of its columns."""
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def motions(paths: Sequence[str], takes: set[str]) -> dict[str, Motion]:
    """Takes by name, wherever they lie."""
    found: dict[str, Motion] = {}
    for path in paths:
        here = sorted(takes & set(artefacts.read_lengths(path)))
        if here:
            found |= artefacts.read_motions(path, here)
    return found


@dataclass
class Bodies:
    """Body corpora of a page: their takes' motions are read once.

    Parameters
    ----------
    motion, segments, takes, annotations
        Artefacts of all corpora.
    """

    clips: Clips
    motion: Sequence[str]
    segments: Sequence[str]
    takes: Sequence[str]
    annotations: Sequence[str]
    _motions: dict[tuple[str, str], Motion] = field(default_factory=dict)
    _floors: dict[tuple[str, str], float] = field(default_factory=dict)

    def _rows(self, corpus: str) -> list[dict[str, str]]:
        return [r for p in of_corpus(self.takes, corpus) for r in read_rows(p)]

    def _read(self, corpus: str, takes: set[str]) -> None:
        missing = {t for t in takes if (corpus, t) not in self._motions}
        for name, motion in motions(of_corpus(self.motion, corpus), missing).items():
            self._motions[corpus, name] = motion
            self._floors[corpus, name] = figure.group([motion]).floor

    def _add(self, corpus: str, segment: Segment) -> bool:
        motion = self._motions[corpus, segment[0]][segment[1] : segment[2]]
        floor = self._floors[corpus, segment[0]]
        return self.clips.add(bodies.clip_name(corpus, segment), motion, floor)

    def segmentation(
        self, corpora: Sequence[str], settings: Mapping[str, Any], joints: Mapping[str, Mapping[str, Any]]
    ) -> list[dict[str, Any]]:
        """Curves and pieces of a few takes of each corpus that is cut by segmentation.

        Parameters
        ----------
        joints
            Corpus → take → names of joints, where the tables do not know them.
        """
        found = []
        for corpus in corpora:
            pieces: dict[str, list[Segment]] = {}
            for path in of_corpus(self.segments, corpus):
                cut = _cut_takes(path)
                for piece in artefacts.read_segments(path):
                    if piece[0] in cut:
                        pieces.setdefault(piece[0], []).append(piece)
            subjects = {r["take"]: r["subject"] for r in self._rows(corpus) if r["take"] in pieces}
            notes = [a for p in of_corpus(self.annotations, corpus) for a in read_annotations(p)]
            counted = {take: len(found) for take, found in pieces.items()}
            shown = bodies.chosen(subjects, counted, Counter(a.take for a in notes))
            self._read(corpus, set(shown))
            for take in shown:
                if not all(self._add(corpus, p) for p in pieces[take]):
                    continue
                one = bodies.segmentation(
                    corpus,
                    self._motions[corpus, take],
                    pieces[take],
                    notes,
                    settings,
                    joints.get(corpus, {}).get(take),
                )
                found.append(one)
        return found

    def experiment(
        self, name: str, corpus: str, index: str, table: str, features: str, ranks: Sequence[str], first: str
    ) -> dict[str, Any]:
        """An experiment's queries beside what was found for them; motions while there is room.

        Parameters
        ----------
        index, table, features, ranks
            Artefacts of the experiment; the logs lie beside the table.
        first
            The measure whose results get room first.
        """
        queries = read_queries(table)
        notes = [a for p in of_corpus(self.annotations, corpus) for a in read_annotations(p)]
        fps = {r["take"]: float(r["fps"]) for r in self._rows(corpus)}
        read = sorted((read_ranks(p) for p in ranks), key=lambda r: (r.measure != first, r.measure))
        facts, wanted = bodies.experiment(
            name,
            corpus,
            Index.open(index),
            queries,
            read,
            artefacts.read_features(features)[0],
            spans(notes, fps),
            fps,
        )
        logs = Path(table).parent / "logs"
        for q in _users_in_turn(queries):
            self.clips.add(f"{name}/{q.query}", puppet.read(logs / f"{q.query}.csv"))
        self._read(corpus, {s[0] for s in wanted})
        for segment in wanted:
            self._add(corpus, segment)
        return facts


def _cut_takes(path: str) -> set[str]:
    """Takes of a segments artefact that were cut by PPCA, whose curve the page shows."""
    with store.open_checked(path, "segments") as file:
        return {take for take in file["takes"] if file["takes"][take].attrs["method"] == "PPCA"}


def _users_in_turn(queries: Sequence[Query]) -> list[Query]:
    """All keywords of a first user, then those of a second …: where room ends, every keyword has queries."""
    turns: Counter[tuple[int, str]] = Counter()
    order = []
    for place, q in enumerate(queries):
        turns[q.protocol, q.keyword] += 1
        order.append((turns[q.protocol, q.keyword], place))
    return [queries[place] for _, place in sorted(order)]


def labels(annotations: str) -> Table:
    """Labels or keywords of a corpus: how often each stands, and how long it lasts."""
    found: dict[str, list[float]] = {}
    for a in read_annotations(annotations):
        found.setdefault(a.keyword, []).append(a.end_s - a.start_s)
    rows = tuple(
        (k, str(len(v)), f"{sum(v):.1f}", f"{sum(v) / len(v):.2f}") for k, v in sorted(found.items())
    )
    return Table(("label", "intervals", "seconds_in_all", "mean_s"), rows)


def tiles(
    tables: Mapping[str, Table], corpora: Sequence[Mapping[str, Any]], lengths: Mapping[str, str]
) -> list[tuple[str, str]]:
    """The few figures that say most, each with what it is."""
    found = []
    for c in corpora:
        what = "of hands" if c["kind"] == "hand" else "of bodies"
        kind = "simulated" if c["simulated"] else "recorded"
        found.append((f"{c['seconds'] / 60:.1f} min", f"{what} in {c['takes']} {kind} takes: {c['name']}"))
    for name, protocol in (("table1", "1"), ("table1", "2"), ("table3", "2")):
        found += _hit_tile(tables.get(name), name, protocol)
    if "length, this run" in lengths:
        counts = tables["label_counts"].records() if "label_counts" in tables else []
        printed = next((r["paper"] for r in counts if r["quantity"] == "length, this run"), "")
        words = "length of the generated string" + (f" (printed: {printed})" if printed else "")
        found.append((f"{lengths['length, this run']} frames", words))
    generated, spliced = (lengths.get(f"largest jump at joins, {k}") for k in ("generated", "spliced"))
    if generated and spliced:
        words = f"largest jump where labels meet, generated; {float(spliced):.1f}° put end to end"
        found.append((f"{float(generated):.1f}°", words))
    return found


def _hit_tile(table: Table | None, name: str, protocol: str) -> list[tuple[str, str]]:
    rows = table.records() if table else []
    means = {r["measure"]: r for r in rows if r["keyword"] == "mean" and r["protocol"] == protocol}
    measure = next((m for m in ("DSPM(PCA)", "DSPM(PCA)+Jvh") if means.get(m, {}).get("hit10")), None)
    if measure is None:
        return []
    row = means[measure]
    users = float(row["users"])
    printed = float(row["hit10_paper"]) / float(row["users_paper"]) if row["hit10_paper"] else None
    paper = "" if printed is None else f"; the paper {100 * printed:.0f}{_PERCENT}"
    chance = f"; chance {100 * float(row['chance10']) / users:.0f}{_PERCENT}"
    where = f"{measure}, {name.replace('table', 'table ')} of [P], protocol {protocol}"
    words = f"of users found the motion among the first 10: {where}{paper}{chance}"
    return [(f"{100 * float(row['hit10']) / users:.0f}{_PERCENT}", words)]


def pack(**parts: Any) -> dict[str, str]:
    """Structures of the page's parts, packed; empty ones are left out."""
    return {name: packed_json(part) for name, part in parts.items() if part}
