"""Linear algebra by one thread.

Sums then do not depend on how many threads there are, and small matrices are not handed between threads, which takes
many times longer than the sums where several processes share the cores.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

_Work = TypeVar("_Work", bound=Callable[..., Any])

one_thread: Callable[[_Work], _Work] = threadpool_limits.wrap(limits=1, user_api="blas")
