"""How sure a mean is, what chance would give, whether two measures differ."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.stats import bootstrap, hypergeom, wilcoxon

from miburi import store


def chance_of_hit(segments: int, relevant: int, first: int) -> float:
    """Probability that at least one of `relevant` is among the first of `segments` in random order."""
    if relevant <= 0 or first <= 0:
        return 0.0
    return float(1.0 - hypergeom.pmf(0, segments, relevant, min(first, segments)))


def chance_rank(segments: int) -> float:
    """Expected rank of one segment in random order."""
    return (segments + 1) / 2


def interval(values: ArrayLike, seed_name: object = 0, level: float = 0.95) -> tuple[float, float]:
    """Bootstrap interval of a mean (percentiles, 2000 draws); of fewer than two values, or equal ones, the mean."""
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


def difference(one: Sequence[float], other: Sequence[float]) -> float:
    """Wilcoxon's signed-rank p value of paired values; 1 where they are all equal."""
    gap = np.asarray(one, dtype=np.float64) - np.asarray(other, dtype=np.float64)
    return 1.0 if not np.any(gap) else float(wilcoxon(gap).pvalue)
