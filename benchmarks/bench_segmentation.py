"""Precision and recall of segmentation on real takes, settings chosen without the take that is scored.

    python benchmarks/bench_segmentation.py [--recordings FOLDER] [--quick]

Takes: the seven uncut ones of `body` that people have cut (36 cuts), and HDM05's clips put end to end by
actor, each class one to three times, poses blended over a quarter of a second (bounds: where the class
changes). For each of the seven takes and each actor, settings are those of the grid with the best mean of the
F scores of the other takes and of the other actors' clips. Beside it: PPCA with the default settings, the PCA
variant, cutters that make as many cuts as the default but at equal distances or at random (1000 draws), and
ruptures' kernel change points (rbf; told the default's number of cuts) on the same poses.

--quick scores the defaults alone. Last: processor seconds for one hour of the seven takes.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import csv
import itertools
import time
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from miburi.evaluate.segmentation import Agreement, Bounds, agreement, read_cut_points
from miburi.formats import read
from miburi.motion import Motion
from miburi.retrieval.segmentation import pose, segment

SEVEN = {
    "13_29": "02", "13_30": "02", "13_31": "02", "14_14": "14", "14_20": "14", "86_01": "86", "86_09": "86",
}  # fmt: skip
GRID = {"window_s": (1.0, 1.5, 2.0), "rise": (3.0, 4.0, 5.0), "differ": (3.5, 4.5, 5.5)}
BLEND_S = 0.25


class Cut(NamedTuple):
    """A take and where people cut it; `group` is left out as one."""

    group: str
    motion: Motion
    human: Bounds


def seven(folder: Path) -> list[Cut]:
    """The takes of `body` that people cut."""
    with open(folder / "intervals.tsv", encoding="utf-8", newline="") as file:
        rows = [r for r in csv.DictReader(file, delimiter="\t") if r["source"].startswith("mocap6")]
    found = []
    for take, skeleton in SEVEN.items():
        motion = read(folder / f"cmu/{take}.amc.gz", skeleton=folder / f"cmu/{skeleton}.asf", fps=120)
        if take.startswith("86"):
            human = read_cut_points(folder / f"segmentation/{take}.txt", motion.fps)
        else:
            best = np.array([float(r["start_s"]) for r in rows if r["take"] == take][1:])
            human = Bounds(best, best, best)
        found.append(Cut(take, motion, human))
    return found


def joined(clips: list[Motion]) -> tuple[Motion, list[int]]:
    """Clips put end to end, rotations blended, and the frames of the joins."""
    first = clips[0]
    n = round(BLEND_S * first.fps)
    weight = (np.arange(1, n + 1) / (n + 1))[:, None, None]
    q, joins = first.rotations, []
    for clip in clips[1:]:
        a, b = q[-n:], clip.rotations[:n]
        near = np.where((a * b).sum(axis=-1, keepdims=True) < 0, -b, b)
        mixed = (1 - weight) * a + weight * near
        joins.append(len(q) - n // 2)
        mixed /= np.linalg.norm(mixed, axis=-1, keepdims=True)
        q = np.concatenate([q[:-n], mixed, clip.rotations[n:]])
    return replace(first, root=np.zeros((len(q), 3)), rotations=q), joins


def end_to_end(folder: Path, takes: int = 3, classes: int = 8) -> list[Cut]:
    """Takes of each actor, made of HDM05's clips."""
    found = []
    for actor in ("bd", "bk", "dg", "mm", "tr"):
        rng = np.random.default_rng([ord(c) for c in actor])
        by_class = {
            path.name: sorted(path.glob(f"{actor}_*.amc.gz"))
            for path in sorted(folder.iterdir())
            if path.is_dir() and path.name != "asf"
        }
        for _ in range(takes):
            clips, labels = [], []
            for label in rng.permutation(sorted(by_class))[:classes]:
                some = rng.permutation(len(by_class[label]))[: rng.integers(1, 4)]
                clips += [
                    read(by_class[label][k], skeleton=folder / f"asf/{actor}.asf", fps=120) for k in some
                ]
                labels += [label] * len(some)
            motion, joins = joined(clips)
            changes = [
                j / motion.fps for j, (a, b) in zip(joins, itertools.pairwise(labels), strict=True) if a != b
            ]
            found.append(Cut(actor, motion, Bounds(*(np.array(changes),) * 3)))
    return found


def counted(cut: Cut, **settings: object) -> Agreement:
    """Counts of a take."""
    motion = cut.motion
    frames = segment(motion, **settings)  # type: ignore[arg-type]
    return agreement(frames / motion.fps, cut.human, len(motion) / motion.fps)


def kernel_cuts(motion: Motion, count: int) -> np.ndarray | None:
    """ruptures' change points, seconds; None if it is not installed."""
    try:
        import ruptures
    except ImportError:
        return None
    x = pose(motion[:: round(motion.fps / 10)])
    if count == 0:
        return np.zeros(0)
    return np.array(ruptures.KernelCPD(kernel="rbf", min_size=5).fit(x).predict(n_bkps=count)[:-1]) / 10


def f_score(counts: list[Agreement]) -> float:
    """Harmonic mean of precision and recall of takes together."""
    return 2 * sum(c.found for c in counts) / max(1, sum(c.cuts + c.bounds for c in counts))


def shown(name: str, found: float, cuts: int, bounds: int) -> None:
    print(f"  {name:<34} {found:6.1f} of {cuts:4d} cuts {found / max(cuts, 1):6.2f}  "
          f"of {bounds:4d} bounds {found / bounds:6.2f}")  # fmt: skip


def left_out(takes: dict[str, list[Cut]]) -> None:
    """Print the score of settings that were chosen without what is scored."""
    settings = [dict(zip(GRID, values, strict=True)) for values in itertools.product(*GRID.values())]
    counts = {
        corpus: [[counted(cut, **chosen) for cut in cuts] for chosen in settings]
        for corpus, cuts in takes.items()
    }
    for corpus, cuts in takes.items():
        total, picked = [], []
        for group in dict.fromkeys(cut.group for cut in cuts):
            others = [k for k, cut in enumerate(cuts) if cut.group != group]

            def quality(s: int, corpus: str = corpus, others: list[int] = others) -> float:
                rest = [f_score(counts[other][s]) for other in takes if other != corpus]
                return f_score([counts[corpus][s][k] for k in others]) + sum(rest)

            best = max(range(len(settings)), key=quality)
            picked.append(f"{group}: " + " ".join(f"{v:g}" for v in settings[best].values()))
            total += [counts[corpus][best][k] for k, cut in enumerate(cuts) if cut.group == group]
        found, made = sum(c.found for c in total), sum(c.cuts for c in total)
        shown(f"{corpus}, left out", found, made, sum(c.bounds for c in total))
        print(f"    chosen ({', '.join(GRID)}): {'; '.join(picked)}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--recordings", type=Path, default=Path("../shared/data"))
    parser.add_argument("--quick", action="store_true")
    arguments = parser.parse_args()
    folder = arguments.recordings
    if not (folder / "body/segmentation").is_dir():
        print(f"no real takes in {folder} (--recordings): nothing is measured")
        return
    takes = {"seven takes": seven(folder / "body"), "clips end to end": end_to_end(folder / "body_hdm05")}
    segment(takes["seven takes"][0].motion)  # compiles
    for corpus, cuts in takes.items():
        default = [counted(cut) for cut in cuts]
        print(f"{corpus}: {sum(c.seconds for c in default):.0f} s, found within 0.5 s")
        made, bounds = sum(c.cuts for c in default), sum(c.bounds for c in default)
        shown("PPCA, default settings", sum(c.found for c in default), made, bounds)
        shown("uniform", sum(c.uniform for c in default), made, bounds)
        shown("random", sum(c.random for c in default), made, bounds)
        pca = [counted(cut, method="PCA") for cut in cuts]
        shown("PCA variant", sum(c.found for c in pca), sum(c.cuts for c in pca), bounds)
        kernel = [kernel_cuts(cut.motion, c.cuts) for cut, c in zip(cuts, default, strict=True)]
        if any(k is None for k in kernel):
            print("  ruptures                           not installed")
        else:
            got = [
                agreement(k, cut.human, c.seconds).found
                for k, cut, c in zip(kernel, cuts, default, strict=True)
            ]
            shown("ruptures, kernel", sum(got), made, bounds)
    if not arguments.quick:
        left_out(takes)
    motions = [cut.motion for cut in takes["seven takes"]]
    hours = sum(len(m) / m.fps for m in motions) / 3600
    rounds = []
    for _ in range(3):
        start = time.process_time()
        for motion in motions:
            segment(motion)
        rounds.append((time.process_time() - start) / hours)
    print(f"segmentation: {min(rounds):.1f} s of one processor per hour of motion at 120 frames/s")


if __name__ == "__main__":
    main()
