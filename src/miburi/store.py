"""HDF5 artefacts: written whole or not at all, checked when read, the same bytes for the same content."""

from __future__ import annotations

import hashlib
import json
import os
import socket
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import ArrayLike, NDArray

from miburi.errors import InputError

VERSION = 1


def digest(path: str | os.PathLike[str]) -> str:
    """SHA-256 of a file, in hexadecimal."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def sources(*paths: str | os.PathLike[str]) -> dict[str, str]:
    """What an artefact was made from: the name of each input (as the rule gives it) and its SHA-256."""
    return {str(p): digest(p) for p in paths}


def seed(*parts: object) -> np.random.Generator:
    """A random generator that depends on its name only: config seed, corpus, take …"""
    words = hashlib.sha256("\x1f".join(str(p) for p in parts).encode()).digest()
    return np.random.default_rng(np.frombuffer(words, dtype=np.uint32))


@contextmanager
def replaced(path: str | os.PathLike[str]) -> Iterator[Path]:
    """A temporary name beside `path` to write to; becomes `path` at the end, or nothing if something fails.

    The file is synced before it is renamed, so that a crash leaves the old file or the new one. What killed
    processes left half-written of the same file is removed.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    begun = f".{target.stem}.tmp-"
    for other in target.parent.iterdir():
        if other.name.startswith(begun) and other.suffix == target.suffix and _abandoned(other):
            other.unlink(missing_ok=True)
    # the suffix stays, because writers of films and pictures choose their format by it
    temporary = target.with_name(f"{begun}{socket.gethostname()}-{os.getpid()}{target.suffix}")
    try:
        yield temporary
        with open(temporary, "rb") as file:
            os.fsync(file.fileno())
        os.replace(temporary, target)
        folder = os.open(target.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
    finally:
        temporary.unlink(missing_ok=True)


def _abandoned(temporary: Path) -> bool:
    """Whether a temporary file, …HOST-PID.SUFFIX, has no writer any more; another host's is given a day."""
    host, _, pid = temporary.stem.partition(".tmp-")[2].rpartition("-")
    try:
        if host != socket.gethostname() or not pid.isdigit():
            return time.time() - temporary.stat().st_mtime > 86400
        os.kill(int(pid), 0)
    except ProcessLookupError:
        return True
    except OSError:
        return False  # it is gone, or somebody else's
    return False


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text file whole or not at all (UTF-8, newlines as they are)."""
    with replaced(path) as temporary:
        temporary.write_bytes(text.encode())


@contextmanager
def create(
    path: str | os.PathLike[str], kind: str, made_from: Mapping[str, str] | None = None
) -> Iterator[h5py.File]:
    """An artefact to fill, of the format "miburi/<kind>"; it appears under its name when it is complete."""
    with replaced(path) as temporary, h5py.File(temporary, "w", track_order=False) as file:
        file.attrs["format"] = f"miburi/{kind}"
        file.attrs["version"] = VERSION
        file.attrs["sources"] = json.dumps(dict(made_from or {}), sort_keys=True)
        yield file
        file.flush()


@contextmanager
def open_checked(path: str | os.PathLike[str], kind: str) -> Iterator[h5py.File]:
    """An artefact to read.

    Raises
    ------
    InputError
        The file is missing or damaged, or holds another format or version.
    """
    where = Path(path)
    if not where.exists():
        raise InputError(f"{where}: there is no such file")
    try:
        with h5py.File(where, "r", locking=False) as file:
            found, version = file.attrs.get("format"), file.attrs.get("version")
            if found != f"miburi/{kind}":
                raise InputError(f"{where}: its format is {found!r}, expected 'miburi/{kind}'")
            if version != VERSION:
                raise InputError(f"{where}: its version is {version}, this miburi reads version {VERSION}")
            yield file
    except OSError as error:
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise InputError(
            f"{where}: not a readable HDF5 file ({reason}); remove it and run snakemake again to make it anew"
        ) from error


def put(group: h5py.Group, name: str, values: ArrayLike | Sequence[str], *, compress: bool = True) -> None:
    """Add a dataset: numbers with a checksum (gzip and shuffle where it pays), or a list of strings."""
    array = np.asarray(values)
    if array.dtype.kind in "UO":
        group.create_dataset(name, data=array.astype(object), dtype=h5py.string_dtype(), track_times=False)
        return
    if not compress or array.size < 64 or array.ndim == 0:
        group.create_dataset(name, data=array, track_times=False)
        return
    rows = max(1, min(len(array), (1 << 18) // max(1, array[0].nbytes)))
    group.create_dataset(
        name,
        data=array,
        chunks=(rows, *array.shape[1:]),
        compression="gzip",
        compression_opts=1,
        shuffle=True,
        fletcher32=True,
        track_times=False,
    )


def get(group: h5py.Group, name: str, shape: tuple[int | None, ...] | None = None) -> NDArray[Any]:
    """Read a dataset of numbers.

    Raises
    ------
    InputError
        It is not there, or its shape is not the one expected (None: any length).
    """
    where = f"{group.file.filename}: {group.name.rstrip('/')}/{name}"
    if name not in group or not isinstance(group[name], h5py.Dataset):
        raise InputError(f"{where} is missing")
    found = group[name].shape
    if shape is not None and (
        len(found) != len(shape) or any(w is not None and f != w for f, w in zip(found, shape, strict=True))
    ):
        wanted = " × ".join("any" if w is None else str(w) for w in shape)
        raise InputError(f"{where} has shape {found}, expected {wanted}")
    values: NDArray[Any] = group[name][()]
    return values


def get_strings(group: h5py.Group, name: str) -> list[str]:
    """Read a dataset of strings; InputError if it is not there."""
    if name not in group:
        raise InputError(f"{group.file.filename}: {group.name.rstrip('/')}/{name} is missing")
    return [str(s) for s in group[name].asstr()[()]]
