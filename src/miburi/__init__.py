"""Motion recordings in, gesture synthesis and motion search out.

The names below are the library's face; they are imported when they are first used, so that `import miburi` is quick.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from miburi.errors import InputError
    from miburi.formats import read, write
    from miburi.hmm import deltas, durations, mlpg, synthesize, train
    from miburi.motion import Motion, Skeleton
    from miburi.retrieval import Index, features, measures, segment

__version__ = "0.1.0"

_HOMES = {
    "InputError": "errors",
    "Motion": "motion",
    "Skeleton": "motion",
    "read": "formats",
    "write": "formats",
    "segment": "retrieval",
    "features": "retrieval",
    "Index": "retrieval",
    "measures": "retrieval",
    "deltas": "hmm",
    "train": "hmm",
    "durations": "hmm",
    "mlpg": "hmm",
    "synthesize": "hmm",
}

__all__ = [
    "Index",
    "InputError",
    "Motion",
    "Skeleton",
    "deltas",
    "durations",
    "features",
    "measures",
    "mlpg",
    "read",
    "segment",
    "synthesize",
    "train",
    "write",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'miburi' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"miburi.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
