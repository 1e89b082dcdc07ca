"""Draws a clip, and below it how development users play it with the puppet: a row of pictures for each.

python tools/puppet_sheet.py OUT.png CLIP [--skeleton ASF] [--log LOG.csv] [--users N]

CLIP is any recording of a body; LOG a puppet log of another origin that imitates it.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

import miburi
from miburi import store
from miburi.formats import puppet
from miburi.perform.puppeteer import imitate, users
from miburi.render import sheets

PICTURES, WIDTH, HEIGHT = 10, 110, 130


def row(motion, title):
    """Ten pictures of a motion, from its first frame to its last, as an array."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "row.png"
        shown = sheets.evenly(0, len(motion) - 1, PICTURES)
        sheets.sheet(path, motion, [sheets.Strip("", shown)], title=title, width=WIDTH, height=HEIGHT)
        return np.asarray(Image.open(path))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("out")
    parser.add_argument("clip")
    parser.add_argument("--skeleton")
    parser.add_argument("--log")
    parser.add_argument("--users", type=int, default=3)
    given = parser.parse_args()
    clip = miburi.read(given.clip, skeleton=given.skeleton)
    name = "/".join(Path(given.clip).parts[-2:])
    rows = [row(clip, f"shown: {name}")]
    if given.log:
        rows.append(row(puppet.read(given.log), "a puppet log of another origin"))
    for user in users("experiment1", "development", given.users, 2011):
        played = puppet.motion(*imitate(clip, user, seed_parts=(2011, "sheet", name)))
        words = f"simulated, {user.style}, skill {user.skill:.2f}, {user.habits.tempo:.2f} of the clip's pace"
        rows.append(row(played, words))
    page = Image.fromarray(np.concatenate(rows)).quantize(64)
    with store.replaced(given.out) as temporary:
        page.save(temporary, format="PNG", optimize=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
