"""Seconds per query and per hour of segmentation, beside the numpy that one would write first.

    python benchmarks/bench_retrieval.py [--recordings FOLDER]

Segments are pieces of real bodies where the recordings are there (whole clips, PPCA pieces of uncut takes, and
windows where these are too few), and simulated smooth features in any case: bounds that prune the one may not
prune the other. All times are medians of one thread, in one
run, peers in turn. The paper's seconds come from another machine (Core2 Duo 2.66 GHz, Matlab and C++) and
are printed for orientation only.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import time
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from miburi.formats import read
from miburi.motion import Motion
from miburi.retrieval import Index, features, measures, reset_angles, segment
from miburi.retrieval.jvh import jvh
from miburi.retrieval.latent import Settings

PAPER = {  # seconds per query in [P]: table 4 (269 segments, Matlab) and table 5 (3065 segments, C++)
    (269, "DSPM(PCA)"): 2.9,
    (269, "SM(PCA)"): 8.6,
    (269, "MSM"): 0.2,
    (3065, "DSPM(PCA)"): 0.54,
    (3065, "DSPM(PCA)+Jvh"): 0.76,
    (3065, "MSM"): 0.0023,
}
Takes = list[np.ndarray]
Pieces = list[tuple[str, int, int, int]]  # take, its place, start, end
SIZES = (269, 1000, 3065)


def simulated(count: int, seed: int = 0) -> Takes:
    """Takes of 300 frames whose 42 values swing together in six ways."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 6 * np.pi, 300)[:, None]
    takes = []
    for _ in range(count):
        waves = np.sin(t * rng.uniform(0.3, 2.0, 6) + rng.uniform(0, 6, 6))
        takes.append((waves @ rng.normal(0, 0.2, (6, 42)) + rng.normal(0, 0.3, 42)).astype(np.float32))
    return takes


def recorded(folder: Path) -> tuple[Takes, Pieces]:
    """Features of all real bodies, and their pieces: whole cut clips, and what PPCA makes of uncut takes."""
    takes, pieces = [], []

    def add(motion: Motion, cut: bool) -> None:
        i, x = len(takes), reset_angles(features(motion))
        ends = [0, *segment(motion).tolist(), len(x)] if cut else [0, len(x)]
        takes.append(x)
        pieces.extend((str(i), i, a, b) for a, b in pairwise(ends) if b > a)

    for path in sorted((folder / "body_hdm05").glob("*/*.amc.gz")):
        add(read(path, skeleton=folder / "body_hdm05/asf" / f"{path.name[:2]}.asf.gz"), False)
    for path in sorted((folder / "body_bandai").glob("*/*.bvh.gz")):
        add(read(path), False)
    for path in sorted((folder / "body/cmu").glob("*.amc.gz")):
        # two subjects' own skeletons are not there
        subject = {"13": "02", "15": "02"}.get(path.name[:2], path.name[:2])
        add(read(path, skeleton=folder / "body/cmu" / f"{subject}.asf", fps=120), True)
    return takes, pieces


def windows(takes: Takes, count: int, shortest: int = 50, longest: int = 100) -> Pieces:
    """`count` windows, spread evenly over the takes."""
    span = longest - shortest + 1
    every = [
        (str(i), i, a, min(len(x), a + shortest + (13 * a) % span))
        for i, x in enumerate(takes)
        for a in range(0, len(x) - shortest + 1, 20)
    ]
    return [every[i] for i in np.linspace(0, len(every) - 1, count).astype(int)]


def pieces_of(takes: Takes, pieces: Pieces, count: int) -> Pieces:
    """`count` of the pieces, spread evenly; where there are fewer, windows are added."""
    if len(pieces) >= count:
        return [pieces[i] for i in np.linspace(0, len(pieces) - 1, count).astype(int)]
    return pieces + windows(takes, count - len(pieces))


def plain(index: Index, query: np.ndarray, measure: str) -> np.ndarray:
    """The first ten by the equations in numpy, one segment at a time."""

    def err(mean: np.ndarray, basis: np.ndarray, x: np.ndarray) -> np.ndarray:
        d = x - mean
        return np.linalg.norm(d - d @ basis.T @ basis, axis=1)

    rng = np.random.default_rng(0)
    mean = query.mean(axis=0)
    basis = np.linalg.svd(query - mean, full_matrices=False)[2][: index.dims]
    drawn = query[np.sort(rng.choice(len(query), 50, replace=False))]
    movement = jvh(query)
    name = measure.removesuffix("+Jvh")
    score = np.empty(len(index))
    for s in range(len(index)):
        frames = index.frames[index.offsets[s] : index.offsets[s + 1]]
        if name == "mean pose":
            score[s] = np.linalg.norm(index.mean[s] - mean)
        elif name == "DTW":
            path = np.full((len(drawn) + 1, len(frames) + 1), np.inf)
            path[0, 0] = 0
            cost = np.square(drawn[:, None] - frames).sum(axis=2)
            for i, j in np.ndindex(cost.shape):
                path[i + 1, j + 1] = cost[i, j] + min(path[i, j], path[i, j + 1], path[i + 1, j])
            score[s] = np.sqrt(path[-1, -1])
        elif name == "MSM":
            angles = np.linalg.svd(index.basis[s] @ basis.T, compute_uv=False)
            score[s] = 1 - np.mean(angles**2)
        else:
            score[s] = err(index.mean[s], index.basis[s], drawn).max()
            if name == "DSPM(PCA)":
                score[s] = max(score[s], err(mean, basis, frames).max())
        if measure.endswith("+Jvh"):
            score[s] *= np.sqrt(max(0.0, 1 - np.sum(np.sqrt(index.jvh[s] * movement))))
    return np.argsort(score, kind="stable")[:10]


def arrays(index: Index) -> Callable[[np.ndarray, str], np.ndarray]:
    """The first ten by the equations in numpy, all segments at once, in float32."""
    mean, basis, movement = (x.astype(np.float32) for x in (index.mean, index.basis, index.jvh))
    frames = index.frames.reshape(len(index), -1, index.frames.shape[1])
    rng = np.random.default_rng(0)

    def err(gap: np.ndarray, directions: np.ndarray) -> np.ndarray:
        return np.linalg.norm(gap - (gap @ np.swapaxes(directions, -1, -2)) @ directions, axis=-1)

    def first(query: np.ndarray, measure: str) -> np.ndarray:
        x = query.astype(np.float32)
        own = x.mean(axis=0)
        name = measure.removesuffix("+Jvh")
        if name == "mean pose":
            score = np.linalg.norm(mean - own, axis=1)
        else:
            directions = np.linalg.svd(x - own, full_matrices=False)[2][: index.dims]
            drawn = x[np.sort(rng.choice(len(x), 50, replace=False))]
            if name == "MSM":
                score = 1 - np.square(basis @ directions.T).sum(axis=(1, 2)) / index.dims
            else:
                score = err(drawn - mean[:, None], basis).max(axis=1)
                if name == "DSPM(PCA)":
                    score = np.maximum(score, err(frames - own, directions).max(axis=1))
        if measure.endswith("+Jvh"):
            score = score * np.sqrt(np.maximum(1 - np.sqrt(movement * jvh(x)).sum(axis=1), 0))
        return np.argsort(score, kind="stable")[:10]

    return first


def median(work: Callable[[np.ndarray], object], queries: Sequence[np.ndarray]) -> float:
    work(queries[0])
    seconds = []
    for query in queries:
        start = time.perf_counter()
        work(query)
        seconds.append(time.perf_counter() - start)
    return float(np.median(seconds))


def bench_queries(name: str, takes: Takes, pieces: Pieces, queries: Sequence[np.ndarray]) -> None:
    print(
        f"\n{name}: milliseconds per query, 50 frames of each segment, {len(queries)} queries; plain numpy as a loop "
        "over segments (float64) and of whole arrays (float32), ranks of all and of the first 10, ratios of these"
    )
    print(
        f"{'segments':>8}  {'measure':15}{'loop':>9}{'arrays':>9}{'all':>9}{'first 10':>9}{'ratios':>16}{'paper':>9}"
    )
    kept: dict[str, list[float]] = {}
    for size in SIZES:
        index = Index.build(takes, pieces_of(takes, pieces, size))
        plain_arrays = arrays(index)
        for measure in measures():
            if "GP-LVM" in measure:
                continue
            loop = median(
                lambda q, m=measure, i=index: plain(i, q, m), queries[: 2 if measure == "DTW" else 4]
            )
            whole = (
                np.nan
                if measure == "DTW"
                else median(lambda q, m=measure, f=plain_arrays: f(q, m), queries[:8])
            )
            full = median(lambda q, m=measure, i=index: i.rank(q, m), queries)
            ten = median(lambda q, m=measure, i=index: i.rank(q, m, 10), queries)
            kept.setdefault(measure, []).append(ten)
            paper = PAPER.get((size, measure))
            printed = "" if paper is None else f"{paper * 1e3:9.4g}"
            times = "".join(f"{t * 1e3:9.3f}" for t in (loop, whole, full, ten))
            print(f"{size:8}  {measure:15}{times}{loop / ten:8.1f}{whole / ten:8.1f}{printed:>9}")
    print(
        f"growth of the first 10 from {SIZES[0]} to {SIZES[-1]} segments ({SIZES[-1] / SIZES[0]:.1f} times):"
    )
    print("  " + ", ".join(f"{measure} {times[-1] / times[0]:.1f}" for measure, times in kept.items()))


def bench_dtw(name: str, takes: Takes, queries: Sequence[np.ndarray]) -> None:
    """Whole sequences: queries of 300 frames, 269 segments of about 200, beside dtaidistance's fastest call."""
    from dtaidistance import dtw_ndim

    index = Index.build(takes, windows(takes, 269, 150, 250), samples=None)
    lasts = [x[np.linspace(0, len(x) - 1, 300).astype(int)].astype(np.float64) for x in queries[:6]]
    parts = [index.frames[a:b].astype(np.float64) for a, b in pairwise(index.offsets)]
    peer, full, ten = (
        median(work, lasts)
        for work in (
            lambda q: [dtw_ndim.distance_fast(q, x) for x in parts],
            lambda q: index.rank(q, "DTW"),
            lambda q: index.rank(q, "DTW", 10),
        )
    )
    for q in lasts:
        theirs = np.array([dtw_ndim.distance_fast(q, x) for x in parts])
        assert np.abs(index.distances(q, "DTW") - theirs).max() < 1e-6
        assert (index.rank(q, "DTW", 10).order == np.argsort(theirs, kind="stable")[:10]).all()
    print(f"\n{name}: DTW, 300 frames against 269 segments of {len(index.frames) / 269:.0f}, ms per query")
    print(
        f"dtaidistance {peer * 1e3:.0f}, all {full * 1e3:.0f} ({peer / full:.1f} times faster), "
        f"first 10 {ten * 1e3:.1f} ({peer / ten:.1f} times faster)"
    )


def bench_gplvm(name: str, takes: Takes, pieces: Pieces, queries: Sequence[np.ndarray]) -> None:
    index = Index.build(takes, pieces_of(takes, pieces, 269))
    start = time.perf_counter()
    index = index.trained(Settings())
    took = time.perf_counter() - start
    each = ", ".join(
        f"{m} {median(lambda q, m=m: index.rank(q, m), queries[:4]):.2f}" for m in measures() if "GP-LVM" in m
    )
    print(f"\n{name}: GP-LVM of 269 segments: training {took:.1f} s; seconds per query: {each}")
    print("[P]: SM(GP-LVM) 189.7, DSPM(GP-LVM) 157.7")


def bench_segmentation(folder: Path) -> None:
    motions = [
        read(folder / "body/cmu" / f"{take}.amc.gz", skeleton=folder / "body/cmu" / f"{take[:2]}.asf")
        for take in ("14_14", "14_20", "86_01", "86_09")
    ]
    seconds = sum(len(m) / m.fps for m in motions)
    segment(motions[0])
    start = time.perf_counter()
    for motion in motions:
        segment(motion)
    took = time.perf_counter() - start
    print(f"\nsegmentation: {took / seconds * 3600:.1f} s per hour of motion at 120 Hz")
    start = time.perf_counter()
    for motion in motions:
        features(motion)
    took = time.perf_counter() - start
    print(f"features: {took / seconds * 3600:.1f} s per hour of motion at 120 Hz")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    default = Path(__file__).parents[1] / "../shared/data"
    parser.add_argument("--recordings", type=Path, default=Path(os.environ.get("MIBURI_RECORDINGS", default)))
    folder = parser.parse_args().recordings
    made, played = simulated(300), simulated(20, seed=1)
    bench_queries("simulated features", made, windows(made, SIZES[-1]), played)
    bench_dtw("simulated features", made, played)
    bench_gplvm("simulated features", made, windows(made, SIZES[-1]), played)
    if not (folder / "body_hdm05").is_dir():
        print(f"\nno real recordings in {folder} (set MIBURI_RECORDINGS): the rest was not measured")
        return
    takes, pieces = recorded(folder)
    print(f"\nreal bodies: {len(pieces)} clips and PPCA pieces; windows make up what is missing")
    # queries are every 45th clip, a little slower and larger, never the very frames that are indexed
    queries = [
        (x.mean(axis=0) + 1.2 * (x - x.mean(axis=0)))[
            np.linspace(0, len(x) - 1, int(1.3 * len(x))).astype(int)
        ]
        for x in takes[::45]
    ]
    bench_queries("real pieces", takes, pieces, queries)
    bench_dtw("windows of real takes", takes, queries)
    bench_gplvm("real pieces", takes, pieces, queries)
    bench_segmentation(folder)


if __name__ == "__main__":
    main()
