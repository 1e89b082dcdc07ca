"""Compiled functions on disk: shared by copies of the package, never by other sources."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import miburi

SCRIPT = """
import json, numpy
from miburi.formats import numerals
numerals._fill(numpy.ones((2, 2)), numpy.empty(100, numpy.uint8))
stats = numerals._fill.stats
print(json.dumps([stats.cache_path, sum(stats.cache_hits.values()), sum(stats.cache_misses.values())]))
"""


def call(home: Path, cache: Path, **more: str) -> tuple[Path, int, int]:
    environment = {k: v for k, v in os.environ.items() if not k.startswith("NUMBA")}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env={**environment, "PYTHONPATH": str(home), "XDG_CACHE_HOME": str(cache), **more},
        capture_output=True,
        text=True,
        check=True,
    )
    path, hits, misses = json.loads(done.stdout)
    return Path(path), hits, misses


def test_copies_share_what_is_compiled_and_a_change_anywhere_does_not(tmp_path: Path) -> None:
    one, other, cache = tmp_path / "one", tmp_path / "other", tmp_path / "cache"
    for home in (one, other):
        shutil.copytree(Path(miburi.__file__).parent, home / "miburi", ignore=shutil.ignore_patterns("*.pyc"))
    path, hits, misses = call(one, cache)
    assert (hits, misses) == (0, 1)
    assert cache in path.parents
    assert call(other, cache) == (path, 1, 0)
    # numba itself would not see a change in another module
    with open(other / "miburi" / "errors.py", "a", encoding="utf-8") as file:
        file.write("\n# a change\n")
    changed, hits, misses = call(other, cache)
    assert changed != path
    assert (hits, misses) == (0, 1)
    own, _, _ = call(one, cache, NUMBA_CACHE_DIR=str(tmp_path / "mine"))
    assert tmp_path / "mine" in own.parents
