"""Files of strangers, broken in thousands of ways: read, or refused in one line; see `tests/fuzz/__main__.py`.

`pytest --fuzz SECONDS --fuzz-seed N tests/fuzz` goes on for so long, with other cases.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.fuzz.readers import READERS

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def tallies(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[str, Any]]:
    """What came of all cases, by reader."""
    path, seconds = tmp_path_factory.mktemp("fuzz") / "found.json", request.config.getoption("--fuzz")
    words = [sys.executable, "-m", "tests.fuzz", "--json", str(path), "--seed", request.config.getoption("--fuzz-seed")]
    words += [] if seconds is None else ["--seconds", str(seconds)]
    env = os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1", "MUJOCO_GL": "disabled"}
    done = subprocess.run(words, cwd=ROOT, env=env, capture_output=True, text=True, timeout=600 + 4 * (seconds or 0))
    assert path.exists(), done.stderr
    return {one["reader"]: one for one in json.loads(path.read_text())}


@pytest.mark.parametrize("name", READERS)
def test_a_broken_file_is_read_or_refused_in_one_line(name: str, tallies: dict[str, dict[str, Any]]) -> None:
    found = tallies[name]
    assert not found["bugs"], f"\n{found['told']}\n(python -m tests.fuzz with this seed shows one alone)"
    assert found["read"] and found["refused"], "all of one kind: the cases do not reach what they should"
