"""Compares the simulated glove wearer with a real CyberGlove, sensor by sensor.

python tools/compare_gloves.py FOLDER    # FOLDER: the config key `recordings`

Writes the table into docs/janken.md, the plot docs/janken_sensors.png and the hands docs/janken_hands.png.
"""

import sys
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image

import miburi
from miburi.formats import columns, glove
from miburi.formats.labels import read_labels
from miburi.perform import janken
from miburi.perform.janken.sensors import SENSORS
from miburi.render import sheets

matplotlib.use("agg")
from matplotlib import pyplot as plt

ROOT = Path(__file__).parents[1]
PAGE, PLOT = ROOT / "docs" / "janken.md", ROOT / "docs" / "janken_sensors.png"
HANDS = ROOT / "docs" / "janken_hands.png"
MAP = ROOT / "config" / "gloves" / "cyberglove_rps.yaml"
BEGIN, END = "<!-- sensors -->\n", "<!-- end of sensors -->\n"
SEED, REAL_FPS = 2011, 24.0
SHOWN = (0, 4, 7, 8, 12, 14, 16, 19)
# sensors that are dead, broken or computed by the maker's software, not measured
ABSENT = {5: "dead", 6: "dead", 9: "computed", 10: "broken", 13: "computed", 17: "computed"}
BENDS = [1, 2, 4, 5, 6, 7, 8, 9, 11, 12, 13, 15, 16, 17, 20]  # negative in the real table


def real(folder):
    """Degrees (T, 22) and labels."""
    home = Path(folder) / "hand" / "cyberglove_rps"
    degrees = np.degrees(columns.raw(home / "mock.txt.gz", columns.load(MAP))[1])
    degrees[:, BENDS] *= -1
    return [(degrees, read_labels(home / "labels_exclusive.tsv", fps=REAL_FPS))]


def simulated():
    """Degrees as the calibration sees them, and labels, of each recording."""
    offset = np.array([s.offset for s in SENSORS])
    gain = np.array([s.gain for s in SENSORS])
    return [((counts - offset) * gain, labels) for counts, labels in janken.perform(SEED).values()]


def count(takes, k):
    """Degrees of one count: the smallest difference between values, as far as many bear it out."""
    values = np.unique(np.concatenate([x[:, k] for x, _ in takes]).round(3))
    steps = np.diff(values)
    return float(np.median(steps[steps < 1.5 * np.quantile(steps[steps > 0.05], 0.1)])) if steps.size else 0.0


def figures(takes, fps, k):
    """Lowest, highest (degrees), peak speed of changes (degrees/s, median), and of holds: share of frames that
    repeat the one before, spread (degrees, mean and largest), and deviation of their means (degrees)."""
    everything = np.concatenate([x[:, k] for x, _ in takes])
    peaks, repeats, spreads, means = [], [], [], {}
    for x, labels in takes:
        for start, end, label in labels:
            y = x[start:end, k]
            if len(label) == 2:
                peaks.append(np.abs(np.diff(x[max(start - 1, 0) : end + 1, k])).max() * fps)
            elif end - start >= 8:
                repeats += (np.diff(y[2:-2]) == 0).tolist()
                spreads.append(np.ptp(y[2:-2]))
                means.setdefault(label, []).append(y.mean())
    varies = np.mean([np.std(m) for m in means.values()])
    return [
        f"{everything.min():.0f} … {everything.max():.0f}",
        f"{np.median(peaks):.0f}",
        f"{np.mean(repeats):.2f}",
        f"{np.mean(spreads):.1f} ({np.max(spreads):.0f})",
        f"{varies:.1f}",
    ]


def table(theirs, ours):
    heads = ["° per count", "range, °", "peak, °/s", "repeats", "spread in a hold, °", "holds differ, °"]
    rows = [
        "| sensor | " + " | ".join(f"{h}: real | simulated" for h in heads) + " |",
        "|---" * (1 + 2 * len(heads)) + "|",
    ]
    for k, sensor in enumerate(SENSORS):
        there = [ABSENT.get(k, "")] + [""] * 5
        if k not in ABSENT:
            step = count(theirs, k)
            # the maker's software blends two of them into steps of no one size
            there = [f"{step:.2f}" if step > 0.1 else "blended", *figures(theirs, REAL_FPS, k)]
        here = ["not fitted"] + [""] * 5
        if sensor.gain:
            here = [f"{abs(sensor.gain):.2f}", *figures(ours, janken.FPS, k)]
        cells = " | ".join(f"{a} | {b}" for a, b in zip(there, here, strict=True))
        rows.append(f"| {sensor.name} | {cells} |")
    return "\n".join(rows) + "\n"


def plot(theirs, ours):
    """Eight sensors, real above simulated in each pair, ten seconds each."""
    x, y = theirs[0][0], np.concatenate([ours[1][0][:180], ours[2][0][:180]])
    grid, axes = plt.subplots(len(SHOWN), 2, figsize=(9, 1.05 * len(SHOWN)), sharex="col", sharey="row")
    for (left, right), k in zip(axes, SHOWN, strict=True):
        for axis, values, fps, labels in ((left, x, REAL_FPS, theirs[0][1]), (right, y, janken.FPS, None)):
            axis.plot(np.arange(len(values)) / fps, values[:, k], ".-", ms=1.2, lw=0.6, color="#1f5fa8")
            axis.spines[["top", "right"]].set_visible(False)
            axis.tick_params(labelsize=6)
            for start, _, _ in labels or ():
                axis.axvline(start / fps, lw=0.3, color="#a3a6ab")
        left.set_ylabel(f"{SENSORS[k].name}, °", fontsize=6)
    axes[0, 0].set_title("a CyberGlove, 24 frames/s: paper, rock, scissors", fontsize=7)
    axes[0, 1].set_title("simulated, 30 frames/s: rock and paper, then scissors and paper", fontsize=7)
    for axis in axes[-1]:
        axis.set_xlabel("time, s", fontsize=6)
    grid.tight_layout(h_pad=0.3)
    grid.savefig(PLOT, dpi=90, metadata={"Software": None})


def hands(folder, theirs):
    """The middles of eight intervals in a row: the real hand, then each recording of the simulated one."""
    real_hand = glove.read_columns(Path(folder) / "hand" / "cyberglove_rps" / "mock.txt.gz", MAP)
    shown = [(real_hand, theirs[0][1][1:9], "a CyberGlove")]
    with tempfile.TemporaryDirectory() as home:
        janken.write(home, SEED)
        for take, (_, labels) in janken.perform(SEED).items():
            shown.append((miburi.read(Path(home) / f"{take}.csv"), labels[20:28], f"simulated, {take}"))
        rows = []
        for motion, labels, title in shown:
            strip = sheets.Strip("", [(start + end) // 2 for start, end, _ in labels])
            words = f"{title}: " + " ".join(name for _, _, name in labels)
            sheets.sheet(Path(home) / "row.png", motion, [strip], title=words, width=130, height=130)
            rows.append(np.asarray(Image.open(Path(home) / "row.png")))
    Image.fromarray(np.concatenate(rows)).quantize(64).save(HANDS, optimize=True)


def main():
    if len(sys.argv) != 2:
        print(__doc__.strip(), file=sys.stderr)
        return 2
    theirs, ours = real(sys.argv[1]), simulated()
    before, _, rest = PAGE.read_text(encoding="utf-8").partition(BEGIN)
    after = rest.partition(END)[2]
    PAGE.write_text(f"{before}{BEGIN}\n{table(theirs, ours)}\n{END}{after}", encoding="utf-8")
    plot(theirs, ours)
    hands(sys.argv[1], theirs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
