"""What a job says: in its log always, on a terminal as a bar."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
from pathlib import Path

SCRIPT = """
import logging, time
from types import SimpleNamespace
from miburi import job

def main(snakemake):
    for item in job.progress(list(range(40)), "takes"):
        time.sleep(0.03)
    if snakemake.params.wrong:
        {"a": 1}["b"]
    open(snakemake.output[0], "w").write("x" * 2000)

job.run(main, SimpleNamespace(
    log=["job.log"], input=["given.txt"], output=["made.txt"], rule="stage", params=SimpleNamespace(wrong=WRONG)))
"""


def run(folder: Path, wrong: bool = False, **options: object) -> subprocess.CompletedProcess[str]:
    (folder / "given.txt").write_text("12345")
    script = SCRIPT.replace("WRONG", str(wrong))
    return subprocess.run([sys.executable, "-c", script], cwd=folder, text=True, check=False, **options)


def test_the_log_says_what_was_read_done_and_written(tmp_path: Path) -> None:
    done = run(tmp_path, stderr=subprocess.PIPE)
    assert done.returncode == 0
    assert done.stderr == "", "nothing but errors where nobody watches"
    lines = (tmp_path / "job.log").read_text().splitlines()
    assert lines[0] == "INFO: reads given.txt (5 bytes)"
    assert lines[1:11] == [f"INFO: {4 * k} of 40 takes" for k in range(1, 11)]
    assert lines[11] == "INFO: wrote made.txt (2.0 kB)"
    assert lines[12].startswith("INFO: stage took ")


def test_a_defect_leaves_its_traceback_in_the_log(tmp_path: Path) -> None:
    done = run(tmp_path, wrong=True, stderr=subprocess.PIPE)
    assert done.returncode == 1
    assert "KeyError in stage" in done.stderr
    log = (tmp_path / "job.log").read_text()
    assert "Traceback (most recent call last)" in log
    assert log.splitlines()[-1].startswith("error: KeyError")


def test_a_terminal_shows_a_bar_with_the_time_left(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    run(tmp_path, stderr=theirs, env={**os.environ, "TERM": "xterm-256color", "COLUMNS": "100"})
    os.close(theirs)
    shown = b""
    try:
        while part := os.read(ours, 65536):
            shown += part
    except OSError:  # the end, on Linux
        pass
    os.close(ours)
    assert b"takes" in shown
    assert b"/40" in shown
    assert b"0:00:0" in shown
