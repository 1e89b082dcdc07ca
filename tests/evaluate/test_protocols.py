"""Queries, scores and chance levels against their definitions written out."""

from __future__ import annotations

from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi.errors import InputError
from miburi.evaluate.protocols import read_scores, score, write_scores
from miburi.evaluate.queries import (
    Query,
    keywords_of,
    left_out,
    plan_queries,
    read_queries,
    write_queries,
)
from miburi.evaluate.ranks import Ranks, read_ranks, write_ranks
from miburi.evaluate.statistics import chance_first, chance_of_hit, chance_rank, difference, interval
from miburi.perform.puppeteer import users

SEGMENTS = [("a", 0, 100), ("a", 100, 200), ("b", 0, 50), ("b", 50, 150), ("c", 0, 80), ("c", 80, 90)]
INTERVALS = [("a", 0, 90, "wave"), ("a", 110, 190, "kick"), ("b", 0, 150, "wave"), ("c", 0, 80, "kick")]
SUBJECTS = {"a": "ann", "b": "bob", "c": "bob"}


def ranks(distance: np.ndarray, names: list[str]) -> Ranks:
    order = np.argsort(distance, axis=1, kind="stable")
    return Ranks(
        tuple(names),
        order,
        np.take_along_axis(distance, order, 1),
        np.ones(len(names)),
        "M",
        "E",
        "simulated",
    )


def test_keywords_by_hand() -> None:
    assert keywords_of(SEGMENTS, INTERVALS) == [{"wave"}, {"kick"}, {"wave"}, {"wave"}, {"kick"}, set()]


@given(st.integers(0, 50), st.integers(1, 50), st.integers(0, 50), st.integers(1, 50))
def test_half_of_the_shorter_one(start: int, length: int, first: int, span: int) -> None:
    shared = len(set(range(start, start + length)) & set(range(first, first + span)))
    found = keywords_of([("t", start, start + length)], [("t", first, first + span, "k")])
    assert found == [{"k"} if 2 * shared >= min(length, span) else set()]


def plan(
    protocols: list[int], *, imagined: bool = False, keywords: tuple[str, ...] = ("wave", "kick")
) -> list[Query]:
    people = users("e", "development", 3, 1)
    return plan_queries(
        "e", protocols, keywords, people, SEGMENTS, INTERVALS, SUBJECTS, imagined=imagined, seed=7
    )


def test_protocol_1_shows_all_users_the_same_segment() -> None:
    queries = plan([1])
    assert len(queries) == 6
    found = dict(zip(SEGMENTS, keywords_of(SEGMENTS, INTERVALS), strict=True))
    for keyword in ("wave", "kick"):
        clips = {(q.take, q.start, q.end) for q in queries if q.keyword == keyword}
        assert len(clips) == 1
        assert keyword in found[clips.pop()]
    assert plan([1]) == queries


def test_protocol_2_never_ranks_what_was_played() -> None:
    for query in plan([2]):
        out = left_out(query, SEGMENTS, SUBJECTS)
        assert out[SEGMENTS.index((query.take, query.start, query.end))]
        rest = [
            k for s, k, o in zip(SEGMENTS, keywords_of(SEGMENTS, INTERVALS), out, strict=True) if not o and s
        ]
        assert any(query.keyword in k for k in rest), "there is still something to find"


def test_protocol_2_imagined_shows_nothing() -> None:
    for query in plan([2], imagined=True):
        assert query.take == ""
        assert not left_out(query, SEGMENTS, SUBJECTS).any()


def test_protocol_3_leaves_out_the_person_shown() -> None:
    for query in plan([3]):
        out = left_out(query, SEGMENTS, SUBJECTS)
        assert [SUBJECTS[s[0]] == SUBJECTS[query.take] for s in SEGMENTS] == out.tolist()


def test_keywords_that_are_not_there() -> None:
    with pytest.raises(InputError, match="no segment is 'jump'; there are kick, wave"):
        plan([1], keywords=("jump",))
    with pytest.raises(InputError, match="one segment only is 'kick'"):
        plan_queries(
            "e", [2], ["kick"], users("e", "development", 1, 1), SEGMENTS[:2], INTERVALS, SUBJECTS,
            imagined=False, seed=1,
        )  # fmt: skip


def test_queries_come_back(tmp_path: Path) -> None:
    queries = plan([1, 2, 3])
    write_queries(tmp_path / "q.tsv", queries)
    assert read_queries(tmp_path / "q.tsv") == queries
    text = (tmp_path / "q.tsv").read_text()
    (tmp_path / "q.tsv").write_text(text.replace("keyword", "word", 1))
    with pytest.raises(InputError, match="line 1: the column 'keyword' is missing"):
        read_queries(tmp_path / "q.tsv")
    (tmp_path / "q.tsv").write_text(text.replace("\t0\t", "\tx\t", 1))
    with pytest.raises(InputError, match="line 2: a number cannot be read"):
        read_queries(tmp_path / "q.tsv")


@given(st.integers(0, 10_000))
def test_scores_by_definition(seed: int) -> None:
    rng = np.random.default_rng(seed)
    distance = np.round(rng.random(6) * 4)  # with ties
    query = replace(plan([1])[0], take="a", start=0, end=100, keyword="wave")
    row = score(ranks(distance[None], [query.query]), [query], SEGMENTS, keywords_of(SEGMENTS, INTERVALS))[0]
    order = sorted(range(6), key=lambda i: (distance[i], i))
    relevant = [i in (0, 2, 3) for i in order]
    precisions = [sum(relevant[: k + 1]) / (k + 1) for k in range(6) if relevant[k]]
    assert row.average_precision == pytest.approx(sum(precisions) / 3)
    assert row.first == relevant.index(True) + 1
    better, equal = (distance < distance[0]).sum(), (distance == distance[0]).sum()
    assert row.rank == pytest.approx(better + (equal + 1) / 2)
    assert row.hit5 == any(relevant[:5])
    assert row.precision5 == sum(relevant[:5]) / 5
    assert row.precision10 == sum(relevant) / 6
    assert (row.segments, row.relevant) == (6, 3)


def test_left_out_segments_do_not_count() -> None:
    distance = np.array([[np.inf, 1, 2, 3, np.inf, 5]])
    query = replace(plan([1])[0], keyword="wave", protocol=2, take="", start=0, end=0)
    row = score(ranks(distance, [query.query]), [query], SEGMENTS, keywords_of(SEGMENTS, INTERVALS))[0]
    assert (row.segments, row.relevant, row.first, row.rank) == (4, 2, 2, 0)


def test_scores_and_ranks_come_back(tmp_path: Path) -> None:
    queries = plan([1])
    distance = np.random.default_rng(0).random((6, 6))
    found = ranks(distance, [q.query for q in queries])
    write_ranks(
        tmp_path / "r.h5", found.query, found.order, found.score, found.seconds,
        measure="M", experiment="E", queries="simulated", sources={},
    )  # fmt: skip
    again = read_ranks(tmp_path / "r.h5")
    assert np.array_equal(again.order, found.order)
    rows = score(again, queries, SEGMENTS, keywords_of(SEGMENTS, INTERVALS))
    write_scores(tmp_path / "s.csv", rows)
    for one, other in zip(read_scores(tmp_path / "s.csv"), rows, strict=True):
        assert one.average_precision == pytest.approx(other.average_precision, rel=1e-5)
        rounded = dict.fromkeys(
            (
                "average_precision",
                "precision10",
                "precision5",
                "chance_first",
                "chance_hit10",
                "chance_hit5",
                "skill",
            ),
            0,
        )
        assert replace(one, **rounded) == replace(other, **rounded)


@pytest.mark.parametrize(("segments", "relevant", "first"), [(7, 2, 3), (6, 0, 5), (5, 5, 1), (4, 2, 10)])
def test_chance_by_enumeration(segments: int, relevant: int, first: int) -> None:
    shown = min(first, segments)
    hits = [any(i < relevant for i in c) for c in combinations(range(segments), shown)]
    assert chance_of_hit(segments, relevant, first) == pytest.approx(np.mean(hits))
    assert chance_rank(segments) == np.mean(np.arange(segments) + 1)
    firsts = [min(c) + 1 for c in combinations(range(segments), relevant)] if relevant else [0]
    assert chance_first(segments, relevant) == pytest.approx(np.mean(firsts))


def test_interval_of_a_mean() -> None:
    x = np.random.default_rng(3).normal(size=200)
    low, high = interval(x)
    half = 1.96 * x.std() / np.sqrt(len(x))
    assert low == pytest.approx(x.mean() - half, abs=0.03)
    assert high == pytest.approx(x.mean() + half, abs=0.03)
    assert interval([2.0, 2.0]) == (2.0, 2.0)
    assert interval(x) == (low, high)


def test_paired_difference() -> None:
    x = np.random.default_rng(4).normal(size=30)
    assert difference(x.tolist(), x.tolist()) == (0.0, 0.0, 0.0, 1.0)
    found = difference((x + 1).tolist(), x.tolist())
    assert found.p < 1e-4
    assert found[:3] == pytest.approx((1, 1, 1))
