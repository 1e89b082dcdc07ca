"""What the page shows of bodies: takes cut into pieces, and queries beside what was found for them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from miburi.artefacts import Segment
from miburi.evaluate.queries import Query, keywords_of
from miburi.evaluate.ranks import Ranks
from miburi.formats.annotations import Annotation
from miburi.motion import Motion
from miburi.report.contribution import contributions
from miburi.retrieval.index import Index
from miburi.retrieval.segmentation import pose, ppca_curve

FIRST = 10
"""Results that are played beside a query."""


def clip_name(corpus: str, segment: Segment) -> str:
    """The name of a segment's motion in the page."""
    return f"{corpus}/{segment[0]}/{segment[1]}-{segment[2]}"


def chosen(
    subjects: Mapping[str, str], pieces: Mapping[str, int], told: Mapping[str, int], most: int = 6
) -> list[str]:
    """Takes that stand for a corpus: of as many subjects as can be, and with something to see.

    Parameters
    ----------
    subjects
        Take → subject.
    pieces, told
        Take → number of pieces it was cut into, and of intervals that people annotated. Takes with bounds that
        people drew go first, then those with most pieces.
    """

    def worth(take: str) -> tuple[bool, int, str]:
        return told.get(take, 0) < 2, -pieces[take], take

    turns: Counter[str] = Counter()
    order = []
    for take in sorted(subjects, key=worth):
        turns[subjects[take]] += 1
        order.append((turns[subjects[take]], worth(take)))
    return [take for _, (_, _, take) in sorted(order)[:most]]


def segmentation(
    corpus: str,
    motion: Motion,
    pieces: Sequence[Segment],
    annotations: Sequence[Annotation],
    settings: Mapping[str, Any],
    joints: Mapping[str, str] | None,
) -> dict[str, Any]:
    """A take's curve H, its pieces and what people called its parts.

    Parameters
    ----------
    pieces
        Of this take, in order; H is shown from the first frames of each piece to its end.
    settings
        `segment` of the config.
    joints
        As in `retrieval.features`.
    """
    fps = motion.fps
    mine = [a for a in annotations if a.take == motion.name]
    intervals = [(a.take, round(a.start_s * fps), round(a.end_s * fps), a.keyword) for a in mine]
    words = [", ".join(sorted(k)) for k in keywords_of(pieces, intervals)]
    frames, height = _curve(motion, [p[1] for p in pieces], settings, joints)
    return {
        "corpus": corpus,
        "take": motion.name,
        "seconds": round(len(motion) / fps, 3),
        "t": [round(t / fps, 3) for t in frames],
        "h": height,
        "cuts": [round(p[1] / fps, 3) for p in pieces[1:]],
        "human": [[a.start_s, a.end_s, a.keyword] for a in mine],
        "pieces": [
            [round(p[1] / fps, 3), round(p[2] / fps, 3), clip_name(corpus, p), w]
            for p, w in zip(pieces, words, strict=True)
        ],
    }


def _curve(
    motion: Motion,
    starts: Sequence[int],
    settings: Mapping[str, Any],
    joints: Mapping[str, str] | None,
) -> tuple[list[int], list[float | None]]:
    """Frames and H, which begins anew after each cut; a gap stands between two pieces."""
    window, ahead, step = (
        max(1, round(float(settings[k]) * motion.fps)) for k in ("window_s", "ahead_s", "step_s")
    )
    x = pose(motion, joints)
    frames: list[int] = []
    height: list[float | None] = []
    for start, end in pairwise([*starts, len(motion)]):
        stop = min(end + ahead, len(motion))
        at, h = ppca_curve(
            x[:stop], window=window, ahead=ahead, step=step, variance=settings["variance"], start=start
        )
        frames += [start, *at.tolist()]
        height += [None, *(round(float(v), 3) for v in np.maximum(h, 1e-3))]
    return frames, height


def experiment(
    name: str,
    corpus: str,
    index: Index,
    queries: Sequence[Query],
    ranks: Sequence[Ranks],
    features: Mapping[str, NDArray[np.float32]],
    intervals: Sequence[tuple[str, int, int, str]],
    fps: Mapping[str, float],
) -> tuple[dict[str, Any], list[Segment]]:
    """What each measure ranks first for each query of an experiment.

    Returns
    -------
    facts
        What the page's script needs.
    wanted
        Segments that are shown, those of the first measure first.
    """
    segments = list(zip(index.take, index.start.tolist(), index.end.tolist(), strict=True))
    keywords = [", ".join(sorted(k)) for k in keywords_of(segments, intervals)]
    places = {s: i for i, s in enumerate(segments)}
    shown: dict[int, None] = {}
    targets = [places.get((q.take, q.start, q.end)) if q.protocol != 2 else None for q in queries]
    measures = []
    for one in ranks:
        rows = {q: k for k, q in enumerate(one.query)}
        at = [rows[q.query] for q in queries]
        first = one.order[at, :FIRST]
        place = [
            int(np.flatnonzero(one.order[k] == t)[0]) + 1 if t is not None else 0
            for k, t in zip(at, targets, strict=True)
        ]
        shown |= dict.fromkeys(first.ravel().tolist())
        measures.append(
            {
                "name": one.measure,
                "first": first.tolist(),
                "score": [[float(f"{v:.4g}") for v in row] for row in one.score[at, :FIRST].tolist()],
                "rank": place,
            }
        )
    shown |= dict.fromkeys(t for t in targets if t is not None)
    facts = {
        "name": name,
        "corpus": corpus,
        "segments": {
            i: [
                segments[i][0],
                round(segments[i][1] / fps[segments[i][0]], 2),
                round(segments[i][2] / fps[segments[i][0]], 2),
                clip_name(corpus, segments[i]),
                keywords[i],
            ]
            for i in shown
        },
        "queries": [
            {
                "name": q.query,
                "protocol": q.protocol,
                "keyword": q.keyword,
                "user": q.user,
                "style": q.style,
                "clip": f"{name}/{q.query}",
                "target": t,
            }
            for q, t in zip(queries, targets, strict=True)
        ],
        "measures": measures,
        "shares": {
            q.query: {
                i: shares(features[q.query], index, i)
                for i in sorted({i for m in measures for i in m["first"][k]})
            }
            for k, q in enumerate(queries)
            if q.query in features
        },
    }
    return facts, [segments[i] for i in shown]


def shares(query: NDArray[np.float32], index: Index, segment: int) -> list[float]:
    """Share of each limb in the distance between a query and a segment of an index."""
    frames = index.frames[index.offsets[segment] : index.offsets[segment + 1]]
    found = contributions(query, frames, index.mean[segment], index.basis[segment], index.dims)
    return [round(float(v), 3) for v in found]
