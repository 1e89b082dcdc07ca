"""What every script of the workflow shares: its log, its errors, its threads."""

from __future__ import annotations

import logging
import os
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

from miburi.errors import InputError

MARK = "error: "
"""What the sentence of a failed job begins with in its log."""


def run(main: Callable[[Any], None], snakemake: Any) -> None:
    """Run a script's `main`.

    Messages go to the rule's log and to stderr. An InputError is one sentence in both, and exit status 1; so is a
    full disk. Anything else is a defect: its traceback goes to the log, one sentence to stderr.
    """
    log = Path(snakemake.log[0]) if snakemake.log else Path(os.devnull)
    log.parent.mkdir(parents=True, exist_ok=True)
    handler = logging.FileHandler(log, mode="w", encoding="utf-8")
    logging.basicConfig(
        level=logging.INFO, format="%(levelname)s: %(message)s", handlers=[handler], force=True
    )
    logging.captureWarnings(True)
    try:
        main(snakemake)
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
