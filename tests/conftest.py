"""Shared fixtures: where outside data stands, when it does."""

import os
from pathlib import Path

import pytest

os.environ.setdefault("MUJOCO_GL", "disabled")

CMU = Path(__file__).resolve().parents[2] / "shared" / "data" / "cmu"


@pytest.fixture
def cmu() -> Path:
    """Folder of real CMU motion capture files beside the project; tests that need it skip without it."""
    if not CMU.is_dir():
        pytest.skip("CMU motion capture files are not beside the project")
    return CMU
