"""Compiled functions, kept on disk under what the sources say rather than where they lie."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, overload

import numba
from numba.core import caching

_PACKAGE = Path(__file__).parent
_CONFIG: Any = numba.config

Function = Callable[..., Any]

SUMS = {"reassoc", "contract", "nsz"}
"""For `fastmath`: sums may be taken in another order (vectors), but infinities and signs stay what they are."""


@overload
def njit(function: Function, /) -> Function: ...
@overload
def njit(**options: Any) -> Callable[[Function], Function]: ...
def njit(function: Any = None, /, **options: Any) -> Any:
    """numba's `njit` with the cache of this module; options as there."""
    return numba.njit(function, cache=True, **options)


@cache
def sources() -> str:
    """SHA-256 of all sources of the package, in hex."""
    digest = hashlib.sha256()
    for path in sorted(_PACKAGE.rglob("*.py")):
        digest.update(path.relative_to(_PACKAGE).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()


class Locator(caching.UserProvidedCacheLocator):  # type: ignore[misc, unused-ignore]
    """Where numba keeps compiled functions of this package.

    numba keeps a compiled function although a function that it calls in another module has changed, and compiles
    anew in each copy of a project. A folder that is named after the digest of all sources mends both. It is in
    NUMBA_CACHE_DIR where that is set, else in XDG_CACHE_HOME or ~/.cache; where that cannot be written, numba looks
    for a place as usual.
    """

    def __init__(self, py_func: Any, py_file: str) -> None:
        super().__init__(py_func, py_file)  # type: ignore[no-untyped-call, unused-ignore]
        home = _CONFIG.CACHE_DIR or os.path.join(
            os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache", "miburi"
        )
        room = Path(py_file).parent.relative_to(_PACKAGE)
        self._cache_path = os.path.join(home, f"kernels-{sources()[:16]}", room)

    @classmethod
    def from_function(cls, py_func: Any, py_file: str) -> Locator | None:
        """A locator for a function of this package, None for others."""
        if _PACKAGE not in Path(py_file).parents:
            return None
        above: Any = super(caching.UserProvidedCacheLocator, cls)
        found: Locator | None = above.from_function(py_func, py_file)
        return found


_OTHERS = ("UserProvided", "InTree", "UserWide", "IPython", "Zip")
_CONFIG.CACHE_LOCATOR_CLASSES = ",".join([f"{__name__}.Locator", *(f"{n}CacheLocator" for n in _OTHERS)])
