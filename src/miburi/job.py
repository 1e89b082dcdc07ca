"""What every script of the workflow shares: its log, its errors, its threads."""

from __future__ import annotations

import logging
import os
import sys
import time
import traceback
from collections.abc import Callable, Collection, Iterator, Sequence
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console
from rich.filesize import decimal
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeRemainingColumn,
)

from miburi.errors import InputError

Item = TypeVar("Item")
_MOST = 20

MARK = "error: "
"""What the sentence of a failed job begins with in its log."""


def run(main: Callable[[Any], None], snakemake: Any) -> None:
    """Run a script's `main`.

    The rule's log says what the job reads, what it did and how long that took, and what it wrote. An InputError is
    one sentence in the log and on stderr, and exit status 1; so is a full disk. Anything else is a defect: its
    traceback goes to the log, one sentence to stderr.
    """
    log = Path(snakemake.log[0]) if snakemake.log else Path(os.devnull)
    log.parent.mkdir(parents=True, exist_ok=True)
    handler = logging.FileHandler(log, mode="w", encoding="utf-8")
    logging.basicConfig(
        level=logging.INFO, format="%(levelname)s: %(message)s", handlers=[handler], force=True
    )
    logging.captureWarnings(True)
    started = time.monotonic()
    _list("reads", snakemake.input)
    try:
        main(snakemake)
        _list("wrote", snakemake.output)
        logging.info("%s took %.1f s", snakemake.rule, time.monotonic() - started)
    except InputError as error:
        _fail(handler, str(error))
    except OSError as error:
        name = f"{error.filename}: " if error.filename else ""
        _fail(handler, f"{name}{error.strerror or error}")
    except Exception as error:
        logging.error("%s", traceback.format_exc())
        _fail(
            handler,
            f"{type(error).__name__} in {snakemake.rule}: {error} (a defect; the traceback is in {log})",
        )


def _list(verb: str, paths: Sequence[str]) -> None:
    """Files of a job and their sizes in its log; of very many the first alone."""
    for path in paths[:_MOST]:
        where = Path(path)
        size = f" ({decimal(where.stat().st_size)})" if where.is_file() else ""
        logging.info("%s %s%s", verb, path, size)
    if len(paths) > _MOST:
        logging.info("%s %d more", verb, len(paths) - _MOST)


def progress(items: Collection[Item], what: str) -> Iterator[Item]:
    """Go through the parts of a long job: a bar with rate and time left on a terminal, lines in its log.

    Parameters
    ----------
    items
        What is worked on, one after the other.
    what
        What they are, in words: "takes".
    """
    total, said = len(items), 0
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(show_speed=True),
        MofNCompleteColumn(),
    )
    console = Console(stderr=True)
    with Progress(
        *columns, TimeRemainingColumn(), console=console, transient=True, disable=not console.is_terminal
    ) as bar:
        for done, item in enumerate(bar.track(items, description=what), 1):
            yield item
            if 10 * done // total > said or done == total:
                said = 10 * done // total
                logging.info("%d of %d %s", done, total, what)


def _fail(handler: logging.FileHandler, sentence: str) -> None:
    sentence = " ".join(sentence.split())
    handler.close()
    with open(handler.baseFilename, "a", encoding="utf-8") as log:
        log.write(f"{MARK}{sentence}\n")
    print(sentence, file=sys.stderr)
    sys.stderr.flush()
    # not sys.exit: Snakemake would add a traceback of its own
    os._exit(1)


def lines(path: str | os.PathLike[str]) -> list[str]:
    """Lines of a log; none if it cannot be read."""
    try:
        return Path(path).read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        return []


def sentence(log: str | os.PathLike[str]) -> str | None:
    """The sentence that a failed job left as the last line of its log."""
    last = lines(log)[-1:]
    return last[0].removeprefix(MARK) if last and last[0].startswith(MARK) else None
