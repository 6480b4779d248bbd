"""What is shipped works where only it is installed: sdist and wheel are built, the wheel is tried away from here."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = ("models", "babbling", "imitation", "experiments")
PAPERS = (
    "pyproject.toml",
    "README.md",
    "RESULTS.md",
    "LICENSE",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "requirements.lock",
    "Makefile",
)
OFFLINE = {**os.environ, "PIP_NO_INDEX": "1", "PIP_DISABLE_PIP_VERSION_CHECK": "1", "MUJOCO_GL": "disabled"}
OFFLINE.pop("PYTHONPATH", None)


def call(*words: str | Path, cwd: Path) -> str:
    """Standard output of a program; its errors are in the message when it fails."""
    done = subprocess.run([str(w) for w in words], cwd=cwd, env=OFFLINE, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, f"{words}: {done.stdout[-1000:]}{done.stderr[-2000:]}"
    return done.stdout


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """(sdist, wheel): the sdist from a copy of the sources, the wheel from the sdist."""
    source, out = tmp_path_factory.mktemp("source"), tmp_path_factory.mktemp("dist")
    for folder in (*PACKAGES, "tests"):
        shutil.copytree(ROOT / folder, source / folder, ignore=shutil.ignore_patterns("__pycache__", "*.pyc"))
    for paper in (*PAPERS, "MANIFEST.in"):
        if (ROOT / paper).exists():
            shutil.copy(ROOT / paper, source)
    call(sys.executable, "-m", "build", "--no-isolation", "--outdir", out, source, cwd=out)
    return next(out.glob("*.tar.gz")), next(out.glob("*.whl"))


def files(*folders: str) -> set[str]:
    """Every source and data file below these folders; pictures stay with the repository."""
    return {
        path.relative_to(ROOT).as_posix()
        for folder in folders
        for path in (ROOT / folder).rglob("*")
        if path.is_file() and "__pycache__" not in path.parts and path.suffix not in {".png", ".gif"}
    }


def test_the_wheel_holds_the_four_packages_whole_and_nothing_else(built: tuple[Path, Path]) -> None:
    with zipfile.ZipFile(built[1]) as wheel:
        inside = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert inside == files(*PACKAGES)
    assert {"models/hoap2/hoap2.xml", "models/hoap2/README.md", "models/maze/default.txt"} <= inside
    assert {f"{library}/py.typed" for library in PACKAGES[:3]} <= inside


def test_the_sdist_holds_sources_tests_and_papers(built: tuple[Path, Path]) -> None:
    with tarfile.open(built[0]) as sdist:
        inside = {name.partition("/")[2] for name in sdist.getnames()}
    assert files(*PACKAGES, "tests") | set(PAPERS) <= inside


def test_the_installed_wheel_works_away_from_the_checkout(built: tuple[Path, Path], tmp_path: Path) -> None:
    home = tmp_path / "environment"
    call(sys.executable, "-m", "venv", "--without-pip", home, cwd=tmp_path)
    python = home / "bin" / "python"
    site = Path(call(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))", cwd=tmp_path).strip())
    call(sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-deps", built[1], cwd=tmp_path)
    # third-party libraries from here, without the hooks that would lead an editable install back to the checkout
    libraries = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    (site / "libraries.pth").write_text("".join(f"{path}\n" for path in libraries))

    listed = call(home / "bin" / "imitate", "list", cwd=tmp_path)
    assert "gesture" in listed.split()
    code = (
        f"import {', '.join(PACKAGES)}; from models.loading import load_body; from models.maze import default_maze;"
        f"print(*(p.__file__ for p in ({', '.join(PACKAGES)})), sep='\\n');"
        "print(load_body('hoap2', copies=2, threads=1).reset().shape, len(default_maze().goals))"
    )
    *places, last = call(python, "-I", "-c", code, cwd=tmp_path).splitlines()
    assert [Path(place).parent for place in places] == [site / package for package in PACKAGES]
    assert last == "(2, 50) 3"
