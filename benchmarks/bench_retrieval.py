"""Seconds per query and per hour of segmentation, beside the loop that one would write first.

    python benchmarks/bench_retrieval.py [--recordings FOLDER]

Queries and segments are windows of real clips where the recordings are there, and simulated smooth features
in any case: bounds that prune the one may not prune the other. All times are medians of one thread, in one
run, peers in turn. The paper's seconds come from another machine (Core2 Duo 2.66 GHz, Matlab and C++) and
are printed for orientation only.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from miburi.formats import read
from miburi.retrieval import Index, features, measures, reset_yaw, segment
from miburi.retrieval.jvh import jvh

PAPER = {  # seconds per query in [P]: table 4 (269 segments, Matlab) and table 5 (3065 segments, C++)
    (269, "DSPM(PCA)"): 2.9,
    (269, "SM(PCA)"): 8.6,
    (269, "MSM"): 0.2,
    (3065, "DSPM(PCA)"): 0.54,
    (3065, "DSPM(PCA)+Jvh"): 0.76,
    (3065, "MSM"): 0.0023,
}
Takes = list[np.ndarray]


def simulated(count: int, seed: int = 0) -> Takes:
    """Takes of 300 frames whose 42 values swing together in six ways."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 6 * np.pi, 300)[:, None]
    takes = []
    for _ in range(count):
        waves = np.sin(t * rng.uniform(0.3, 2.0, 6) + rng.uniform(0, 6, 6))
        takes.append((waves @ rng.normal(0, 0.2, (6, 42)) + rng.normal(0, 0.3, 42)).astype(np.float32))
    return takes


def recorded(folder: Path) -> Takes:
    """Features of the clips of `body_hdm05` and `body_bandai`."""
    takes = []
    for path in sorted((folder / "body_hdm05").glob("*/*.amc.gz")):
        motion = read(path, skeleton=folder / "body_hdm05/asf" / f"{path.name[:2]}.asf")
        takes.append(reset_yaw(features(motion)))
    takes += [reset_yaw(features(read(path))) for path in sorted((folder / "body_bandai").glob("*/*.bvh.gz"))]
    return takes


def windows(takes: Takes, count: int) -> list[tuple[str, int, int, int]]:
    """`count` windows of 50 to 100 frames, spread evenly over the takes."""
    every = [
        (str(i), i, a, min(len(x), a + 50 + (13 * a) % 51))
        for i, x in enumerate(takes)
        for a in range(0, len(x) - 49, 20)
    ]
    return [every[i] for i in np.linspace(0, len(every) - 1, count).astype(int)]


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


def median(work: Callable[[np.ndarray], object], queries: Sequence[np.ndarray]) -> float:
    work(queries[0])
    seconds = []
    for query in queries:
        start = time.perf_counter()
        work(query)
        seconds.append(time.perf_counter() - start)
    return float(np.median(seconds))


def bench_queries(name: str, takes: Takes, queries: Sequence[np.ndarray], sizes: Sequence[int]) -> None:
    print(f"\n{name}: milliseconds per query, first ten of the segments, {len(queries)} queries")
    print(f"{'segments':>8}  {'measure':15}{'plain':>9}{'all':>9}{'ten':>9}{'ratio':>8}{'paper':>9}")
    for size in sizes:
        index = Index.build(takes, windows(takes, size))
        for measure in measures():
            loop = median(
                lambda q, m=measure, i=index: plain(i, q, m), queries[: 2 if measure == "DTW" else 4]
            )
            full = median(lambda q, m=measure, i=index: i.rank(q, m), queries)
            ten = median(lambda q, m=measure, i=index: i.rank(q, m, 10), queries)
            paper = PAPER.get((size, measure))
            printed = "" if paper is None else f"{paper * 1e3:9.4g}"
            times = "".join(f"{t * 1e3:9.3f}" for t in (loop, full, ten))
            print(f"{size:8}  {measure:15}{times}{loop / ten:8.1f}{printed:>9}")


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
    sizes = (269, 3065)
    bench_queries("simulated features", simulated(300), simulated(20, seed=1), sizes)
    if not (folder / "body_hdm05").is_dir():
        print(f"\nno real recordings in {folder} (set MIBURI_RECORDINGS): the rest was not measured")
        return
    takes = recorded(folder)
    # queries are every 45th clip, a little slower and larger, never the very frames that are indexed
    queries = [
        (x.mean(axis=0) + 1.2 * (x - x.mean(axis=0)))[
            np.linspace(0, len(x) - 1, int(1.3 * len(x))).astype(int)
        ]
        for x in takes[::45]
    ]
    bench_queries("windows of real clips", takes, queries, sizes)
    bench_segmentation(folder)


if __name__ == "__main__":
    main()
