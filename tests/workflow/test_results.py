"""What a finished run of the small config has made."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import h5py
import numpy as np
import pytest
from tests.workflow.conftest import Project

from miburi.hmm import Model, Synthesis, synthesize
from miburi.render.film import decode

TABLES = ("table1", "table2", "table3", "table4", "table5", "label_counts")


def rows(path: Path) -> list[dict[str, str]]:
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("name", TABLES)
def test_tables_show_the_papers_figures_beside_ours(finished: Project, name: str) -> None:
    table = rows(finished.path / "results" / f"{name}.csv")
    assert table
    assert any(column.endswith("_paper") or column == "paper" for column in table[0])
    if name != "label_counts":
        assert {row["queries"] for row in table} == {"simulated"}


@pytest.mark.parametrize("name", ["fig4.png", "fig5.png", "fig6.png", "staircase.png"])
def test_figures(finished: Project, name: str) -> None:
    assert (finished.path / "results" / name).read_bytes().startswith(b"\x89PNG")


def test_the_film_has_a_frame_for_each_frame_of_the_motion(finished: Project) -> None:
    folder = finished.path / "results" / "janken"
    synthesis = Synthesis.open(folder / "synthesis" / "rock_scissors_paper.h5")
    fps, pictures = decode(folder / "film" / "rock_scissors_paper.mp4")
    assert fps == 30
    assert len(pictures) == len(synthesis)
    assert np.ptp(pictures) > 100, "something is drawn"


def test_artefacts_name_their_sources(finished: Project) -> None:
    found = sorted((finished.path / "results").rglob("*.h5"))
    assert found
    for path in found:
        with h5py.File(path) as file:
            assert file.attrs["format"].startswith("miburi/")
            sources = json.loads(file.attrs["sources"])
            assert sources, path
            assert not any(name.startswith("/") for name in sources), "no absolute paths"


def test_spliced_jumps_generated_does_not(finished: Project) -> None:
    table = {
        r["quantity"]: r for r in rows(finished.path / "results/janken/synthesis/rock_scissors_paper.csv")
    }
    generated = float(table["largest jump, generated"]["value"])
    spliced = float(table["largest jump at joins, spliced"]["value"])
    assert generated < 0.5 * spliced


def test_a_string_drawn_at_random_is_made_by_the_same_models(copy: Project) -> None:
    copy.edit("config/test.yaml", "strings:\n", "strings:\n  anything: {corpus: janken, random: 5}\n")
    run = copy.snakemake("results/janken/synthesis/anything.h5")
    assert run.status == 0, run.terminal[-2000:]
    folder = copy.path / "results/janken"
    words = (folder / "synthesis/anything.txt").read_text().split()
    assert len(words) == 5
    found = Synthesis.open(folder / "synthesis/anything.h5")
    models = {word: Model.open(folder / f"models/{word}.h5") for word in words}
    np.testing.assert_array_equal(found.trajectory, synthesize(models, " ".join(words)).trajectory)


def test_a_search_of_ones_own_log(copy: Project) -> None:
    log = sorted((copy.path / "data/raw/everyday/queries/experiment1/logs").glob("*.csv"))[0]
    mine = copy.path / "data" / "puppet" / "mine.csv"
    mine.parent.mkdir(parents=True, exist_ok=True)
    mine.write_bytes(log.read_bytes())
    run = copy.snakemake("results/everyday/search/mine.csv")
    assert run.status == 0, run.terminal[-2000:]
    table = rows(copy.path / "results/everyday/search/mine.csv")
    assert list(table[0])[:6] == ["rank", "take", "start_s", "end_s", "score", "measure"]
    assert [int(r["rank"]) for r in table] == list(range(1, len(table) + 1))
    scores = [float(r["score"]) for r in table]
    assert scores == sorted(scores)
    assert {r["queries"] for r in table} == {"simulated"}


def test_segmentation_is_scored_beside_chance(finished: Project) -> None:
    folder = finished.path / "results" / "everyday"
    table = rows(folder / "segmentation.csv")
    takes = rows(folder / "takes.csv")
    assert [r["take"] for r in table] == [*sorted(t["take"] for t in takes), "all"]
    last = table[-1]
    assert last["people"] == "simulated" and int(last["bounds"]) > 0
    assert float(last["recall"]) == pytest.approx(int(last["found"]) / int(last["bounds"]), abs=1e-3)
    for column in ("uniform_recall", "random_recall", "random_precision"):
        assert 0 <= float(last[column]) <= 1
    # simulated people fall as people do
    assert {t["suspected_fps"] for t in takes} == {""}
    lengths = rows(folder / "segment_lengths.csv")
    assert sum(int(r["segments"]) for r in lengths) == int(last["cuts"]) + len(takes)


def test_a_worse_metric_fails_the_check(copy: Project) -> None:
    path = copy.path / "config" / "baseline" / "test.json"
    baseline = json.loads(path.read_text())
    name = next(k for k, m in baseline["metrics"].items() if m["better"] == "lower" and m["value"] > 1)
    baseline["metrics"][name]["value"] /= 4
    path.write_text(json.dumps(baseline))
    run = copy.snakemake("check")
    assert run.status != 0
    assert name in run.last
    assert copy.snakemake("accept").status == 0
    assert copy.snakemake("check").status == 0
