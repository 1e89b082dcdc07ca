"""Search by motion ([P]): cut takes into segments, describe frames by 42 values, rank segments for a query."""

from miburi.retrieval.body import features, names, reset_yaw
from miburi.retrieval.index import Index, Ranking, measures, merge
from miburi.retrieval.segmentation import pieces, ppca_curve, segment

__all__ = [
    "Index",
    "Ranking",
    "features",
    "measures",
    "merge",
    "names",
    "pieces",
    "ppca_curve",
    "reset_yaw",
    "segment",
]
