"""Pages hold what they are given, whole, escaped and by themselves."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from PIL import Image
from tests.evaluate.test_tables import scores

from miburi.evaluate.tables import table
from miburi.report import bodies, intervals, run
from miburi.report.pack import Clips, packed_json
from miburi.report.page import Table, embedded, read_table, render
from miburi.report.words import COLUMNS, SUFFIXES, columns

HOSTILE = "<img src=x onerror=alert(1)></script><script>alert(2)</script>"


def search_page(name: str = "q", bvh: dict[str, str] | None = None) -> str:
    results = [{"rank": 1, "clip": "none", "take": name, "file": "a.bvh", "words": name, "shares": None}]
    return render(
        "search.html",
        Clips(),
        {"search": packed_json({"query": {"clip": name, "words": name}, "results": results})},
        {},
        title=name,
        words=name,
        simulated=name,
        path=f"results/a/search/{name}.csv",
        table=Table(("rank", name), (("1", name),)),
        bvh=bvh or {},
    )


def test_text_from_files_is_shown_as_text() -> None:
    text = search_page(HOSTILE, {HOSTILE: "AAAA"})
    assert "<img" not in text.split("<script>")[0]
    assert text.count("</script>") == len(re.findall(r"<script[ >]", text))
    assert "&lt;img" in text


def test_names_in_json_cannot_end_the_script() -> None:
    clips = Clips()
    clips.about[HOSTILE] = {"frames": 1, "fps": 1.0}
    text = render("search.html", clips, {}, {}, **FACTS)
    found = re.search(r'id="clips">(.*?)</script>', text, re.S)
    assert found
    assert json.loads(found.group(1))["clips"] == clips.about


FACTS = {"title": "t", "words": "w", "simulated": "", "path": "p", "table": Table(("a",), ()), "bvh": {}}


def test_the_same_facts_give_the_same_bytes_and_ask_nobody_else() -> None:
    text = search_page()
    assert text == search_page()
    assert not re.search(r"(src|href)=[\"']?(https?:|//)|@import|url\(", text)
    assert "Leon Sorokin" in text, "uPlot's licence goes with it"


def test_means_come_first_and_numbers_stand_to_the_right(tmp_path: Path) -> None:
    (tmp_path / "t.csv").write_text("keyword,hit10,hit10_paper\na<b,3,4\nmean,3,\n")
    table = read_table(tmp_path / "t.csv", mean="keyword")
    assert table.head == (("mean", "3", ""),)
    assert table.numeric == (False, True, True)
    assert table.records()[0] == {"keyword": "a<b", "hit10": "3", "hit10_paper": "4"}


def test_pictures_become_smaller_not_larger(tmp_path: Path) -> None:
    Image.linear_gradient("L").convert("RGB").resize((500, 500)).save(tmp_path / "p.png")
    data = embedded(tmp_path / "p.png")
    assert data.startswith("data:image/")
    assert len(data) < 1.4 * (tmp_path / "p.png").stat().st_size
    assert data == embedded(tmp_path / "p.png")


def row(**cells: str) -> dict[str, str]:
    return {"protocol": "1", "keyword": "mean", **cells}


def test_takes_that_show_something_go_first() -> None:
    subjects = {"a1": "a", "a2": "a", "a3": "a", "b1": "b", "b2": "b"}
    pieces = {"a1": 1, "a2": 9, "a3": 4, "b1": 2, "b2": 7}
    assert bodies.chosen(subjects, pieces, {}) == ["a2", "b2", "a3", "b1", "a1"]
    assert bodies.chosen(subjects, pieces, {"a3": 3, "b1": 1}, most=3) == ["a3", "b2", "a2"]


def test_dots_lie_on_their_scale() -> None:
    rows = [
        row(
            measure="A",
            hit10="2.5",
            users="5",
            hit10_low="0",
            hit10_high="5",
            hit10_paper="",
            users_paper="",
            chance10="1",
        ),
        row(
            measure="B",
            hit10="",
            users="",
            hit10_low="",
            hit10_high="",
            hit10_paper="4",
            users_paper="4",
            chance10="",
        ),
        row(
            measure="C",
            hit10="",
            users="",
            hit10_low="",
            hit10_high="",
            hit10_paper="",
            users_paper="",
            chance10="",
        ),
        row(
            measure="A",
            hit10="1",
            users="5",
            hit10_low="",
            hit10_high="",
            hit10_paper="",
            users_paper="",
            chance10="",
        )
        | {"keyword": "wave"},
    ]
    (plot,) = intervals.hits(rows)
    a, b = plot.dots
    left, right = plot.ticks[0][0], plot.ticks[-1][0]
    assert (a.low, a.high) == (left, right)
    assert a.ours == pytest.approx((left + right) / 2)
    assert b.ours is None
    assert b.paper == right
    assert "ours 0.5 (0 to 1)" in a.words


def test_ranks_are_on_a_logarithmic_scale() -> None:
    names = ("mean_rank", "mean_rank_low", "mean_rank_high", "mean_rank_paper", "chance_rank")
    (plot,) = intervals.ranks(
        [row(measure="A", **dict(zip(names, ("10", "1", "100", "10", "100"), strict=True)))]
    )
    (dot,) = plot.dots
    assert dot.ours == dot.paper
    assert dot.ours - dot.low == pytest.approx(dot.high - dot.ours, abs=0.2)
    assert intervals.ranks([]) == []


def test_all_columns_of_rankings_are_explained() -> None:
    played = [s for measure in ("DTW", "DSPM(PCA)", "mean pose") for s in scores(measure)]
    for name in ("table1", "table2", "table4", "differences1", "other_people"):
        (first, *_) = table(name, played)
        explained = dict(columns(list(first)))
        for column in set(first) - {"measure"}:
            assert column.replace("_", " ") in explained or any(
                column.endswith(end) and f"… {end[1:].replace('_', ' ')}" in explained for end in SUFFIXES
            ), f"{name}: {column}"
    assert columns(["label", "value"]) == [("value", COLUMNS["value"])]


def test_jobs_are_added_up(tmp_path: Path) -> None:
    for name, seconds in (("rank/a/x.tsv", "1.5"), ("rank/b.tsv", "2"), ("page/page.tsv", "9")):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"s\tmax_rss\n{seconds}\t100\n")
    (tmp_path / "page/other.tsv").write_text("s\tmax_rss\n1\t-\n")
    table = run.benchmarks(tmp_path)
    assert table.rows == (("page", "2", "10.0", "9.0", "100"), ("rank", "2", "3.5", "2.0", "100"))
    assert run.benchmarks(tmp_path / "nowhere").rows == ()
