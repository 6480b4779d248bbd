"""Imports run one way: models and babbling apart, imitation upon babbling, experiments upon all, nobody upon them."""

import ast
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
NUMBERS = {"numpy", "scipy", "xarray", "h5netcdf", "h5py"}
MAY_IMPORT = {
    "models": NUMBERS | {"mujoco", "dm_control", "pinocchio"},
    "babbling": NUMBERS,
    "imitation": NUMBERS | {"babbling"},
}


def imported(file: Path) -> set[str]:
    """Top-level packages that a file imports, standard library apart."""
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file}: relative import"
            names.add(node.module or "")
    return {name.split(".")[0] for name in names} - set(sys.stdlib_module_names)


@pytest.mark.parametrize("package", MAY_IMPORT)
def test_imports_run_one_way(package: str) -> None:
    for file in sorted((ROOT / package).rglob("*.py")):
        assert imported(file) - {package} - MAY_IMPORT[package] == set(), file.relative_to(ROOT)


def test_there_is_no_other_house() -> None:
    packages = {file.parent.name for file in ROOT.glob("*/__init__.py")} - {"build", "dist"}
    assert packages == {*MAY_IMPORT, "experiments"}


def test_physics_stays_in_models() -> None:
    physics = MAY_IMPORT["models"] - NUMBERS
    for file in sorted((ROOT / "experiments").rglob("*.py")):
        assert imported(file) & physics == set(), file.relative_to(ROOT)
