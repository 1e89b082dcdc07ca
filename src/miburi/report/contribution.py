"""How much each part of the body adds to the distance of a query from a segment."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from miburi.figures import BODY_JOINTS
from miburi.motion import Floats
from miburi.render.figure import LIMBS
from miburi.retrieval import subspace

_PARTS = {"shoulder": "arm", "elbow": "arm", "hand": "arm", "hip": "leg", "knee": "leg", "foot": "leg"}
_SIDES = {"l": "left", "r": "right"}


def _limb(joint: str) -> int:
    side, _, part = joint.partition("_")
    return LIMBS.index(f"{_SIDES[side]} {_PARTS[part]}") if part else 0


COLUMNS = np.array([_limb(joint) for joint in BODY_JOINTS for _ in "xyz"] + [0, 0, 0])
"""The part of the body (an index of `render.figure.LIMBS`) that each of the 42 values belongs to."""


def contributions(
    query: ArrayLike, frames: ArrayLike, mean: ArrayLike, basis: ArrayLike, dims: int = 5
) -> Floats:
    """Share of each part of the body in what the subspaces of query and segment leave of each other's frames.

    Parameters
    ----------
    query : (T, 42)
        Features of the query.
    frames : (K, 42)
        The segment's frames, as the index keeps them.
    mean, basis : (42,), (dims, 42)
        The segment's subspace.
    dims
        Dimensions of the query's subspace.

    Returns
    -------
    (5,) float64
        In the order of `render.figure.LIMBS`; they add up to 1 (all zero where nothing is left): squared residuals
        of [P], eq. 1, averaged over the query's frames against the segment's subspace and over the segment's
        against the query's, the two sides of eq. 2. DSPM itself takes the worst frame; the average is shown
        because the whole motion is seen.
    """
    x, y = np.asarray(query, dtype=np.float64), np.asarray(frames, dtype=np.float64)
    left = _squares(x, np.asarray(mean), np.asarray(basis)) + _squares(y, *subspace.fit(x, dims))
    found = np.bincount(COLUMNS, weights=left, minlength=len(LIMBS))
    total = float(found.sum())
    return found / total if total > 0 else np.zeros(len(LIMBS))


def _squares(x: Floats, mean: Floats, basis: Floats) -> Floats:
    """Squared residual of each column, averaged over frames."""
    centred = x - mean
    return np.asarray(np.square(centred - centred @ basis.T @ basis).mean(axis=0))
