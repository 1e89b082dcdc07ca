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
