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


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests that follow one another in one process, longest first; single tests run beside them meanwhile."""
    place = {"workflow": 0, "report": 2, "test_kill": 3, "test_slurm": 4}
    order = {}
    for item in items:
        stem, folder = item.path.stem, item.path.parent.name
        name = stem if stem in DEAR or stem in place else folder if folder in place else None
        if name is not None:
            item.add_marker(pytest.mark.xdist_group(name))
        order[item] = place.get(name or "", 1)
    items.sort(key=order.__getitem__)
