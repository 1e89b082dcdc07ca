"""A run that is killed, again and again, ends in the same bytes as one that nobody disturbed."""

from __future__ import annotations

import os
import signal
import time

import pytest
from tests.workflow.conftest import Project, fresh, kill_group, without_seconds


def locked(project: Project) -> bool:
    """Whether a lock is left."""
    return any((project.path / ".snakemake" / "locks").glob("*"))


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
        kill_group(process)
        if number != 2 and locked(project):
            if number == 0:
                run = project.snakemake("all")
                assert run.status != 0
                assert "--unlock" in run.terminal
            assert project.snakemake("--unlock").status == 0
        assert not (project.path / "results" / "report.html").exists(), "killed before the end"
    return project


def test_it_goes_on_to_the_same_bytes(killed: Project, finished: Project) -> None:
    if locked(killed):
        assert killed.snakemake("--unlock").status == 0
    run = killed.snakemake("all")
    assert run.status == 0, run.terminal[-3000:]
    undisturbed, disturbed = without_seconds(finished), without_seconds(killed)
    assert set(undisturbed) == set(disturbed)
    assert [name for name in undisturbed if undisturbed[name] != disturbed[name]] == []
