"""The page holds what it is given, whole and by itself."""

from __future__ import annotations

import re
from pathlib import Path

from miburi.report import Corpus, Film, Picture, Section, Table, page
from miburi.report.page import embedded, read_table

CORPORA = [Corpus("janken", "hand", True, 3, 139.9), Corpus("mine", "body", False, 2, 10.0)]


def sections(tmp_path: Path) -> list[Section]:
    (tmp_path / "t.csv").write_text("keyword,hit10,hit10_paper\na<b,3,4\nmean,3,4\n")
    (tmp_path / "p.png").write_bytes(b"\x89PNG")
    table = read_table(tmp_path / "t.csv", mean="keyword")
    picture = Picture(embedded(tmp_path / "p.png"), "a curve")
    return [
        Section("table1", "Table 1", "Hits.", "results/table1.csv", table),
        Section("fig4", "Figure 4", "A curve.", pictures=(picture,), films=(Film("film/x.mp4", "a film"),)),
        Section("none", "Nothing", "There is none.", table=Table(("a",), ())),
    ]


def test_everything_is_there(tmp_path: Path) -> None:
    text = page(sections(tmp_path), CORPORA)
    for word in ("Table 1", "a&lt;b", "Figure 4", "data:image/png;base64,iVBORw==", "film/x.mp4", "None."):
        assert word in text
    assert "Simulated, not recorded: janken" in text
    assert text == page(sections(tmp_path), CORPORA)


def test_it_asks_nobody_else(tmp_path: Path) -> None:
    text = page(sections(tmp_path), CORPORA)
    assert not re.search(r"https?://|src=\"/|<script", text)
    assert str(tmp_path) not in text


def test_mean_rows_come_first(tmp_path: Path) -> None:
    table = sections(tmp_path)[0].table
    assert table is not None
    assert table.head == (("mean", "3", "4"),)
    assert table.numeric == (False, True, True)


def test_a_run_without_anything() -> None:
    assert "simulated users" in page([], [])
