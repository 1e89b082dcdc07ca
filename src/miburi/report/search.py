"""The page of a user's own query: what was found, to be played and kept."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from miburi.formats import bvh, puppet
from miburi.motion import Motion
from miburi.render import figure
from miburi.report import assemble
from miburi.report.bodies import FIRST, clip_name, shares
from miburi.report.pack import Clips, packed_json, squeezed
from miburi.report.page import read_table, render
from miburi.retrieval.index import Index


def page(
    table: str,
    log: str,
    index: str,
    motions: Sequence[str],
    query: NDArray[np.float32],
    about: Mapping[str, Any],
) -> str:
    """The HTML of a search.

    Parameters
    ----------
    table
        Path of the ranking, results/{corpus}/search/{query}.csv.
    log
        Path of the puppet log that was played.
    index, motions
        Artefacts of the corpus.
    query : (T, 42)
        Features of the log, as they were ranked.
    about
        `simulated`: whether the corpus is of simulated people.
    """
    corpus, rows = assemble.corpus_of(table), assemble.read_rows(table)[:FIRST]
    played, stored = puppet.read(log), Index.open(index)
    spans = zip(stored.take, stored.start.tolist(), stored.end.tolist(), strict=True)
    places = {span: i for i, span in enumerate(spans)}
    takes = assemble.motions(motions, {r["take"] for r in rows})
    clips, kept, results = Clips(), dict[str, str](), []
    name = Path(table).stem
    clips.add(f"query/{name}", played)
    for row in rows:
        motion = takes[row["take"]]
        start, end = (round(float(row[k]) * motion.fps) for k in ("start_s", "end_s"))
        segment, clip = (row["take"], start, end), motion[start:end]
        file = f"{name}_{int(row['rank']):02d}_{row['take']}_{start}-{end}.bvh".replace("/", "-")
        clips.add(clip_name(corpus, segment), clip, figure.group([motion]).floor)
        kept[file] = squeezed(_bvh(clip))
        i = places.get(segment)
        results.append(
            {
                "rank": int(row["rank"]),
                "clip": clip_name(corpus, segment),
                "take": row["take"],
                "file": file,
                "words": f"{float(row['start_s']):.1f}–{float(row['end_s']):.1f} s; distance {float(row['score']):.3g}",
                "shares": None if i is None else shares(query, stored, i),
            }
        )
    kind = rows[0]["queries"] if rows else "recorded"
    words = f"query: {name}, {len(played) / played.fps:.1f} s ({kind})"
    simulated = [f"the people of {corpus}"] * bool(about["simulated"]) + ["the query"] * (kind == "simulated")
    return render(
        "search.html",
        clips,
        {"search": packed_json({"query": {"clip": f"query/{name}", "words": words}, "results": results})},
        {},
        title=f"{name}: a search in {corpus}",
        words=f"The first {len(rows)} segments, nearest first by {rows[0]['measure'] if rows else 'no measure'}.",
        simulated=" and ".join(simulated),
        path=table,
        table=read_table(table, 50),
        bvh=kept,
    )


def _bvh(motion: Motion) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "clip.bvh"
        bvh.write(path, motion)
        return path.read_bytes()
