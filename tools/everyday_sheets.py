"""Contact sheets of what the simulated people do, for docs/everyday.md, or beside real takes to look at.

python tools/everyday_sheets.py                      writes docs/everyday/{keyword}.png
python tools/everyday_sheets.py FOLDER [KEYWORD …]   the same elsewhere, also of the other motions
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image

from miburi.perform import bodies
from miburi.perform.bodies import take
from miburi.perform.bodies.programme import Clip, Plan
from miburi.render.sheets import Strip, evenly, sheet

ROOT = Path(__file__).parents[1]
COLUMNS, ROWS, SIZE = 8, 2, 144
BY = {
    "sit down": "sit on chair",
    "stand up": "sit on chair",
    "go down 2 steps": "climb 2 steps",
    "get up": "lie down",
}
"""Motions that come with others → which."""


def main(folder: str = str(ROOT / "docs" / "everyday"), *keywords: str) -> None:
    """Write a sheet of each keyword's first performance in the corpus, by whoever it is."""
    out = Path(folder)
    out.mkdir(parents=True, exist_ok=True)
    plans = bodies.plan(2011)
    for keyword in keywords or bodies.KEYWORDS:
        does = BY.get(keyword, keyword)
        entry, clip = next((p, c) for p in plans for c in p.clips if c.keyword == does)
        alone = Plan(
            f"{entry.performer} sheet {keyword}", entry.performer, 0.0, (keyword,), (_few(clip),), 60.0, False
        )
        motion, rows = take.perform(alone, 2011)
        row = next(r for r in rows if r.keyword == keyword)
        shown = evenly(round(row.start_s * 60), min(round(row.end_s * 60), len(motion) - 1), COLUMNS * ROWS)
        strips = [Strip("", shown[k : k + COLUMNS]) for k in range(0, len(shown), COLUMNS)]
        path = out / f"{keyword.replace(' ', '_')}.png"
        sheet(path, motion, strips, title=f"{keyword}: {entry.performer}, simulated", width=SIZE, height=SIZE)
        Image.open(path).convert("P", palette=Image.Palette.ADAPTIVE, colors=48).save(path, optimize=True)


def _few(clip: Clip) -> Clip:
    """At most two repetitions of it, so that a sheet shows them closely; dances a few more."""
    return clip._replace(repetitions=min(clip.repetitions, 4 if clip.keyword == "Russian dance" else 2))


if __name__ == "__main__":
    main(*sys.argv[1:])
