"""What all tests share."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("miburi", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("miburi")

ROOT = Path(__file__).parents[1]
DEAR = ("test_bodies", "test_puppeteers", "test_index")
"""Modules whose fixtures cost more than their tests: one process makes them."""


@pytest.fixture(scope="session")
def recordings() -> Path:
    """The folder of real recordings; tests that need it are skipped where there is none."""
    folder = Path(os.environ.get("MIBURI_RECORDINGS", ROOT / "../shared/data")).resolve()
    if not (folder / "README.md").exists():
        pytest.skip(f"no real recordings in {folder} (set MIBURI_RECORDINGS)")
    return folder


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Runs of the workflow come first, those that wait for each other in one process; single tests fill the rest."""
    first: dict[str, list[pytest.Item]] = {"workflow": [], "test_kill": [], "test_slurm": []}
    others = []
    for item in items:
        if item.path.parent.name in ("workflow", "report"):
            name = item.path.stem if item.path.stem in first else "workflow"
            item.add_marker(pytest.mark.xdist_group(name))
            first[name].append(item)
        else:
            if item.path.stem in DEAR:
                item.add_marker(pytest.mark.xdist_group(item.path.stem))
            others.append(item)
    items[:] = [*(item for group in first.values() for item in group), *others]
