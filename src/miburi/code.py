"""Digests of the code that a script runs, so that a change re-runs exactly the stages that use it."""

from __future__ import annotations

import ast
import hashlib
import os
from functools import cache
from pathlib import Path

import grimp

_PACKAGE = Path(__file__).parent


@cache
def _graph() -> grimp.ImportGraph:
    cache_dir = os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache")
    return grimp.build_graph(
        "miburi", exclude_type_checking_imports=True, cache_dir=f"{cache_dir}/miburi/imports"
    )


def imported(source: str) -> set[str]:
    """Modules of `miburi` that a script imports, by name, as written."""
    found = set()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module)
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return {name for name in found if name.split(".")[0] == "miburi"}


def modules(script: str | os.PathLike[str]) -> list[str]:
    """Every module of `miburi` that a script needs, directly or not, sorted."""
    graph = _graph()
    needed = set()
    for name in imported(Path(script).read_text(encoding="utf-8")):
        if name in graph.modules:
            needed |= {name} | graph.find_upstream_modules(name)
    # importing a.b.c runs a and a.b as well, and a package's face may import more
    return sorted(needed | {"miburi"})


@cache
def code_digest(script: str | os.PathLike[str]) -> str:
    """SHA-256 over a script and every module of `miburi` that it imports, directly or not."""
    digest = hashlib.sha256(Path(script).read_bytes())
    for name in modules(script):
        digest.update(f"\x1f{name}\x1f".encode())
        digest.update(_source(name).read_bytes())
    return digest.hexdigest()[:16]


def _source(module: str) -> Path:
    path = _PACKAGE.joinpath(*module.split(".")[1:])
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
