"""Search by motion ([P]): takes are cut into segments, frames become 42 values, segments are ranked."""

from miburi.retrieval.body import features, names, reset_angles
from miburi.retrieval.index import Index, measures
from miburi.retrieval.ranking import Ranking, merge
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
    "reset_angles",
    "segment",
]
