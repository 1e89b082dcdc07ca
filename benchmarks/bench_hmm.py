"""Training and generation beside their peers.

    python benchmarks/bench_hmm.py [--repeats N]

The row of rendering is printed by bench_render.py.

Sequences are simulated smooth movements of 48 values with deltas. Training starts every peer from the same
parameters and runs the same 20 iterations; results are compared before anything is timed. hmmlearn gets the
exit as one state more, which only a row appended to each sequence can be in: 20 rows and a state more are
part of its time. Times are the processor's, the smallest of several runs, peers in turn, one thread, without
compilation.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import logging
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.linalg import solveh_banded

from miburi import formats
from miburi.hmm import by_label, deltas, global_variance, mlpg, synthesize, train, windows
from miburi.perform import janken

Arrays = list[np.ndarray]
COUNTS = (21, 20, 20, 21, 21, 21, 20, 20, 20, 21, 21, 21, 21, 20, 21, 21, 21, 21, 20, 21)  # 413 frames
LABELS = ((41, 24), (42, 14), (41, 18), (20, 19), (20, 13), (20, 12), (20, 19), (20, 18), (21, 13))  # janken


def movements(sizes: Any, seed: int) -> Arrays:
    """Changes from one pose of 48 values to another, with deltas: (T_k, 144) each."""
    rng = np.random.default_rng(seed)
    way = rng.uniform(-45, 45, 48)
    found = []
    for n in sizes:
        ramp = np.tanh(np.linspace(-2.5, 2.5, n) + rng.normal(0, 0.3))[:, None]
        found.append(deltas(ramp * way + rng.normal(0, 0.8, (n, 48))))
    return found


def gaussians(frames: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Staircases of about 6 frames a step: mean and variance (frames, 144)."""
    rng = np.random.default_rng(seed)
    steps = frames // 6 + 1
    mean = rng.normal(size=(steps, 144)) * np.repeat([40.0, 4.0, 1.0], 48)
    variance = rng.uniform(0.2, 2.0, (steps, 144)) * np.repeat([30.0, 3.0, 0.5], 48)
    return mean.repeat(6, 0)[:frames], variance.repeat(6, 0)[:frames]


def fastest(
    works: list[Callable[[], object]], repeats: int, clock: Callable[[], float] = time.process_time
) -> list[float]:
    """Seconds of each, the smallest of several runs, in turn."""
    best = [np.inf] * len(works)
    for _ in range(repeats):
        for k, work in enumerate(works):
            start = clock()
            work()
            best[k] = min(best[k], clock() - start)
    return best


def hmmlearn_peer(x: Arrays, start: Any, iterations: int, implementation: str) -> Callable[[], Any] | None:
    """hmmlearn with an exit, from the given start; None where it is not installed."""
    try:
        from hmmlearn.hmm import GaussianHMM
    except ImportError:
        return None

    class Exit(GaussianHMM):  # type: ignore[misc]
        def _compute_log_likelihood(self, rows: np.ndarray) -> np.ndarray:
            out = super()._compute_log_likelihood(rows)
            end = rows[:, 0] > 1e5
            out[end, :-1], out[~end, -1], out[end, -1] = -np.inf, -np.inf, 0.0
            return out

    n, d = start.mean.shape
    rng = np.random.default_rng(0)
    rows = np.concatenate([part for s in x for part in (s, rng.normal(1e6, 1.0, (1, d)))])
    sizes = [len(s) + 1 for s in x]
    transitions = np.zeros((n + 1, n + 1))
    transitions[:n, :n], transitions[n - 1, n], transitions[n, n] = start.transitions, start.exit, 1.0

    def fit() -> Any:
        peer = Exit(
            n + 1, "diag", n_iter=iterations, tol=-np.inf, init_params="", min_covar=0,
            implementation=implementation, covars_prior=0, covars_weight=0,
        )  # fmt: skip
        peer.startprob_, peer.transmat_ = np.eye(n + 1)[0], transitions
        peer.means_ = np.vstack([start.mean, np.full(d, 1e6)])
        peer.covars_ = np.vstack([start.variance, np.ones(d)])
        return peer.fit(rows, sizes)

    return fit


def bench_training(repeats: int) -> None:
    x = movements(COUNTS, 0)
    frames, iterations = sum(COUNTS), 20
    settings: dict[str, Any] = {"floor": 0.0, "tolerance": -1.0}
    began = time.perf_counter()
    start = train(x, iterations=0, **settings)
    print(f"\nfirst call, which compiles or loads the kernels: {time.perf_counter() - began:.2f} s")
    print(f"EM, 3 states, 144 values, {len(x)} sequences, {frames} frames, {iterations} iterations")

    def ours() -> Any:
        return train(x, iterations=iterations, **settings)

    names, works = ["miburi, with durations"], [ours]
    for implementation in ("log", "scaling"):
        fit = hmmlearn_peer(x, start, iterations, implementation)
        if fit is None:
            print("hmmlearn is not installed: nothing to compare with")
            continue
        peer = fit()
        own = ours().log_likelihood[:-1]
        print(
            f"hmmlearn, {implementation}: largest relative difference of the log-likelihoods "
            f"{np.abs(np.array(peer.monitor_.history) / own - 1).max():.1e}, "
            f"of the means {np.abs(peer.means_[:3] / ours().mean - 1).max():.1e}"
        )
        names.append(f"hmmlearn, {implementation}")
        works.append(fit)
    table(names, fastest(works, repeats))
    labels = {str(k): movements(np.full(n, size), k) for k, (n, size) in enumerate(LABELS)}
    reference = global_variance([s for x in labels.values() for s in x], None)

    def nine() -> None:
        models = {s: train(x, label=s, reference=reference) for s, x in labels.items()}
        synthesize(models, " ".join(models))

    (seconds,) = fastest([nine], repeats)
    print(f"nine models with janken's numbers of intervals, a string of nine labels: {seconds * 1e3:.1f} ms")
    recorded = performed()

    def saved() -> None:
        with tempfile.TemporaryDirectory() as folder:
            varies = global_variance([x for x, _ in recorded])
            for label, intervals in by_label(recorded).items():
                train(intervals, label=label, reference=varies, fps=30.0).save(f"{folder}/{label}.h5")

    for what, clock in (("processor", time.process_time), ("by the wall", time.perf_counter)):
        (seconds,) = fastest([saved], repeats, clock)
        print(
            f"all nine models of janken, features to saved models: {seconds * 1e3:.1f} ms, {what} (limit 500)"
        )


def performed() -> list[tuple[np.ndarray, list[tuple[int, int, str]]]]:
    """Angles and labels of janken's three recordings, read from their logs."""
    found = []
    with tempfile.TemporaryDirectory() as folder:
        janken.write(folder, 2011)
        for take in janken.RECORDINGS:
            motion = formats.read(Path(folder) / f"{take}.csv")
            labels = formats.read_labels(Path(folder) / f"{take}.lab", fps=motion.fps, frames=len(motion))
            assert motion.angles is not None
            found.append((motion.angles, labels))
    return found


def banded(mean: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Features one after another by scipy's banded Cholesky: what one would write first."""
    frames = len(mean)
    delta, square = windows()
    out = np.empty((frames, 48))
    for m in range(48):
        band, r = np.zeros((3, frames)), np.zeros(frames)
        for k, window in enumerate(([1.0], delta, square)):
            p = 1 / variance[:, k * 48 + m]
            half = len(window) // 2
            if half:
                p[:half] = p[-half:] = 0.0
            w = p * mean[:, k * 48 + m]
            for j, a in enumerate(window):
                r += a * np.roll(w, j - half)
                for i in range(j + 1):
                    band[2 - (j - i)] += a * window[i] * np.roll(p, j - half)
        out[:, m] = solveh_banded(band, r)
    return out


def dense(mean: np.ndarray, variance: np.ndarray) -> np.ndarray:
    """Features one after another by a dense solve, W kept: O(M T³), as the paper has it."""
    frames = len(mean)
    blocks = [np.eye(frames)]
    for window in windows():
        half = len(window) // 2
        rows = sum(a * np.eye(frames, k=j - half) for j, a in enumerate(window))
        rows[:half] = rows[-half:] = 0.0
        blocks.append(rows)
    w = np.concatenate(blocks)
    out = np.empty((frames, 48))
    for m in range(48):
        weighted = w.T / variance[:, m::48].T.ravel()
        out[:, m] = np.linalg.solve(weighted @ w, weighted @ mean[:, m::48].T.ravel())
    return out


def nnmnkwii_peer(mean: np.ndarray, variance: np.ndarray) -> Callable[[], np.ndarray] | None:
    try:
        from nnmnkwii.paramgen import mlpg as peer
    except ImportError:
        return None
    delta, square = windows()
    coefficients = [(0, 0, np.array([1.0])), (1, 1, delta), (1, 1, square)]
    return lambda: peer(mean, variance, coefficients)


def bench_generation(repeats: int) -> None:
    mlpg(*gaussians(10))
    for frames in (238, 2000, 20_000):
        mean, variance = gaussians(frames)
        lasting = np.full(len(mean[::6]), 6)
        lasting[-1] = frames - lasting[:-1].sum()
        steps = np.ascontiguousarray(mean[::6]), np.ascontiguousarray(variance[::6])
        peers: dict[str, Callable[[], np.ndarray] | None] = {
            "miburi, from states": lambda s=steps, n=lasting: mlpg(*s, frames=n),
            "miburi, from frames": lambda m=mean, v=variance: mlpg(m, v),
            "scipy, banded per value": lambda m=mean, v=variance: banded(m, v),
            "nnmnkwii": nnmnkwii_peer(mean, variance),
        }
        print(f"\ngeneration, 48 values, {frames} frames")
        if peers["nnmnkwii"] is None:
            print(
                "nnmnkwii is not installed (its build and use need setuptools < 81): nothing to compare with"
            )
        there = {name: work for name, work in peers.items() if work is not None}
        x = mlpg(mean, variance)
        for name, work in list(there.items())[1:]:  # results first, which also compiles
            print(f"{name}: largest difference {np.abs(work() - x).max():.1e}")
        seconds = fastest(list(there.values()), repeats if frames < 20_000 else 3)
        if frames <= 238:  # on its own: it leaves nothing in the caches for who comes next
            print(f"dense solve per value: largest difference {np.abs(dense(mean, variance) - x).max():.1e}")
            there["dense solve per value"] = lambda m=mean, v=variance: dense(m, v)
            seconds += fastest([there["dense solve per value"]], repeats)
        table(list(there), seconds)
    bench_growth()


def states(frames: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A staircase of 6 frames a step, from its states: mean, variance (S, 144) and frames (S,)."""
    mean, variance = gaussians(6 * 39)
    times = -(-frames // (6 * 39))
    lasting = np.full(39 * times, 6)
    return np.tile(mean[::6], (times, 1)), np.tile(variance[::6], (times, 1)), lasting


def bench_growth() -> None:
    """Time and memory per frame; memory is that of a process of its own, above one that generates nothing."""
    print("\ngeneration from states, time and peak memory beside the Gaussians")
    for frames in (10**3, 10**4, 10**5, 10**6):
        mean, variance, lasting = states(frames)
        count = int(lasting.sum())
        idle = peak(lambda: None)
        work = lambda m=mean, v=variance, n=lasting: mlpg(m, v, frames=n)  # noqa: E731
        taken = 1024 * (peak(work) - idle)
        (seconds,) = fastest([work], 5 if frames < 10**6 else 2)
        print(
            f"{count:8} frames {seconds * 1e3:10.3f} ms {seconds / count * 1e6:8.3f} µs per frame"
            f"{taken / 2**20:10.1f} MB {taken / count:8.0f} bytes per frame"
        )


def peak(work: Callable[[], object]) -> int:
    """Largest resident size of a child that does the work, KB."""
    child = os.fork()
    if not child:
        work()
        os._exit(0)
    return os.wait4(child, 0)[2].ru_maxrss


def table(names: list[str], seconds: list[float]) -> None:
    """First row is ours; the ratio says how many times longer the others take."""
    for name, s in zip(names, seconds, strict=True):
        print(f"{name:26}{s * 1e3:12.3f} ms{s / seconds[0]:10.1f} ×")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=7)
    repeats = parser.parse_args().repeats
    logging.getLogger("hmmlearn").setLevel(logging.ERROR)  # the end's row of transitions is empty
    bench_training(repeats)
    bench_generation(repeats)


if __name__ == "__main__":
    main()
