"""Dynamic time warping of feature sequences."""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def dtw(frames, blocks, offsets):  # type: ignore[no-untyped-def]
    """Warped distance of each segment from a query.

    The root of the smallest sum of squared Euclidean distances along a path from the first pair of frames to
    the last, in steps of one frame on either side or both (dtaidistance's `dtw_ndim.distance`).

    frames (n, D) of the query; blocks and offsets as in `subspace.samples_to_subspace`; returns (S,).
    """
    n, width = frames.shape
    s = len(offsets) - 1
    longest = 0
    for i in range(s):
        longest = max(longest, offsets[i + 1] - offsets[i])
    cost, path, out = np.empty(longest), np.empty(longest), np.empty(s)
    for i in range(s):
        size = offsets[i + 1] - offsets[i]
        block = blocks[width * offsets[i] : width * offsets[i + 1]].reshape(width, size)
        for t in range(n):
            for j in range(size):
                cost[j] = 0.0
            for d in range(width):
                row, x = block[d], frames[t, d]
                for j in range(size):
                    gap = row[j] - x
                    cost[j] += gap * gap
            # path[j] is the best sum that ends at (t, j); `corner` the one at (t − 1, j − 1)
            corner = path[0]
            path[0] = cost[0] if t == 0 else path[0] + cost[0]
            for j in range(1, size):
                if t == 0:
                    path[j] = path[j - 1] + cost[j]
                else:
                    above = path[j]
                    path[j] = cost[j] + min(above, corner, path[j - 1])
                    corner = above
        out[i] = np.sqrt(path[size - 1])
    return out
