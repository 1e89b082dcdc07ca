"""Seconds to read recordings and to make features of them, beside readers of the same files.

    python benchmarks/bench_formats.py [--rounds N]

The text is made here (random angles; the time does not depend on what they are): BVH of a body of 31 joints,
96 channels and 6000 frames, once more with 100 joints and 303 channels, AMC of 10 000 frames with the 62
values of a CMU skeleton's frame. Ours gives a checked Motion (quaternions, metres) or its 42 features; the
others give what they give. Readers take turns, medians of one thread; peers that are not installed are named
as absent.
"""

from __future__ import annotations

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
import importlib
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from miburi.figures import PERSON
from miburi.formats import asf_amc, bvh
from miburi.kinematics import euler
from miburi.motion import Motion, Skeleton
from miburi.retrieval import features

FAST = ("miburi", "miburi, to 42 features", "numpy.loadtxt alone", "pybvh")

# bones of a CMU skeleton and their degrees of freedom
FREEDOM = {
    "lowerback": 3, "upperback": 3, "thorax": 3, "lowerneck": 3, "upperneck": 3, "head": 3, "rclavicle": 2,
    "rhumerus": 3, "rradius": 1, "rwrist": 1, "rhand": 2, "rfingers": 1, "rthumb": 2, "lclavicle": 2,
    "lhumerus": 3, "lradius": 1, "lwrist": 1, "lhand": 2, "lfingers": 1, "lthumb": 2, "rfemur": 3,
    "rtibia": 1, "rfoot": 2, "rtoes": 1, "lfemur": 3, "ltibia": 1, "lfoot": 2, "ltoes": 1,
}  # fmt: skip


def write_bvh(path: Path, frames: int = 6000, joints: int = 31) -> None:
    """A body whose joints turn at random, with a chain of joints that matter to nobody on its head."""
    rng = np.random.default_rng(0)
    more = joints - len(PERSON)
    parents = [*PERSON.parents, PERSON.index("neck"), *range(len(PERSON), joints - 1)]
    skeleton = Skeleton(
        PERSON.joints + tuple(f"hair{j}" for j in range(more)),
        np.array(parents),
        np.concatenate([PERSON.offsets, np.tile([0.0, 0.01, 0.0], (more, 1))]),
        ends=np.array([joints - 1]),
        end_offsets=np.array([[0.0, 0.1, 0.0]]),
    )
    turns = euler(rng.uniform(-80, 80, (frames, joints, 3)), "ZXY")
    bvh.write(path, Motion(skeleton, 120, rng.normal(size=(frames, 3)), turns))


def write_acclaim(asf: Path, amc: Path, frames: int = 10_000) -> None:
    """A star of CMU's bones that turn at random."""
    lines = [
        ":version 1.10",
        ":units",
        "length 0.45",
        "angle deg",
        ":root",
        "order TX TY TZ RX RY RZ",
        "axis XYZ",
    ]
    lines += ["position 0 0 0", "orientation 0 0 0", ":bonedata"]
    for name, dof in FREEDOM.items():
        lines += ["begin", f"name {name}", "direction 0 1 0", "length 2", "axis 10 20 30 XYZ"]
        lines += ["dof " + " ".join(["rx", "ry", "rz"][:dof]), "end"]
    lines += [":hierarchy", "begin", "root " + " ".join(FREEDOM), "end"]
    asf.write_text("\n".join(lines) + "\n")
    rng = np.random.default_rng(0)
    rows = [":FULLY-SPECIFIED", ":DEGREES"]
    for t in range(1, frames + 1):
        rows.append(str(t))
        for name, n in (("root", 6), *FREEDOM.items()):
            rows.append(name + "".join(f" {v:.6g}" for v in rng.uniform(-80, 80, n)))
    amc.write_text("\r\n".join(rows) + "\r\n")


def peers(path: Path) -> dict[str, Callable[[], object] | None]:
    """Readers of the BVH file; None where a package is not installed."""

    def of(module: str, name: str, argument: Callable[[], object]) -> Callable[[], object] | None:
        try:
            call = getattr(importlib.import_module(module), name)
        except ImportError:
            return None
        return lambda: call(argument())

    return {
        "miburi": lambda: bvh.read(path),
        "miburi, to 42 features": lambda: features(bvh.read(path)),
        "numpy.loadtxt alone": lambda: np.loadtxt(path, skiprows=first_row(path)),
        "pybvh": of("pybvh", "read_bvh_file", lambda: str(path)),
        "bvhio": of("bvhio", "readAsBvh", lambda: str(path)),
        "upc-pymotion": pymotion(path),
        "bvh": of("bvh", "Bvh", path.read_text),
    }


def pymotion(path: Path) -> Callable[[], object] | None:
    """upc-pymotion's reader, or None."""
    try:
        reader = importlib.import_module("pymotion.io.bvh").BVH
    except ImportError:
        return None
    return lambda: reader().load(str(path))


def first_row(path: Path) -> int:
    """Lines before the numbers."""
    with open(path) as file:
        return next(k for k, line in enumerate(file, 1) if line.startswith("Frame Time"))


def medians(calls: dict[str, Callable[[], object] | None], rounds: int) -> dict[str, float]:
    """Median seconds of each call, taking turns."""
    seconds: dict[str, list[float]] = {name: [] for name, call in calls.items() if call is not None}
    for k in range(rounds + 1):
        for name in seconds:
            call = calls[name]
            assert call is not None
            start = time.perf_counter()
            call()
            if k:  # the first round compiles and warms
                seconds[name].append(time.perf_counter() - start)
    return {name: float(np.median(s)) for name, s in seconds.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--rounds", type=int, default=5)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        path, asf, amc = (Path(folder) / n for n in ("a.bvh", "a.asf", "a.amc"))
        write_acclaim(asf, amc)
        for joints in (31, 100):
            write_bvh(path, joints=joints)
            size = path.stat().st_size / 1e6
            print(f"BVH, 6000 frames x {3 * joints + 3} channels, {size:.1f} MB")
            calls = peers(path)
            if joints > 31:
                calls = {name: calls[name] for name in calls if name in FAST}
            found = medians(calls, rounds)
            for name in calls:
                if name in found:
                    ratio = found[name] / found["miburi, to 42 features"]
                    print(f"  {name:<22} {found[name]:7.4f} s  {ratio:6.2f} x miburi, to 42 features")
                else:
                    print(f"  {name:<22} not installed")
        print(f"AMC, 10 000 frames x 62 values, {amc.stat().st_size / 1e6:.1f} MB")
        skeleton = asf_amc.read_asf(asf)
        for name, s in medians({"miburi": lambda: asf_amc.read(amc, skeleton=skeleton)}, rounds).items():
            print(f"  {name:<22} {s:7.4f} s")


if __name__ == "__main__":
    main()
