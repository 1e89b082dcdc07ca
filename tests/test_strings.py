"""Strings of labels: their grammar, what recordings show of their order, and what is said of wrong ones."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from miburi import InputError
from miburi.strings import Succession, draw, label_of, parse, successions, untrainable

TAKES = [
    [(0, 5, "r"), (5, 9, "rp"), (9, 20, "p"), (20, 25, "pr"), (25, 30, "r")],
    [(3, 9, "p"), (9, 12, "ps"), (14, 20, "s")],  # a gap before s
]
PAIRS = successions(TAKES)


def test_successions_are_counted_where_nothing_lies_between():
    assert [tuple(p) for p in PAIRS] == [
        ("p", "pr", 1), ("p", "ps", 1), ("pr", "r", 1), ("r", "rp", 1), ("rp", "p", 1),
    ]  # fmt: skip
    shuffled = [list(reversed(t)) for t in reversed(TAKES)]
    assert successions(shuffled) == PAIRS


def test_the_grammar():
    words = parse("r*2 rp=1.5s p r*0.25", ["r", "rp", "p"])
    assert [tuple(w[1:]) for w in words] == [
        ("r", 2.0, None),
        ("rp", 1.0, 1.5),
        ("p", 1.0, None),
        ("r", 0.25, None),
    ]
    assert [label_of(w.text) for w in words] == ["r", "rp", "p", "r"]
    strange = parse("a*2 a*2*3", ["a*2", "a"])  # labels may hold any sign
    assert [tuple(w[1:]) for w in strange] == [("a*2", 1.0, None), ("a*2", 3.0, None)]


@pytest.mark.parametrize(
    ("string", "said"),
    [
        ("", "the string of labels is empty"),
        ("r rx p", "string 'r rx p': label 2 is 'rx', known are p, pr, ps, r, rp, s"),
        ("r x*2", r"label 2 is 'x' \(of 'x\*2'\), known are"),
        ("r r*0", r"label 2 is 'r\*0', expected it to last longer than 0"),
        ("r=0s", "label 1 is 'r=0s', expected it to last longer than 0"),
        ("r*-1", r"label 1 is 'r\*-1', known are"),
        ("r=2", "label 1 is 'r=2', known are"),
        (
            "r rp p r",
            "labels 3 and 4 are 'p' and 'r', which follow each other in no recording; after it come pr, ps",
        ),
        ("r rp p ps s", "labels 4 and 5 are 'ps' and 's', .* nothing comes after it"),
    ],
)
def test_wrong_strings(string, said):
    with pytest.raises(InputError, match=said):
        parse(string, ["p", "pr", "ps", "r", "rp", "s"], PAIRS)


def test_any_order_where_no_recordings_are_given():
    assert len(parse("p r p", ["p", "r"])) == 3
    assert len(parse("r*3 rp p pr=2s r", ["p", "pr", "r", "rp"], PAIRS)) == 5


@given(st.integers(1, 30), st.integers(0, 10**6))
def test_drawn_strings_are_legal(count, seed):
    drawn = draw(PAIRS, count, seed)
    assert len(drawn) == count and drawn == draw(PAIRS, count, seed)
    parse(drawn, ["p", "pr", "ps", "r", "rp", "s"], PAIRS)


def test_drawn_strings_go_on_as_often_as_recordings_do():
    pairs = [
        Succession("a", "b", 3),
        Succession("a", "c", 1),
        Succession("b", "a", 3),
        Succession("c", "a", 1),
    ]
    drawn = draw(pairs, 4000, 0)
    after = Counter(other for one, other in pairwise(drawn) if one == "a")
    assert abs(after["b"] / after.total() - 0.75) < 0.05
    assert draw(pairs, 3, 1, "c")[0] == "c"


def test_strings_that_cannot_be_drawn():
    line = [Succession("a", "b", 1), Succession("b", "c", 1)]
    assert all(draw(line, 3, seed) == ("a", "b", "c") for seed in range(20))  # no other is that long
    with pytest.raises(InputError, match="4 labels: the recordings' successions are not that long"):
        draw(line, 4, 0)
    with pytest.raises(InputError, match="from 'b' are not that long"):
        draw(line, 3, 0, "b")


def test_labels_that_cannot_be_trained():
    lengths = {"r": [9, 9], "rp": [2, 1], "p": [9, 2], "s": np.array([3, 3]).tolist()}
    found = untrainable(lengths, 3, True, 2)
    assert list(found) == ["rp", "p"]
    assert "the longest of 2 intervals has 2 frames, expected 3 or more" in found["rp"]
    assert "record more of it, or train fewer states" in found["rp"]
    assert "1 of 2 intervals are long enough for 3 states, expected 2 or more" in found["p"]
    assert list(untrainable(lengths, 3, False, 2)) == ["rp"]
    assert list(untrainable(lengths, 1, True)) == []
