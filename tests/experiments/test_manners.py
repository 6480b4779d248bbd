"""Manners of the command line: who it is, silence where it is wanted, completion in a real shell."""

import re
import shlex
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from experiments.__main__ import main
from experiments.babble import run as babble
from experiments.completion import script
from experiments.gesture import run as gesture
from experiments.registry import EXPERIMENTS
from experiments.shared.experiment import Result
from experiments.shared.progress import progress
from experiments.shared.tables import show
from experiments.shared.watching import watch
from models.loading import load_body


def test_it_says_which_version_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--version"]) == 0
    assert re.fullmatch(r"imitate \d+\.\d+\.\d+( \([\w.-]+\))?\n", capsys.readouterr().out)


def test_quiet_says_where_the_result_is_and_nothing_else(
    arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Of an experiment that leaves a folder and of one that leaves a file, both of which talk."""
    short = tmp_path / "short.csv"
    short.write_text("time,wrist\n0,0\n0.02,0.01\n0.04,0.02\n")

    def run(config: Any) -> Result:
        with progress("looks") as report:
            report(1.0)
        watch(config.demonstration, load_body(config.robot))  # says which joints rest
        return Result({"told": 1}, "| a table |")

    def command(config: Any) -> Path:
        show("| a table |")
        return Path("learned.nc")

    monkeypatch.setattr(gesture, "run", run)
    monkeypatch.setattr(babble, "command", command)
    words = ["gesture", "--robot", str(arm), "--demonstration", str(short), "--out", str(tmp_path / "out")]
    for quiet, out in (([], None), (["--quiet"], f"{tmp_path / 'out'}\n")):
        assert main([*words, *quiet]) == 0
        said = capfd.readouterr()
        assert said == (out, "") if out else "a table" in said.out and "names 1 of 3 joints" in said.err
    assert (tmp_path / "out" / "metrics.json").exists()
    assert main(["babble", "--quiet"]) == 0 and capfd.readouterr() == ("learned.nc\n", "")


def test_quiet_still_says_what_is_wrong(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    nothing = tmp_path / "none.csv"
    nothing.write_text("time,hip\n")
    assert main(["gesture", "--quiet", "--demonstration", str(nothing), "--out", str(tmp_path / "out")]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"imitate: {nothing}: ") and said.err.count("\n") == 1


def test_other_shells_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--completion", "fish"]) == 2
    assert "unknown shell 'fish'; there are bash, zsh" in capsys.readouterr().err


@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_a_real_shell_completes_names_and_options(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert main(["--completion", "bash"]) == 0
    path = tmp_path / "completion.sh"
    path.write_text(capsys.readouterr().out)
    assert script("zsh").endswith(path.read_text())

    def completed(*words: str) -> list[str]:
        line = f"COMP_WORDS=({shlex.join(['imitate', *words])}); COMP_CWORD={len(words)}"
        code = f'set -u; eval "$(cat {shlex.quote(str(path))})"; {line}; _imitate; printf "%s\\n" "${{COMPREPLY[@]}}"'
        return subprocess.check_output(["bash", "--norc", "-c", code], text=True).split()

    assert completed("ge") == ["gesture"]
    assert {*EXPERIMENTS, "list", "--version"} < {*completed("")}
    assert completed("gesture", "--sta") == ["--stand"]
    assert completed("babble", "--robot", "hoap2", "--qu") == ["--quiet"]
    assert "--forward-model" in completed("gesture", "") and "--forward-model" not in completed("maze", "")
    assert completed("gesture", "--motion", "") == []  # files
    assert completed("--completion", "z") == ["zsh"]
    assert completed("nonsense", "--") == []
    listed = subprocess.check_output(["bash", "-c", f". {shlex.quote(str(path))}; complete -p imitate"], text=True)
    assert listed == "complete -o default -F _imitate imitate\n"
