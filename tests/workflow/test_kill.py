"""A run that is killed, again and again, ends in the same bytes as one that nobody disturbed."""

from __future__ import annotations

import csv
import hashlib
import os
import signal
import time
from pathlib import Path

import h5py
import pytest
from tests.workflow.conftest import Project, digests, fresh, kill

MEASURED = ("table4.csv", "table5.csv", "report.html")  # show measured seconds


def without_seconds(project: Project) -> dict[str, str]:
    """Digests of all files; measured seconds are taken out of those that hold them."""
    found = digests(project.path)
    for name in list(found):
        path = project.path / name
        if path.name in MEASURED:
            del found[name]
        elif "/ranks/" in name:
            found[name] = content(path)
        elif "/scores/" in name:
            with open(path, encoding="utf-8", newline="") as file:
                rows = [{k: v for k, v in row.items() if k != "seconds"} for row in csv.DictReader(file)]
            found[name] = str(rows)
    return found


def content(path: Path) -> str:
    digest = hashlib.sha256()
    with h5py.File(path) as file:
        for name in ("query", "order", "score"):
            digest.update(
                file[name][()].tobytes() if name != "query" else str(list(file[name].asstr())).encode()
            )
    return digest.hexdigest()


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A project whose run was killed four times, at its beginning, in the middle of jobs and late."""
    project = fresh(tmp_path_factory.mktemp("killed") / "miburi")
    for number, seconds in enumerate((5.0, 13.0, 21.0, 29.0)):
        process = project.start()
        time.sleep(seconds)
        if number == 2:  # Ctrl-C, then what a scheduler does when nobody listens
            os.killpg(process.pid, signal.SIGINT)
            time.sleep(3)
        kill(process)
        locks = project.path / ".snakemake" / "locks"
        if number != 2 and any(locks.iterdir()):
            run = project.snakemake("-n")
            assert run.status != 0
            assert "--unlock" in run.terminal
            assert project.snakemake("--unlock").status == 0
        assert not (project.path / "results" / "report.html").exists(), "killed before the end"
    return project


def test_it_goes_on_to_the_same_bytes(finished: Project, killed: Project) -> None:
    if any((killed.path / ".snakemake" / "locks").iterdir()):
        assert killed.snakemake("--unlock").status == 0
    run = killed.snakemake("all")
    assert run.status == 0, run.terminal[-3000:]
    undisturbed, disturbed = without_seconds(finished), without_seconds(killed)
    assert set(undisturbed) == set(disturbed)
    assert [name for name in undisturbed if undisturbed[name] != disturbed[name]] == []
