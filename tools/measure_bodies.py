"""How real and simulated people move: speed, acceleration and jerk of hands, feet and trunk, and how feet slide.

    python tools/measure_bodies.py real RECORDINGS   writes tests/perform/real.json (figures, no recordings)
    python tools/measure_bodies.py compare           simulated performances against those figures, as a table

Each figure of a clip is the 95th percentile over its frames, after a Gaussian of 40 ms (about 4 Hz), so that
recordings of 30 and of 120 frames/s compare. A band goes from the 5th to the 95th percentile over clips.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import yaml
from scipy.ndimage import gaussian_filter1d

from miburi import flow, recordings
from miburi.conventions import find_joints
from miburi.motion import Motion
from miburi.perform import bodies
from miburi.takes import Take

ROOT = Path(__file__).parents[1]
FIGURES = ROOT / "tests" / "perform" / "real.json"
LIMBS = {"hands": ("l_hand", "r_hand"), "feet": ("l_foot", "r_foot"), "trunk": ("neck", "waist")}
SMOOTH, WINDOW = 0.04, 3.0
ARMS = (
    "call",
    "respond",
    "guide",
    "bye",
    "byebye",
    "raise-up-right-hand",
    "raise-up-left-hand",
    "wave-right-hand",
)
GROUND = ("85_*", "cartwheel", "back handspring", "hand stand kicks", "breakdance on hands and feet", "49_*")
ROUND = ("ArmCircle", "rotateArmsBothBackward1Reps", "both_arms_rotation", "rotate_arms", "arm_rotation",
         "arm_circle", "right_arm_rotation", "left_arm_rotation", "UpDown", "ToeTouchTwoHands",
         "wave-both-hands")  # fmt: skip
SWIM = {"hands": ROUND}  # nobody swims in the recordings
LIKE: dict[str, tuple[str, ...] | dict[str, tuple[str, ...]]] = {
    "right punch": ("punch", "boxing", "right punch", "left punch", "slash", "86_01"),
    "squats": ("squat1Reps", "Squat", "squat"),
    "wash window 1": ("wash window", "wash_window", "14_12", "sweep_floor", "wave-right-hand"),
    "wash window 2": ("wash window", "wash_window", "14_12", "sweep_floor", "wave-right-hand"),
    "side twists": ("Twist", "body_rotation", "rotate_body", "14_20"),
    "climb 2 steps": ("walk", "climb_up", "climb_down", "sneak2StepsLStart", "walk-left", "walk-right"),
    "point by right hand": (*ARMS, "14_24or25"),
    "sit on high stool": ("86_09", "sit on high stool", "sit", "depositFloorR"),
    "sit and swing legs": ("sit and swing legs",),
    "hand on chin": (*ARMS, "drink"),
    "drink soda": (*ARMS, "drink"),
    "hand stand kicks": GROUND,
    "backflip": GROUND,
    "cartwheel": GROUND,
    "spins": ("05_*", "49_*", "dance-short"),
    "handstands": GROUND,
    "somersault": (*GROUND, "lieDownFloor"),
    "jump kick": (
        "kickLFront1Reps",
        "kick",
        "leg_kick",
        "front kick, right leg",
        "forward jump",
        "jump",
        "02_*",
        "16_*",
    ),
    "front hand flip": GROUND,
    "rug pull fall": ("85_*", "01_*", "lieDownFloor", "hopBothLegs1hops"),
    "Russian dance": ("85_*", "KneeRaise", "hopBothLegs1hops", "jump_on_left_leg", "jump_on_right_leg"),
    "breast stroke": SWIM,
    "free style": SWIM,
    "back stroke": SWIM,
    "fly style": SWIM,
}
"""Keyword → the same or similar motions in the recordings: classes, or takes (cut into windows of 3 s)."""


def figures(motion: Motion) -> dict[str, float]:
    """Speed (m/s), acceleration (m/s²) and jerk (m/s³) of each limb, for a body of 1.75 m."""
    joints, place = find_joints(motion.skeleton), motion.positions()
    leg = sum(
        np.linalg.norm(place[0, joints[a]] - place[0, joints[b]])
        for a, b in (("l_hip", "l_knee"), ("l_knee", "l_foot"))
    )
    result = {}
    for limb, names in LIMBS.items():
        x = place[:, [joints[n] for n in names]] * (0.49 * 1.75 / leg)
        x = gaussian_filter1d(x, SMOOTH * motion.fps, axis=0, mode="nearest")
        for what in ("speed", "acceleration", "jerk"):
            x = np.gradient(x, 1 / motion.fps, axis=0)
            result[f"{limb} {what}"] = float(np.percentile(np.linalg.norm(x, axis=2).max(axis=1), 95))
    return result


def slide(motion: Motion) -> list[float]:
    """Metres by which a toe joint moves while it stands: the spans in which it is low and slow."""
    s = motion.skeleton
    lower = [j.lower() for j in s.joints]
    found = []
    for j, name in enumerate(lower):
        if "toe" in name and "end" not in name:
            x = gaussian_filter1d(motion.positions()[:, j], 0.02 * motion.fps, axis=0)
            speed = np.linalg.norm(np.gradient(x, 1 / motion.fps, axis=0), axis=1)
            low = (x[:, 1] < np.percentile(x[:, 1], 5) + 0.03) & (speed < 0.15)
            edges = np.flatnonzero(np.diff(np.concatenate([[0], low.astype(int), [0]])))
            for a, b in zip(edges[::2], edges[1::2], strict=True):
                if b - a > 0.2 * motion.fps:
                    still = x[a:b, [0, 2]]
                    seconds = (b - a) / motion.fps
                    path = np.linalg.norm(np.diff(still, axis=0), axis=1).sum()
                    found.append(float(path / seconds))
    return found


def clips(recorded: str) -> Iterator[tuple[str, str, Motion]]:
    """Class, take and motion of all real clips: annotated intervals, and windows of whole takes."""
    config = yaml.safe_load((ROOT / "config" / "real.yaml").read_text(encoding="utf-8"))
    plan = flow.plan({**config, "recordings": recorded})
    motions: dict[str, Motion] = {}
    for shard in plan.shards["bodies"]:
        reading = plan.to_read("bodies", shard)
        for name, subject, path, group in reading["takes"]:
            motions[name] = recordings.read_take(
                Take(name, subject, path, group, 0.0), reading["groups"][group]
            )
    reading = plan.to_annotate("bodies")
    takes = [Take(*row, 0.0) for row in reading["takes"]]
    lengths = {name: (len(m), m.fps) for name, m in motions.items()}
    for row in recordings.annotate_bodies(takes, reading["groups"], lengths):
        m = motions[row.take]
        a, z, step = round(row.start_s * m.fps), round(row.end_s * m.fps), round(WINDOW * m.fps)
        if row.take[:2].isdigit() and z - a >= 2 * step:  # a long interval is several clips
            for start in range(a, z - step + 1, step):
                yield row.keyword, row.take, m[start : start + step]
        else:
            yield row.keyword, row.take, m[a:z]
    for name, m in motions.items():
        if name[:2].isdigit():
            step = round(WINDOW * m.fps)
            for a in range(0, len(m) - step + 1, step):
                yield name, name, m[a : a + step]


def _is(wanted: str, kind: str) -> bool:
    return kind == wanted or (wanted.endswith("*") and kind.startswith(wanted[:-1]) and kind[:2].isdigit())


def real(recorded: str) -> None:
    """Write the figures of real people."""
    found: dict[str, list[dict[str, float]]] = {}
    slides: list[float] = []
    for kind, _, motion in clips(recorded):
        if len(motion) > 0.5 * motion.fps:
            found.setdefault(kind, []).append(figures(motion))
            if kind in ("walk", "squat1Reps", "depositFloorR", "kickLFront1Reps", "14_14", "86_01", "86_09"):
                slides += slide(motion)
    bands = {}
    for keyword, wanted in LIKE.items():
        parts = wanted if isinstance(wanted, dict) else dict.fromkeys(LIMBS, wanted)
        band: dict[str, list[float]] = {}
        count = []
        for limb, kinds in parts.items():
            rows = [r for kind, rs in sorted(found.items()) if any(_is(w, kind) for w in kinds) for r in rs]
            count.append(len(rows))
            for what in (w for w in rows[0] if w.startswith(limb)):
                band[what] = [round(float(v), 3) for v in np.percentile([r[what] for r in rows], [5, 50, 95])]
        bands[keyword] = {"like": wanted, "clips": min(count), "band": band}
    spread = [round(float(v), 4) for v in np.percentile(slides, [5, 50, 95])]
    about = (
        "Figures of tools/measure_bodies.py over HDM05, Bandai-Namco and CMU recordings; "
        "bands: 5th, 50th, 95th percentile of clips"
    )
    data = {"about": about, "slide_m_per_s": spread, "stands": len(slides), "keywords": bands}
    FIGURES.write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")


def compare(*only: str) -> None:
    """Print where simulated performances lie."""
    data = json.loads(FIGURES.read_text(encoding="utf-8"))
    for keyword, entry in data["keywords"].items():
        if only and keyword not in only:
            continue
        rows = [figures(bodies.imagine(keyword, seed)) for seed in range(5)]
        cells = []
        for what, (low, middle, high) in entry["band"].items():
            value = float(np.median([r[what] for r in rows]))
            sign = "<" if value < low else ">" if value > high else " "
            cells.append(f"{sign}{value:.1f} [{low:.1f} {middle:.1f} {high:.1f}]")
        print(f"{keyword:20s} {entry['clips']:4d}  " + "  ".join(cells))


if __name__ == "__main__":
    {"real": real, "compare": compare}[sys.argv[1]](*sys.argv[2:])
