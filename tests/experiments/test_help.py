"""What help says of every experiment: sentences, values and defaults in words, an example that parses."""

import re
import shlex
from collections.abc import Callable
from dataclasses import fields
from itertools import groupby, pairwise
from pathlib import Path
from typing import Literal, get_args, get_origin, get_type_hints

import pytest

from experiments.__main__ import main
from experiments.command_line import parse
from experiments.registry import EXPERIMENTS

Help = Callable[[str, int], str]


@pytest.fixture
def helped(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Help:
    """What `imitate NAME --help` prints in a terminal so wide."""

    def read(name: str, columns: int) -> str:
        monkeypatch.setenv("COLUMNS", str(columns))
        assert main([name, "--help"]) == 0
        return capsys.readouterr().out

    return read


def boxed(text: str) -> dict[str, list[str]]:
    """Option -> the lines of its box, its own first."""
    found = dict[str, list[str]]()
    for line in re.findall(r"^[ │] (.*?) *│?$", text, re.MULTILINE):  # sides are blanks where letters are ASCII alone
        if re.match(r"--[a-z]|\[?\{hoap2|DIR DIR|TABLE", line):
            head, _, rest = re.sub(r" {2,}", "\n", line, count=1).partition("\n")
            found[(last := head.split(" ")[0])] = [head, rest]
        elif found and not line.startswith("-h"):
            found[last].append(line)
    return found


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_no_types_and_no_none_and_a_sentence_for_each_option(name: str, helped: Help) -> None:
    text = helped(name, 120)
    assert not re.search(r"\b(STR|INT|FLOAT|PATH|BOOL|None|False|True)\b|--no-|default: \)", text)
    options = boxed(text)
    assert len(options) == len(fields(EXPERIMENTS[name].options()))
    for option, lines in options.items():
        said = " ".join(" ".join(lines[1:]).split())
        assert re.search(r"\w.*\.( \(default: [^()]+\))?$", said), f"{option} is not explained: {said!r}"


@pytest.mark.parametrize("columns", [80, 120])
@pytest.mark.parametrize("name", EXPERIMENTS)
def test_lines_are_as_long_as_the_terminal_lets_them(name: str, columns: int, helped: Help) -> None:
    """No sentence is broken where the next word would have fitted, and none runs over the edge."""
    text = helped(name, columns)
    assert max(map(len, text.splitlines())) <= columns
    for lines in boxed(text).values():
        for line, following in pairwise(line for line in lines[2:] if line.startswith("  ")):
            assert len(line) + 1 + len(following.split()[0]) > columns - 6, (line, following)


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_a_closed_set_is_shown(name: str, helped: Help) -> None:
    lines = boxed(helped(name, 200))
    for option, kind in get_type_hints(EXPERIMENTS[name].options()).items():
        for literal in (one for one in (kind, *get_args(kind)) if get_origin(one) is Literal):
            assert "{" + ",".join(get_args(literal)) + "}" in lines[f"--{option.replace('_', '-')}"][0]
    for option in {"--selection", "--condition", "--gesture", "--act", "--object", "--movement"} & {*lines}:
        assert re.search(r"\{\S.*,.*\}", lines[option][0])


@pytest.mark.parametrize("name", EXPERIMENTS)
def test_the_example_parses_and_says_how_long_it_takes(
    name: str, helped: Help, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shown = re.search(r"^Example: imitate (.+)\nIt takes \w.*\.$", helped(name, 80), re.MULTILINE)
    assert shown
    monkeypatch.chdir(tmp_path)
    of, *words = shlex.split(shown[1])
    config = parse(EXPERIMENTS[name].options(), name, words)
    assert of == name and words and config is not None and config != EXPERIMENTS[name].options()()
    config.check()


def test_stages_follow_each_other() -> None:
    stages = [stage for stage, _ in groupby(one.stage for one in EXPERIMENTS.values())]
    assert len(stages) == len(set(stages)) > 4 and "Others" not in stages
    assert [one[:7] for one in stages if one.startswith("Stage")] == [f"Stage {k}" for k in (1, 2, 3, 4)]
