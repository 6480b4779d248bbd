"""Imports run one way: models and babbling apart, imitation upon babbling, experiments upon all, nobody upon them."""

import ast
import sys
from collections.abc import Collection
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
LAZY = {"experiments.__main__", "experiments.command_line", "experiments.registry"}
"""Who may import modules of the project inside a function: help must not wait for physics."""
NUMBERS = {"numpy", "scipy", "h5netcdf", "h5py"}
MAY_IMPORT = {
    "models": NUMBERS | {"mujoco", "dm_control", "pinocchio", "pandas"},
    "babbling": NUMBERS,
    "imitation": NUMBERS | {"babbling"},
}
DOOR = {"models.errors", "models.files", "models.apart"}
"""How strangers' files are opened and tried, the only thing of models that babbling uses; they know nothing else."""


def modules() -> dict[str, Path]:
    """Every module of the project, by name."""
    files = (file for package in [*MAY_IMPORT, "experiments"] for file in (ROOT / package).rglob("*.py"))
    return {".".join(file.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): file for file in files}


def imported_modules(tree: ast.AST, known: Collection[str]) -> set[str]:
    """Modules of the project that are imported anywhere below a node, for types alone too."""
    names: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            whole = {f"{node.module}.{alias.name}" for alias in node.names}
            names |= whole | {str(node.module)}
    return names & set(known)


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
        door = {"models"} if package == "babbling" else set()
        assert imported(file) - {package} - MAY_IMPORT[package] - door == set(), file.relative_to(ROOT)


def test_babbling_takes_nothing_of_models_but_the_door() -> None:
    known = modules()
    names = [name for name in known if name.startswith("babbling")]
    taken = set().union(*(imported_modules(ast.parse(known[name].read_text()), known) for name in names))
    assert {name for name in taken if name.startswith("models.")} == DOOR
    for name in DOOR:
        assert imported_modules(ast.parse(known[name].read_text()), known) <= DOOR | {"models"}, name
        assert imported(known[name]) <= {"models"}, name


def test_there_is_no_other_house() -> None:
    packages = {file.parent.name for file in ROOT.glob("*/__init__.py")} - {"build", "dist"}
    assert packages == {*MAY_IMPORT, "experiments"}


def test_physics_stays_in_models() -> None:
    physics = MAY_IMPORT["models"] - NUMBERS - {"pandas"}
    for file in sorted((ROOT / "experiments").rglob("*.py")):
        assert imported(file) & physics == set(), file.relative_to(ROOT)


def test_no_module_imports_itself_by_a_detour() -> None:
    known = modules()
    graph = {name: imported_modules(ast.parse(file.read_text()), known) - {name} for name, file in known.items()}
    assert len(list(TopologicalSorter(graph).static_order())) == len(known)  # raises CycleError, which names the circle


def test_modules_are_imported_at_the_top() -> None:
    known = modules()
    inside = {
        name
        for name, file in known.items()
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.FunctionDef) and imported_modules(node, known)
    }
    assert inside <= LAZY
