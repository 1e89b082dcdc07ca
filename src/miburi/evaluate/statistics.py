"""How sure a mean is, what chance would give, whether two measures differ."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from miburi import store

# scipy.stats is imported where it is used: it costs most of a second, and most stages need none of it


def chance_of_hit(segments: int, relevant: int, first: int) -> float:
    """Probability that at least one of `relevant` is among the first of `segments` in random order."""
    from scipy.stats import hypergeom

    if relevant <= 0 or first <= 0:
        return 0.0
    return float(1.0 - hypergeom.pmf(0, segments, relevant, min(first, segments)))


def chance_rank(segments: int) -> float:
    """Expected rank of one segment in random order."""
    return (segments + 1) / 2


def chance_first(segments: int, relevant: int) -> float:
    """Expected rank of the first of `relevant` segments in random order; 0 where there is none."""
    return (segments + 1) / (relevant + 1) if relevant else 0.0


def interval(values: ArrayLike, seed_name: object = 0, level: float = 0.95) -> tuple[float, float]:
    """Bootstrap interval of a mean (percentiles, 2000 draws); of fewer than two values, or equal ones, the mean."""
    from scipy.stats import bootstrap

    x = np.asarray(values, dtype=np.float64)
    if len(x) < 2 or np.ptp(x) == 0:
        mean = float(x.mean()) if len(x) else float("nan")
        return mean, mean
    found = bootstrap(
        (x,),
        np.mean,
        n_resamples=2000,
        confidence_level=level,
        method="percentile",
        rng=store.seed("interval", seed_name),
    ).confidence_interval
    return float(found.low), float(found.high)


class Difference(NamedTuple):
    """Mean of paired differences, its bootstrap interval (95 %), and Wilcoxon's signed-rank p value."""

    mean: float
    low: float
    high: float
    p: float


def difference(one: Sequence[float], other: Sequence[float], seed_name: object = 0) -> Difference:
    """How much larger one measure's figures are than another's for the same queries; p is 1 where all are equal."""
    from scipy.stats import wilcoxon

    gap = np.asarray(one, dtype=np.float64) - np.asarray(other, dtype=np.float64)
    p = float(wilcoxon(gap).pvalue) if np.any(gap) else 1.0
    return Difference(float(gap.mean()), *interval(gap, ("difference", seed_name)), p)
