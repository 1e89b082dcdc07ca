"""Pages of a finished run in a headless browser, opened from disk."""

from __future__ import annotations

import csv
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.workflow.conftest import Project, finished  # noqa: F401

from miburi.formats import puppet
from miburi.report import search
from miburi.retrieval.body import features, reset_angles

ROOT = Path(__file__).parents[2]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Headless Chromium of the system."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if CHROMIUM is None:
        pytest.skip("Chromium is not installed (on Debian: apt-get install chromium)")
    with playwright.sync_playwright() as p:
        chromium = p.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield chromium
        chromium.close()


@pytest.fixture(scope="session")
def pages(finished: Project, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:  # noqa: F811
    """The report of a finished run, and the page of one of its queries as a search of its own."""
    results = finished.path / "results" / "everyday"
    logs = sorted((finished.path / "data/raw/everyday/queries/experiment1/logs").glob("*.csv"))
    folder = tmp_path_factory.mktemp("results") / "results" / "everyday" / "search"
    folder.mkdir(parents=True)
    table = folder / "mine.csv"
    from miburi.retrieval.index import Index

    index = Index.open(results / "index.h5")
    with open(results / "takes.csv", encoding="utf-8", newline="") as file:
        fps = {row["take"]: float(row["fps"]) for row in csv.DictReader(file)}
    query = reset_angles(features(puppet.read(logs[0])))
    found = index.rank(query, k=12)
    lines = ["rank,take,start_s,end_s,score,measure,queries"]
    for rank, (i, score) in enumerate(zip(found.order, found.score, strict=True), 1):
        rate = fps[index.take[i]]
        span = f"{index.start[i] / rate:.3f},{index.end[i] / rate:.3f}"
        lines.append(f"{rank},{index.take[i]},{span},{score:.6g},DSPM(PCA),simulated")
    table.write_text("\n".join(lines) + "\n")
    motions = [str(p) for p in sorted((results / "motion").glob("*.h5"))]
    page = folder / "mine.html"
    page.write_text(
        search.page(str(table), str(logs[0]), str(results / "index.h5"), motions, query, {"simulated": True})
    )
    return {"report": finished.path / "results" / "report.html", "search": page}
