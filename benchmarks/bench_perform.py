"""What the simulated people cost: seconds of processor for each second of motion, one thread, without compilation.

    python benchmarks/bench_perform.py [--repeats N]

Nobody else makes these recordings, so there is no peer to be measured against; motion in real time is the yardstick.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from miburi.perform import bodies, janken
from miburi.perform.puppeteer import imitate, users


def cheapest(work: Callable[[], object], repeats: int) -> float:
    """Seconds of processor, the smallest of several runs after one that compiles."""
    work()
    best = float("inf")
    for _ in range(repeats):
        start = time.process_time()
        work()
        best = min(best, time.process_time() - start)
    return best


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=3)
    repeats = parser.parse_args().repeats
    entry = bodies.plan(0, small=True)[0]
    clip = bodies.imagine("right punch", "benchmark")
    player = users("benchmark", "development", 1, 0)[0]
    hand = sum(frames for frames, _ in janken.COUNTS.values()) / janken.FPS
    with tempfile.TemporaryDirectory() as folder:
        rows = [
            ("a glove wearer's three recordings, written", lambda: janken.write(Path(folder), 0), hand),
            (
                "a take of a simulated body, written",
                lambda: bodies.write(Path(folder), 0, [entry.take], small=True),
                entry.seconds,
            ),
            (
                "a clip played with the puppet",
                lambda: imitate(clip, player, seed_parts=(0,)),
                len(clip) / clip.fps,
            ),
        ]
        for name, work, seconds in rows:
            cost = cheapest(work, repeats)
            print(f"{name:45}{cost:8.3f} s for {seconds:6.1f} s of motion: {seconds / cost:8.0f} × real time")


if __name__ == "__main__":
    main()
