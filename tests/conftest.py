"""What all tests share."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("miburi", derandomize=True, deadline=None, max_examples=40)
settings.load_profile("miburi")

ROOT = Path(__file__).parents[1]


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
            others.append(item)
    items[:] = [*(item for group in first.values() for item in group), *others]
