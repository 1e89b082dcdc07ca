"""Labelled takes of hands."""

from __future__ import annotations

import numpy as np

from miburi.hands import longest_match


def take(labels: str, start: float) -> tuple[np.ndarray, list[tuple[int, int, str]]]:
    words = labels.split()
    angles = start + np.arange(3.0 * len(words))[:, None] * np.ones(48)
    return angles, [(3 * k, 3 * k + 3, word) for k, word in enumerate(words)]


def test_the_recording_that_shows_most_of_the_string_begins_where_it_does() -> None:
    takes = [take("r rs s sr r", 0.0), take("x p ps s sr r rp", 100.0)]
    angles, intervals = longest_match(takes, ["r", "rp", "p", "ps", "s", "sr", "r"])
    assert angles[0, 0] == 103.0
    assert len(angles) == 18
    assert intervals[0] == (0, 3, "p")
    assert [label for _, _, label in intervals] == ["p", "ps", "s", "sr", "r", "rp"]


def test_a_string_that_nobody_recorded_is_shown_from_the_beginning() -> None:
    angles, intervals = longest_match([take("r rs", 0.0)], ["z"])
    assert len(angles) == 6
    assert [label for _, _, label in intervals] == ["r", "rs"]
