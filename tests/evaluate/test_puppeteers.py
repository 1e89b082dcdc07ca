"""Our users beside logs of another origin: ranks by hand, who may play, what is missing."""

from __future__ import annotations

import csv
import shutil
from pathlib import Path

import numpy as np
import pytest

from miburi import flow
from miburi.errors import InputError
from miburi.evaluate.puppeteers import Target, compare, rank_of, read_targets, write_comparison
from miburi.formats import puppet
from miburi.perform.puppeteer import imitate, users
from miburi.retrieval.body import features, reset_angles
from miburi.retrieval.index import Index

SETTINGS = {"angle_weight": 0.3, "mapped": True}
MEASURES = ["mean pose", "DSPM(PCA)"]
SAMPLE = Path(__file__).parents[2] / "data" / "samples" / "wave.bvh"


def clip(k: int):
    """Somebody who moves one joint or another."""
    a = np.zeros((120, 17))
    a[:, k] = 70 * np.sin(np.linspace(0, np.pi, 120)) ** 2
    return puppet.motion(a, 60.0, name=f"clip{k}")


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """An index of five clips, the clips, and two logs by somebody else."""
    clips = {f"clip{k}": clip(k) for k in (1, 4, 9, 11, 15)}
    values = [reset_angles(features(m, **SETTINGS)) for m in clips.values()]
    index = Index.build(values, [(name, i, 0, 120) for i, name in enumerate(clips)])
    home, logs = tmp_path_factory.mktemp("logs"), {}
    (stranger,) = users("elsewhere", "development", 1, 99)
    for k in (1, 9):
        logs[f"q{k}"] = home / f"q{k}.csv"
        puppet.write_log(logs[f"q{k}"], *imitate(clips[f"clip{k}"], stranger, seed_parts=(k,)))
    return index, clips, logs


def compared(made, players, **changes):
    index, clips, logs = made
    targets = [Target("q1", "clip1", "hand", "0.5"), Target("q9", "clip9", "stage", "0.7")]
    given = {"measures": MEASURES, "reduction": "max", "settings": SETTINGS, "simulated": False, "seed": 0}
    return compare(index, targets, logs, clips, players, **given | changes)


def test_ranks_are_those_of_sorted_distances(made):
    index, clips, logs = made
    players = users("unit", "development", 2, 0)
    rows = {(r.query, r.measure): r for r in compared(made, players)}
    for query, take in (("q1", "clip1"), ("q9", "clip9")):
        motions = [puppet.read(logs[query])]
        motions += [
            puppet.motion(*imitate(clips[take], u, seed_parts=(0, "puppeteers", query))) for u in players
        ]
        for measure in MEASURES:
            by_hand = []
            for m in motions:
                d = index.distances(reset_angles(features(m, **SETTINGS)), measure)
                mine = d[index.take.index(take)]
                by_hand.append(1 + sum(d < mine) + (sum(d == mine) - 1) / 2)
            row = rows[query, measure]
            assert row.rank == by_hand[0] and row.rank_ours == pytest.approx(np.mean(by_hand[1:]))
            assert (row.lowest_ours, row.highest_ours) == (min(by_hand[1:]), max(by_hand[1:]))
            assert (row.users, row.segments, row.chance_rank, row.queries) == (2, 5, 3.0, "recorded")
    for measure in MEASURES:
        single = [rows[q, measure] for q in ("q1", "q9")]
        assert rows["mean", measure].rank == np.mean([r.rank for r in single])
        assert rows["median", measure].rank_ours == np.median([r.rank_ours for r in single])


def test_ties_count_at_their_middle(made):
    index, clips, _ = made
    x = reset_angles(features(clips["clip4"], **SETTINGS))
    twice = Index.build([x, x], [("a", 0, 0, 120), ("b", 1, 0, 120)])
    assert rank_of(twice, x, "a", "mean pose", "max") == 1.5 == rank_of(twice, x, "b", "mean pose", "max")
    with pytest.raises(InputError, match="no segment of the take 'nobody'"):
        rank_of(index, x, "nobody", "mean pose", "max")


def test_no_test_user_plays(made):
    with pytest.raises(InputError, match="unit-test-1"):
        compared(made, users("unit", "test", 1, 0))


def test_what_is_missing_is_named(made, tmp_path):
    index, clips, logs = made
    with pytest.raises(InputError, match="'q9'"):
        compared((index, clips, {"q1": logs["q1"]}), users("unit", "development", 1, 0))
    table = tmp_path / "targets.tsv"
    table.write_text("query\tclass\tclip\tstyle\nq1\tclip\t1\thand\n", encoding="utf-8")
    assert read_targets(table, "{class}{clip}") == [Target("q1", "clip1", "hand", "")]
    with pytest.raises(InputError, match="'kind'"):
        read_targets(table, "{kind}")


def test_a_comparison_is_a_table(made, tmp_path):
    rows = compared(made, users("unit", "development", 1, 0), simulated=True)
    write_comparison(tmp_path / "p.csv", rows)
    with open(tmp_path / "p.csv", encoding="utf-8", newline="") as file:
        back = list(csv.DictReader(file))
    assert [r["query"] for r in back] == ["q1", "q1", "q9", "q9", "mean", "mean", "median", "median"]
    assert {r["queries"] for r in back} == {"simulated"}
    assert [float(r["rank"]) for r in back] == pytest.approx([r.rank for r in rows], rel=1e-3)


def test_it_is_asked_for_where_there_are_such_logs(tmp_path):
    shutil.copy(SAMPLE, tmp_path / "wave.bvh")
    config = {
        "corpora": {"mine": {"kind": "body", "groups": [{"folder": str(tmp_path), "files": ["*.bvh"]}]}},
        "search": {"mine": {"folder": str(tmp_path), "targets": f"{tmp_path}/targets.tsv"}},
        "experiments": {"e": {"corpus": "mine", "keywords": ["wave"], "measures": MEASURES, "users": 3}},
    }
    assert flow.plan(config).comparisons() == []
    (tmp_path / "targets.tsv").write_text("query\ttake\n", encoding="utf-8")
    (tmp_path / "log.csv").write_text("", encoding="utf-8")
    found = flow.plan(config)
    assert found.comparisons() == ["results/mine/puppeteers.csv"]
    asked = found.to_compare("mine")
    assert (asked["experiment"], asked["users"], asked["queries"]) == ("e", 3, ["log"])
