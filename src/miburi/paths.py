"""Names of files."""

from __future__ import annotations

import os
from pathlib import Path

File = str | os.PathLike[str]


def stem(path: File) -> str:
    """A file's name without its ending (and without .gz)."""
    name = Path(path).name
    if name.lower().endswith(".gz"):
        name = name[:-3]
    return name.rsplit(".", 1)[0] if "." in name[1:] else name


def suffix(path: File) -> str:
    """A file's ending in lower case, .gz left out."""
    name = Path(path).name.lower().removesuffix(".gz")
    return "." + name.rsplit(".", 1)[1] if "." in name[1:] else ""
