"""How much each value moves: the histogram Jvh of [P], eqs. (3) and (4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from miburi.compiled import njit
from miburi.motion import Floats


def jvh(x: ArrayLike) -> Floats:
    """How far each value travels, as shares of the whole.

    Parameters
    ----------
    x : (T, D)
        Features of a segment.

    Returns
    -------
    (D,) float64
        Σ_n |x^k_{n+1} − x^k_n| for each k ([P], eq. 3), divided by their sum; zeros where nothing moves.
    """
    travelled = np.abs(np.diff(np.asarray(x, dtype=np.float64), axis=0)).sum(axis=0)
    total = travelled.sum()
    return travelled / total if total > 0 else np.zeros_like(travelled)


def bhattacharyya(roots: ArrayLike, q: ArrayLike) -> Floats:
    """How alike histograms are.

    Parameters
    ----------
    roots : (S, D)
        Square roots of histograms, each histogram of sum 1 (or all zeros: nothing moves).
    q : (D,)
        A histogram.

    Returns
    -------
    (S,) float64
        Σ_i √(p_i q_i), 0 to 1 ([P], eq. 4, whose print leaves q_i outside the root). Two that do not move at
        all are alike: 1.
    """
    similar: Floats = overlap(np.asarray(roots, dtype=np.float64), np.sqrt(np.asarray(q, dtype=np.float64)))
    return similar


@njit
def overlap(roots, root):  # type: ignore[no-untyped-def]
    """`bhattacharyya` of square roots: roots (S, D), root (D,); returns (S,)."""
    out = np.empty(len(roots))
    still = not root.any()
    for i in range(len(roots)):
        out[i] = overlap_with(roots, i, root)
        if still:
            out[i] = 0.0 if roots[i].any() else 1.0
    return out


@njit
def overlap_with(roots, i, root):  # type: ignore[no-untyped-def]
    """`overlap` of segment i with a histogram that is not all zeros."""
    added = 0.0
    for d in range(len(root)):
        added += roots[i, d] * root[d]
    return min(added, 1.0)
