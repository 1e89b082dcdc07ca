"""Tables hold what the papers printed beside ours; metrics are compared in their own direction."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from miburi.errors import InputError
from miburi.evaluate import printed
from miburi.evaluate.metrics import compare, of_scores, of_segmentation, read_metrics, write_metrics
from miburi.evaluate.protocols import Score
from miburi.evaluate.tables import label_counts, table

KEYWORDS = list(dict.fromkeys(r["keyword"] for r in printed.table("table1")))

# [P]'s averages recomputed from its rows: hits in 10 (in 5) of protocols 1 and 2, mean rank
MEANS = {
    "DTW": (3.5, 2.4, 2.8, 2.5, 42.6),
    "SM(PCA)": (4.4, 3.7, 4.3, 3.6, 19.0),
    "SM(GP-LVM)": (1.2, 0.5, 1.5, 0.9, 110.8),
    "MSM": (4.2, 3.9, 4.5, 3.9, 23.3),
    "DSPM(PCA)": (4.8, 4.4, 4.4, 3.8, 7.4),
    "DSPM(GP-LVM)": (2.8, 2.3, 2.4, 1.6, 52.3),
}


def scores(measure: str = "DSPM(PCA)", rank: float = 4.0, hit: int = 1) -> list[Score]:
    return [
        Score(
            "e",
            protocol,
            f"q{protocol}{keyword}{user}",
            keyword,
            f"u{user}",
            "hand",
            0.5,
            measure,
            269,
            9,
            rank if protocol == 1 else 0.0,
            2,
            hit,
            hit,
            0.5,
            0.4,
            0.2,
            135.0,
            27.0,
            0.3,
            0.16,
            0.01,
            "simulated",
            f"ranks/{measure}.h5",
        )
        for protocol in (1, 2, 3)
        for keyword in KEYWORDS
        for user in range(5)
    ]


def test_every_printed_hit_stands_in_table_1() -> None:
    rows = {(r["protocol"], r["measure"], r["keyword"]): r for r in table("table1", scores())}
    for r in printed.table("table1"):
        found = rows[int(r["protocol"]), r["measure"], r["keyword"]]
        assert (found["hit10_paper"], found["hit5_paper"]) == (r["users_hit_top10"], r["users_hit_top5"])
        assert found["queries"] == "simulated"


@pytest.mark.parametrize("measure", MEANS)
def test_recomputed_averages(measure: str) -> None:
    wanted = MEANS[measure]
    means = {(r["protocol"], r["measure"]): r for r in table("table1", scores()) if r["keyword"] == "mean"}
    for protocol, ten, five in ((1, *wanted[:2]), (2, *wanted[2:4])):
        row = means[protocol, measure]
        assert row["hit10_paper"] == pytest.approx(ten, abs=0.051)
        assert row["hit5_paper"] == pytest.approx(five, abs=0.051)
    ranks = {r["measure"]: r for r in table("table2", scores()) if r["keyword"] == "mean"}
    assert ranks[measure]["mean_rank_paper"] == pytest.approx(wanted[4], abs=0.051)


def test_ours_is_counted() -> None:
    rows = {(r["protocol"], r["measure"], r["keyword"]): r for r in table("table1", scores())}
    row = rows[1, "DSPM(PCA)", "squats"]
    assert (row["hit10"], row["hit5"], row["users"], row["chance10"]) == (5, 5, 5, 1.5)
    assert rows[1, "DSPM(PCA)", "mean"]["hit10"] == 5
    assert rows[1, "DSPM(GP-LVM)", "mean"]["hit10"] == ""
    assert rows[1, "DSPM(GP-LVM)", "mean"]["note"] == "not among this run's measures"
    assert row["ranks"] == "ranks/DSPM(PCA).h5"
    assert row["hit10_mean_pose"] == ""
    with_naive = scores() + scores("mean pose", hit=0)
    rows = {(r["protocol"], r["measure"], r["keyword"]): r for r in table("table1", with_naive)}
    for keyword in ("squats", "mean"):
        row = rows[2, "DSPM(PCA)", keyword]
        assert (row["hit10"], row["hit10_mean_pose"], row["hit5_mean_pose"]) == (5, 0, 0)
    assert rows[1, "MSM", "mean"]["note"] == "not among this run's measures"
    assert rows[1, "DSPM(PCA)", "mean"]["note"] == ""


def test_seconds_beside_the_papers() -> None:
    rows = table("table5", scores())
    assert len([r for r in rows if r["measure"] == "DSPM(PCA)"]) == 2
    assert {r["seconds_paper"] for r in rows} >= {"37.1", "0.54", "0.0023"}
    assert {r["seconds"] for r in rows if r["measure"] == "DSPM(PCA)"} == {"0.01"}


def test_the_first_of_a_class_stands_beside_the_clip_shown() -> None:
    rows = {(r["measure"], r["keyword"]): r for r in table("table2", scores() + scores("mean pose", rank=9))}
    row = rows["DSPM(PCA)", "mean"]
    assert (row["mean_rank"], row["mean_first"], row["mean_rank_mean_pose"]) == (4, 2, 9)
    assert (row["chance_rank"], row["chance_first"]) == (135, 27)


def test_measures_are_compared_query_by_query() -> None:
    mine = [replace(s, rank=float(i % 7), hit10=i % 2) for i, s in enumerate(scores())]
    theirs = [
        replace(s, measure="DTW", rank=s.rank + 1 + (i % 3), hit10=1, ranks="ranks/DTW.h5")
        for i, s in enumerate(mine)
    ]
    rows = {(r["protocol"], r["measure"], r["figure"]): r for r in table("differences1", mine + theirs)}
    assert {m for _, m, _ in rows} == {"DTW"}
    row = rows[1, "DTW", "rank"]
    assert row["difference"] == pytest.approx(row["value"] - row["value_against"], abs=1e-3)
    # spread of the differences, not of the ranks: pairs are kept together
    gaps = [t.rank - m.rank for m, t in zip(mine, theirs, strict=True) if m.protocol == 1]
    half = 1.96 * np.std(gaps) / np.sqrt(len(gaps))
    assert row["difference_low"] == pytest.approx(np.mean(gaps) - half, abs=0.05)
    assert row["difference_high"] == pytest.approx(np.mean(gaps) + half, abs=0.05)
    assert float(row["wilcoxon_p"]) < 1e-4
    assert row["ranks"] == "ranks/DSPM(PCA).h5, ranks/DTW.h5"
    assert (2, "DTW", "rank") not in rows
    assert rows[2, "DTW", "precision5"]["difference"] == 0
    assert table("differences2", theirs) == []


def test_other_people() -> None:
    rows = {(r["measure"], r["keyword"]): r for r in table("other_people", scores() + scores("mean pose"))}
    row = rows["DSPM(PCA)", "mean"]
    assert (row["precision5"], row["precision10"], row["mean_average_precision"]) == (0.2, 0.4, 0.5)
    assert row["chance_precision"] == pytest.approx(9 / 269, abs=1e-3)
    assert (row["precision10_mean_pose"], row["users"], row["segments"]) == (0.4, 5, 269)


def test_label_counts_add_up() -> None:
    intervals = [("r", 10), ("r", 12), ("x", 3)]
    lengths = [{"quantity": "length, exit, exact", "value": "219", "unit": "frames"}]
    rows = {
        (r["quantity"], r["label"]): r for r in label_counts(intervals, lengths, printed.STRING, "simulated")
    }
    assert rows["frames", "all"]["value"] == 25
    assert (rows["frames", "all"]["paper"], rows["intervals", "all"]["paper"]) == (4197, 245)
    assert (rows["intervals", "r"]["value"], rows["intervals", "r"]["paper"]) == (2, 42)
    assert rows["frames", "x"]["paper"] == ""
    assert rows["length, exit, exact", ""]["paper"] == 238
    others = label_counts(intervals, lengths, "r rp p", "recorded")
    assert others[-1]["paper"] == ""


def test_cuts_are_metrics_where_there_are_bounds() -> None:
    row = {"take": "all", "method": "PPCA", "cuts": "4", "bounds": "5", "precision": "0.75", "recall": "0.6"}
    found = of_segmentation("c", [{**row, "take": "one"}, row, {**row, "method": "PCA", "bounds": "0"}])
    assert {n: (m["value"], m["better"]) for n, m in found.items()} == {
        "c/segmentation/PPCA/precision": (0.75, "higher"),
        "c/segmentation/PPCA/recall": (0.6, "higher"),
    }
    assert of_segmentation("c", [{**row, "cuts": "0", "precision": "nan"}]) == {}


def test_metrics_are_compared(tmp_path: Path) -> None:
    was, now = of_scores(scores(rank=4.0)), of_scores(scores(rank=5.0, hit=0))
    verdicts = {c.name: c.verdict for c in compare(now, was)}
    assert verdicts["e/protocol 1/DSPM(PCA)/rank of target"] == "worse"
    assert verdicts["e/protocol 1/DSPM(PCA)/hit10"] == "worse"
    assert verdicts["e/protocol 1/DSPM(PCA)/average precision"] == "same"
    verdicts = {c.name: c.verdict for c in compare(was, now)}
    assert verdicts["e/protocol 1/DSPM(PCA)/rank of target"] == "better"
    gone = compare({}, was)
    assert {c.verdict for c in gone} == {"gone"} and all(c.bad for c in gone)
    new = compare(was, {})
    assert {c.verdict for c in new} == {"new"} and not any(c.bad for c in new)
    close = {"m": {"value": 10.2, "unit": "", "better": "lower", "tolerance": 0.2}}
    edge = {"m": {"value": 10.0, "unit": "", "better": "lower", "tolerance": 0.2}}
    assert compare(close, edge)[0].verdict == "same"
    assert compare({"m": {**close["m"], "value": 10.3}}, edge)[0].verdict == "worse"
    exact = {"m": {"value": 10.0, "unit": "", "better": "equal", "tolerance": 0.0}}
    assert compare({"m": {**exact["m"], "value": 9.0}}, exact)[0].verdict == "changed"
    write_metrics(tmp_path / "m.json", was)
    assert read_metrics(tmp_path / "m.json") == was
    (tmp_path / "m.json").write_text("{}")
    with pytest.raises(InputError, match=r"m\.json: is no file of metrics"):
        read_metrics(tmp_path / "m.json")


def test_test_users_are_in_no_tuning_code() -> None:
    """Only configs and what runs experiments may name the split of the test users."""
    root = Path(__file__).parents[2]
    allowed = {"src/miburi/config.py", "src/miburi/perform/puppeteer/users.py"}
    for path in [*root.glob("src/**/*.py"), *root.glob("benchmarks/*.py"), *root.glob("workflow/**/*.py")]:
        name = str(path.relative_to(root))
        text = path.read_text(encoding="utf-8")
        if name not in allowed and "users(" in text:
            assert '"test"' not in text, name
