"""Recordings of the CMU Graphics Lab Motion Capture Database, fetched from its site.

A download that broke is resumed where it stopped, and a file counts only when it can be parsed.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable, Iterable
from pathlib import Path

import requests
from requests.adapters import HTTPAdapter
from rich.progress import BarColumn, DownloadColumn, Progress, TaskID, TextColumn, TimeRemainingColumn
from urllib3.util.retry import Retry

from miburi.errors import InputError
from miburi.formats import asf_amc

log = logging.getLogger(__name__)

_TRIES = 4
RETRIES = 5
BACKOFF_S = 1.0
_TIMEOUT_S = 30.0
_CHUNK = 1 << 13
_KEPT = "arriving"  # folder of files that have arrived, until all of a subject have


def session() -> requests.Session:
    """A session that tries again, with growing pauses, when a server is busy or a connection breaks."""
    retries = Retry(
        total=RETRIES,
        backoff_factor=BACKOFF_S,
        status_forcelist=(429, 500, 502, 503, 504),
        allowed_methods=("GET",),
    )
    web = requests.Session()
    for scheme in ("http://", "https://"):
        web.mount(scheme, HTTPAdapter(max_retries=retries))
    return web


def subject(site: str, name: str, files: Iterable[str | os.PathLike[str]], *, progress: bool = True) -> None:
    """Fetch a subject's skeleton and takes to the given paths; all appear when all are there and whole.

    Parameters
    ----------
    site
        Where the database lies, as "http://mocap.cs.cmu.edu"; files are at {site}/subjects/{name}/{file}.
    files
        Paths to write; the file's name is the name on the site. The skeleton (.asf) comes first.

    Raises
    ------
    InputError
        The site cannot be reached, has no such file, or sends a damaged one.
    """
    paths = sorted((Path(f) for f in files), key=lambda p: (p.suffix != ".asf", p.name))
    skeleton: asf_amc.Acclaim | None = None
    columns = (TextColumn("{task.description}"), BarColumn(), DownloadColumn(), TimeRemainingColumn())
    whole: list[tuple[Path, Path]] = []
    with session() as web, Progress(*columns, disable=not progress, transient=True) as bar:
        for path in paths:
            task = bar.add_task(path.name, total=None)

            def advance(done: int, total: int | None, task: TaskID = task) -> None:
                bar.update(task, completed=done, total=total)

            kept = path.parent / _KEPT / path.name
            url = f"{site.rstrip('/')}/subjects/{name}/{path.name}"
            skeleton = _checked(web, url, kept, skeleton, advance) or skeleton
            log.info("%s: %d bytes from %s", path, kept.stat().st_size, url)
            whole.append((kept, path))
    for kept, path in whole:
        os.replace(kept, path)


def _checked(
    web: requests.Session,
    url: str,
    path: Path,
    skeleton: asf_amc.Acclaim | None,
    advance: Callable[[int, int | None], None],
) -> asf_amc.Acclaim | None:
    """Fetch a file until it can be parsed; what an earlier run left is kept, or continued where it broke off."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.exists():
        return _parse(path, skeleton)
    part = path.with_name(f"{path.name}.part")
    for attempt in range(1, _TRIES + 1):
        try:
            _fetch(web, url, part, advance)
        except requests.RequestException as error:
            log.info("%s: try %d: %s", url, attempt, error)
            reason = f"{url}: cannot be fetched ({type(error).__name__})"
            continue
        part.rename(path)
        try:
            return _parse(path, skeleton)
        except InputError as error:
            path.unlink()
            reason = f"{url}: what was sent is damaged: {error}"
    raise InputError(f"{reason}; what has arrived is kept, run snakemake again to go on")


def _parse(path: Path, skeleton: asf_amc.Acclaim | None) -> asf_amc.Acclaim | None:
    if path.suffix == ".asf":
        return asf_amc.read_asf(path)
    asf_amc.read(path, skeleton=skeleton)
    return None


def _fetch(web: requests.Session, url: str, part: Path, advance: Callable[[int, int | None], None]) -> None:
    """Fetch to `part`, from where it ends, until it is complete."""
    have = part.stat().st_size if part.exists() else 0
    headers = (
        {"Range": f"bytes={have}-", "Accept-Encoding": "identity"}
        if have
        else {"Accept-Encoding": "identity"}
    )
    with web.get(url, headers=headers, stream=True, timeout=_TIMEOUT_S) as answer:
        if answer.status_code == requests.codes.not_found:
            raise InputError(f"{url}: the site has no such file")
        if answer.status_code == requests.codes.requested_range_not_satisfiable:
            return  # nothing is left to send; parsing decides
        answer.raise_for_status()
        resumed = answer.status_code == requests.codes.partial_content
        done = have if resumed else 0
        length = answer.headers.get("Content-Length")
        total = done + int(length) if length else None
        with open(part, "ab" if resumed else "wb") as file:
            for chunk in answer.iter_content(_CHUNK):
                file.write(chunk)
                done += len(chunk)
                advance(done, total)
        if total is not None and done < total:
            raise requests.ConnectionError(f"{done} of {total} bytes arrived")
        with open(part, "rb") as file:
            os.fsync(file.fileno())
