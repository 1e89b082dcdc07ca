"""A copy of the project in which the workflow is run as a user runs it."""

from __future__ import annotations

import contextlib
import csv
import fcntl
import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import h5py
import pytest

ROOT = Path(__file__).parents[2]
PARTS = ("Snakefile", "workflow", "profiles", "config", "src")


@dataclass(frozen=True)
class Run:
    """How a call of snakemake ended: exit status and what the terminal showed."""

    status: int
    terminal: str

    @property
    def last(self) -> str:
        """The last line on the terminal."""
        lines = [line for line in self.terminal.splitlines() if line.strip()]
        return lines[-1] if lines else ""

    def planned(self) -> dict[str, int]:
        """Rules and numbers of jobs of a dry run."""
        found: dict[str, int] = {}
        for line in self.terminal.split("Job stats:")[-1].splitlines():
            if match := re.fullmatch(r"(\w+)\s+(\d+)", line.strip()):
                found[match.group(1)] = int(match.group(2))
            elif found and not line.strip():
                break
        found.pop("total", None)
        return found


@dataclass(frozen=True)
class Project:
    """A copy of the project."""

    path: Path

    def command(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "snakemake", "--cores", "2", *arguments]

    def environment(self) -> dict[str, str]:
        return {**os.environ, "PYTHONPATH": str(self.path / "src"), "COLUMNS": "200"}

    def snakemake(self, *arguments: str, timeout: float = 3000) -> Run:
        """Run snakemake on the small config, with more arguments."""
        if not any(a.startswith("--configfile") for a in arguments):
            arguments = (
                ("--configfile", "config/test.yaml", "--", *arguments)
                if arguments and not arguments[0].startswith("-")
                else ("--configfile=config/test.yaml", *arguments)
            )
        done = subprocess.run(
            self.command(*arguments),
            cwd=self.path,
            env=self.environment(),
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=timeout,
            check=False,
        )
        return Run(done.returncode, done.stdout)

    def start(self, *arguments: str) -> subprocess.Popen[str]:
        """Start snakemake in a process group of its own, to be killed."""
        return subprocess.Popen(
            self.command("--configfile=config/test.yaml", *arguments),
            cwd=self.path,
            env=self.environment(),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )

    def copy(self, to: Path) -> Project:
        """Another copy, with all results and what snakemake remembers of them."""
        shutil.copytree(self.path, to, symlinks=True)
        return Project(to)

    def edit(self, name: str, old: str, new: str) -> None:
        """Change a text file; what is to be replaced must be there."""
        path = self.path / name
        text = path.read_text(encoding="utf-8")
        assert old in text, f"{name} does not hold {old!r}"
        path.write_text(text.replace(old, new, 1), encoding="utf-8")


def fresh(to: Path) -> Project:
    """A copy of the project without results."""
    for part in PARTS:
        source = ROOT / part
        if source.is_dir():
            shutil.copytree(source, to / part, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
        else:
            to.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, to / part)
    return Project(to)


def kill_group(process: subprocess.Popen[str]) -> None:
    """Kill a process and all its children at once."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


def digests(folder: Path) -> dict[str, str]:
    """SHA-256 of each file below results/ and data/raw/; logs and measured times are left out."""
    found = {}
    for path in sorted([*(folder / "results").rglob("*"), *(folder / "data" / "raw").rglob("*")]):
        name = str(path.relative_to(folder))
        if path.is_file() and not name.startswith(("results/logs/", "results/benchmarks/")):
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
    return found


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


@pytest.fixture(scope="session")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Project:
    """A project whose workflow has run to its end once. Not to be changed: tests that change it take a copy.

    All test processes share it: the first makes it, the others wait.
    """
    base = tmp_path_factory.getbasetemp()
    shared = base.parent if "PYTEST_XDIST_WORKER" in os.environ else base
    project, done = Project(shared / "finished"), shared / "finished.status"
    with open(shared / "finished.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not done.exists():
            shutil.rmtree(project.path, ignore_errors=True)  # of a test process that was stopped
            fresh(project.path)
            run = project.snakemake("all", "check")
            done.write_text(str(run.status) + "\n" + run.terminal[-4000:])
    status, _, terminal = done.read_text().partition("\n")
    assert status == "0", terminal
    return project


@pytest.fixture
def copy(finished: Project, tmp_path: Path) -> Project:
    """A copy of the finished project, to be changed."""
    return finished.copy(tmp_path / "miburi")
