"""Ground rules of the repository: what may stand in it, and that its versions are said with reasons and hashes."""

import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).resolve().parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
LONGEST_FILE, LONGEST_TEST = 300, 450  # aim at 150, ask why above 200; tests may list more cases
HOSTS = re.compile(r"pypi[.]org|pythonhosted[.]org|pypi[.]python[.]|anaconda[.]org|npmjs[.]|crates[.]io", re.I)
INDEX = re.compile(r"--(?:extra-)?index[-]url|--find[-]links|--trusted[-]host|--default[-]index|index[-]url\s*=", re.I)
MACHINE = re.compile(r"(?<![\w.}*])/(?:home|root|Users|work|tmp/\w)/\w|[A-Z]:\\Users")
GENERATED = {".rrd", ".nc", ".npz", ".npy", ".pyc", ".pkl", ".partial", ".so", ".whl"}
FOREIGN_LOCKS = re.compile(r"(?:uv|poetry|pdm)\.lock|pylock.*\.toml|Pipfile\.lock|package-lock\.json")


@cache
def tracked() -> tuple[Path, ...]:
    """Files that git tracks, as they stand here; tests that ask skip where there is no repository (an sdist)."""
    asked = ["git", "-C", str(ROOT), "ls-files", "-z", "--cached"]
    try:
        if not (ROOT / ".git").exists():
            raise FileNotFoundError
        listed = subprocess.run(asked, capture_output=True, text=True, check=True, timeout=30).stdout
    except (OSError, subprocess.SubprocessError):
        pytest.skip("not a git checkout")
    return tuple(path for name in listed.split("\0") if name and (path := ROOT / name).is_file())


def lines_with(pattern: re.Pattern[str]) -> list[str]:
    """Places in tracked text where the pattern stands."""
    found = []
    for path in tracked():
        try:
            text = path.read_text(encoding="utf-8")
        except UnicodeDecodeError:
            continue  # a picture
        for number, line in enumerate(text.splitlines(), 1):
            if pattern.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()[:100]}")
    return found


@pytest.mark.parametrize("pattern", [HOSTS, INDEX, MACHINE], ids=["registry", "index option", "machine path"])
def test_no_address_of_a_registry_or_machine_is_tracked(pattern: re.Pattern[str]) -> None:
    assert lines_with(pattern) == []


@pytest.mark.parametrize(
    ("pattern", "line"),
    [
        (HOSTS, "https://pypi." + "org/project/x"),
        (INDEX, "pip install --extra-index" + "-url https://x"),
        (MACHINE, 'open("/home' + '/me/x")'),
        (MACHINE, 'open("/work' + '/main")'),
    ],
)
def test_the_patterns_see_what_they_are_for(pattern: re.Pattern[str], line: str) -> None:
    assert pattern.search(line)


def test_nothing_generated_is_tracked() -> None:
    assert [path.name for path in tracked() if path.suffix in GENERATED] == []
    assert [path.name for path in tracked() if FOREIGN_LOCKS.fullmatch(path.name)] == []


def test_no_link_is_tracked() -> None:
    """One to a place outside would break, or overwrite, what others have there."""
    try:
        listed = subprocess.run(["git", "-C", str(ROOT), "ls-files", "-s"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.SubprocessError):
        pytest.skip("not a git checkout")
    assert [line for line in listed.stdout.splitlines() if line.startswith("120000")] == []


def test_python_files_hold_one_concept_each() -> None:
    lengths = {str(p.relative_to(ROOT)): len(p.read_text().splitlines()) for p in tracked() if p.suffix == ".py"}
    limits = {name: LONGEST_TEST if name.startswith("tests") else LONGEST_FILE for name in lengths}
    assert {name: length for name, length in lengths.items() if length > limits[name]} == {}


@pytest.mark.parametrize("name", ["README.md", "RESULTS.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE"])
def test_the_papers_are_there(name: str) -> None:
    assert len((ROOT / name).read_text().split()) > 50


def test_the_changelog_knows_this_version() -> None:
    text = (ROOT / "CHANGELOG.md").read_text()
    assert re.findall(r"^## \[?([^\]\s]+)", text, re.M)[0] in {"Unreleased", PROJECT["project"]["version"]}


def required() -> list[str]:
    """Every dependency of the project, its extras and its build."""
    extras = PROJECT["project"]["optional-dependencies"].values()
    return [*PROJECT["project"]["dependencies"], *(one for extra in extras for one in extra)]


def test_every_dependency_has_a_floor_and_its_reason() -> None:
    lines = (ROOT / "pyproject.toml").read_text().splitlines()
    for one in [*required(), *PROJECT["build-system"]["requires"]]:
        assert any(clause.operator == ">=" for clause in Requirement(one).specifier), f"{one} has no floor"
        said = [line.partition("#")[2].strip() for line in lines if f'"{one}"' in line]
        assert said and all(len(reason.split()) >= 3 for reason in said), f"{one}: the reason stands behind it"


def locked() -> dict[str, tuple[str, list[str]]]:
    """Name -> (version, hashes) of requirements.lock."""
    found: dict[str, tuple[str, list[str]]] = {}
    for entry in re.split(r"\n(?=\S)", (ROOT / "requirements.lock").read_text().replace("\\\n", " ")):
        if not entry.strip() or entry.startswith("#"):
            continue
        pin = re.match(r"([a-z0-9][a-z0-9.-]*)==([0-9][\w.]*)( ; [^#]*?)?\s+--hash", entry)
        assert pin, f"not an exact version with hashes: {entry[:60]}"
        rest = re.sub(r"--hash=sha256:[0-9a-f]{64}", "", entry[pin.end() - len("--hash") :])
        assert not rest.strip(), f"{pin[1]}: {rest.strip()[:60]}"
        assert pin[1] not in found, f"{pin[1]} is locked twice"
        found[pin[1]] = (pin[2], re.findall(r"sha256:([0-9a-f]{64})", entry))
    return found


def test_the_lock_file_holds_every_dependency_within_its_bounds() -> None:
    lock = locked()
    assert all(hashes for _, hashes in lock.values())
    for one in [*PROJECT["project"]["dependencies"], *PROJECT["project"]["optional-dependencies"]["dev"]]:
        requirement = Requirement(one)
        version, _ = lock[canonicalize_name(requirement.name)]
        assert requirement.specifier.contains(version), f"{one}, locked at {version}: run make lock"
