"""The CMU database is fetched, read, cut and indexed, from a server on the loopback address."""

from __future__ import annotations

import csv
import gzip
import threading
from pathlib import Path

from tests.test_fetch import Site
from tests.workflow.conftest import Project

CONFIG = """\
corpora:
  cmu:
    kind: body
    fetch: ["02"]
    site: {site}
"""


def test_a_subject_from_the_site_to_the_index(copy: Project, recordings: Path) -> None:
    folder = recordings / "body" / "cmu"
    files = {"02.asf": (folder / "02.asf").read_bytes()}
    for path in sorted(folder.glob("02_*.amc.gz")):
        files[path.name.removesuffix(".gz")] = gzip.decompress(path.read_bytes())
    site = Site(files)
    site.broken["02_03.amc"] = 1
    threading.Thread(target=site.serve_forever, daemon=True).start()
    try:
        (copy.path / "config" / "mine.yaml").write_text(CONFIG.format(site=site.address))
        run = copy.snakemake("--configfile=config/mine.yaml", "results/cmu/index.h5", "results/cmu/takes.csv")
    finally:
        site.shutdown()
    assert run.status == 0, run.terminal[-3000:]
    with open(copy.path / "results" / "cmu" / "takes.csv", encoding="utf-8", newline="") as file:
        takes = list(csv.DictReader(file))
    assert [t["take"] for t in takes] == [f"02_{k:02d}" for k in range(1, 11)]
    assert {t["fps"] for t in takes} == {"120.0"}
    assert not list((copy.path / "data" / "raw" / "cmu" / "arriving").glob("*")), "nothing is left over"
