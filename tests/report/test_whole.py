"""A report of little or nothing: what is absent is left out."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from miburi.config import check
from miburi.report.whole import FILMS, _films, report


def test_a_run_without_anything(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    config = check({"corpora": {"mine": {"kind": "body", "groups": [{"folder": "f", "files": ["*.bvh"]}]}}})
    takes = tmp_path / "results" / "mine" / "takes.csv"
    takes.parent.mkdir(parents=True)
    takes.write_text("take,subject,frames,fps,seconds,recording\n<b>a,s,60,30.0,2.0,f/a.bvh\n")
    about = {"mine": {"kind": "body", "simulated": False}}
    Path("results/left_out.csv").write_text("label,error\nr,0.1\n")
    given = {"takes": [str(takes)], "tables": ["results/left_out.csv"]}
    text = report(given, config.model_dump(mode="json"), about, {}, {})
    assert 'id="left_out">left out<' in text, "a table that the page does not know is shown all the same"
    assert "&lt;b&gt;a" in text
    assert "Simulated, not recorded" not in text
    for absent in ("segmentation", "gestures", "models", "retrieval", "films"):
        assert f'id="{absent}"' not in text
        assert f'href="#{absent}"' not in text


def test_films_that_are_too_large_lie_beside_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    folder = Path("results/mine/film")
    folder.mkdir(parents=True)
    for name, size in (("large", FILMS), ("small", 10)):
        (folder / f"{name}.mp4").write_bytes(os.urandom(size))
    paths = [str(folder / "large.mp4"), str(folder / "small.mp4")]
    large, small = _films(paths, {"mine": {"simulated": True}})
    assert large["source"] == "mine/film/large.mp4"
    assert not large["inside"]
    assert small["source"].startswith("data:video/mp4;base64,")
    assert "simulated" in small["alt"]
