"""The notebook runs from top to bottom, in haste, with no display; where what it needs is not installed, not at all."""

import re
from pathlib import Path

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

ROOT = Path(__file__).resolve().parents[1]
NOTEBOOK = ROOT / "notebook" / "imitate.ipynb"
HASTE = "import tests.conftest\n\ntests.conftest.hurry(setattr)"


def test_it_runs_from_top_to_bottom_and_shows_the_recording() -> None:
    if not NOTEBOOK.exists():
        pytest.skip("the notebook stays with the repository")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code)  # committed as it was written
    code[0].source, changed = re.subn(
        r"babbling_minutes=\d+", 'babbling_minutes=0.6, correspondence="ik"', code[0].source
    )
    assert changed == 1
    notebook.cells.insert(0, nbformat.v4.new_code_cell(HASTE))
    nbclient.NotebookClient(
        notebook, timeout=120, kernel_name="python3", resources={"metadata": {"path": ROOT}}
    ).execute()
    shown = [output for cell in code for output in cell.outputs]
    assert not [output for output in shown if output.output_type == "error"]
    kinds = [set(output.data) for output in shown if "data" in output]
    assert sum("image/png" in kind for kind in kinds) >= 2
    said = "".join(output.text for output in shown if output.output_type == "stream" and output.name == "stdout")
    error, replay = (
        float(re.search(rf"{name} +([0-9.]+)", said)[1]) for name in ("joint_rmse_deg", "direct_replay_rmse_deg")
    )
    assert error < 0.3 * replay and "ticks left" in said
    viewer = next(output.data for output in code[-2].outputs if output.output_type == "execute_result")
    assert "application/vnd.jupyter.widget-view+json" in viewer or "[notebook]" in viewer["text/plain"]
