"""The page of a run: complete in one file, its text as it is meant, its command the one that made it."""

import base64
import io
import shlex
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from experiments.command_line import parse
from experiments.registry import EXPERIMENTS
from experiments.shared.figures import learning_curve, legend_above, rates
from experiments.shared.options import Options
from experiments.shared.report import bare, command, drawn, page
from tests.figures import faults

PROVENANCE = {"project": "1", "commit": "abc", "versions": {"numpy": "2"}}


class Read(HTMLParser):
    """Tags with their attributes, and the text between them."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags, self.words = list[tuple[str, dict[str, str | None]]](), list[str]()
        self.open = list[str]()
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in ("meta", "img", "br", "hr"):
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.words.append(data)


def figure() -> Figure:
    drawn = Figure(figsize=(2, 1), layout="constrained")
    axes = drawn.subplots()
    axes.plot([0, 1])
    axes.set(xlabel="time [s]", ylabel="error [deg]")
    drawn.set_label("What <is> & what is shown.")
    return drawn


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "it.png").write_bytes(drawn(figure()))
    Image.fromarray(np.zeros((4, 4), np.uint8)).save(tmp_path / "film.gif")
    (tmp_path / "metrics.json").write_text('{"a": "<b>"}')
    return tmp_path


def made(folder: Path, summary: str = "# Found\n\nwords") -> Read:
    config = parse(EXPERIMENTS["maze"].options(), "maze", [])
    assert config is not None
    found = Read(page("maze", config, summary, {"it": figure()}, folder, PROVENANCE))
    assert not found.open
    return found


def test_everything_is_in_the_one_file(folder: Path) -> None:
    found = made(folder)
    kept = [
        value for _, attributes in found.tags for key, value in attributes.items() if key in ("src", "href", "data")
    ]
    assert kept and all(value and value.startswith(("data:", "#")) for value in kept)
    assert not [tag for tag, _ in found.tags if tag in ("script", "link", "iframe", "object")]
    pictures = [attributes["src"] or "" for tag, attributes in found.tags if tag == "img"]
    sizes = [Image.open(io.BytesIO(base64.b64decode(one.partition(",")[2]))).size for one in pictures]
    (_, drawn), (wide, high) = sizes, Image.open(folder / "it.png").size
    assert sizes[0] == (4, 4) and drawn[1] < high - 20 and drawn[0] <= wide  # its caption is text


def test_words_are_as_they_were_and_tables_are_tables(folder: Path) -> None:
    found = made(folder, "# Found <script>x</script>\n\n| a | b |\n| --- | --- |\n| 1 | <i>2</i> |")
    said = "".join(found.words)
    assert found.words.count("What <is> & what is shown.") == 1
    assert [tag for tag, _ in found.tags].count("figcaption") == 2  # the film has one too
    assert "What <is> & what is shown." in [attributes.get("alt") for tag, attributes in found.tags if tag == "img"]
    assert "Found <script>x</script>" in said and '{"a": "<b>"}' in said
    assert [tag for tag, _ in found.tags if tag in ("table", "th", "td", "i", "script")] == [
        "table",
        "th",
        "th",
        "td",
        "td",
    ]


@pytest.mark.parametrize(
    "words",
    [
        ["gesture"],
        ["gesture", "--seed", "3", "--attempts", "2", "--film", "gif", "--correspondence", "ik", "--servos"],
        ["gesture", "--stand", "--push", "1,0,4,0", "--clips", "icub-wave", "human-raise", "--babbling-minutes", "7.5"],
        ["maze", "--goal-prior", "0.5,0.25,0.25", "--deferred"],
        ["intentions", "--wants", "apart=1", "up=2"],
        ["face", "--gesture", "mouth open", "--scramble", "4"],
        ["compare", "runs/a b", "runs/c"],
    ],
    ids=" ".join,
)
def test_the_command_that_is_shown_gives_the_same_options(words: list[str]) -> None:
    name, kind = words[0], EXPERIMENTS[words[0]].options()
    config = parse(kind, name, [*words[1:], *([] if name == "compare" else ["--out", "somewhere", "--quiet"])])
    assert isinstance(config, Options)
    shown = shlex.split(command(name, config))
    assert shown[:2] == ["imitate", name] and sorted(shown[1:]) == sorted(words)
    assert parse(kind, name, shown[2:]) == parse(kind, name, words[1:])


def curve() -> Figure:
    made = learning_curve([1, 2, 3], {"one": [0.5, 0.4, 0.3], "other": [0.6, 0.5, 0.5]}, ("time [min]", "error [deg]"))
    made.set_label("How error falls.")
    return made


def test_a_figure_is_made_once_its_caption_and_legend_beside_what_it_shows() -> None:
    one = rates({"panel": {"rule": {"at": ["a", "b"], "share": [0.2, 0.9]}}}, ("how", "share"), ("chance", 0.5))
    one.set_label("A caption.")
    assert drawn(one) is drawn(one)
    made = np.asarray(Image.open(io.BytesIO(drawn(one))).convert("L"))
    without = np.asarray(Image.open(io.BytesIO(base64.b64decode(bare(one)))).convert("L"))
    assert made.shape[0] > without.shape[0] + 10  # the caption stands under it, and not in the page's picture
    assert (made[: without.shape[0] - 20, : without.shape[1]] == without[:-20, : made.shape[1]]).mean() > 0.99
    assert not faults(one)


@pytest.mark.parametrize(
    ("spoil", "found"),
    [
        (lambda one: one.set_label(" "), "no caption"),
        (lambda one: one.axes[0].set_xlabel(""), "x axis"),
        (lambda one: one.axes[0].set_ylabel(""), "y axis"),
        (lambda one: one.axes[0].legend(loc="upper left"), "lie over"),
        (lambda one: one.axes[0].tick_params(labelsize=4), "letters of 4"),
        (lambda one: one.legend(loc="center"), "the figure's legend"),
    ],
    ids=["caption", "x", "y", "over", "small", "legend"],
)
def test_a_figure_that_does_not_say_what_it_shows_is_found_out(spoil: Callable[[Figure], Any], found: str) -> None:
    one = curve()
    drawn(one)
    assert not faults(one)
    spoil(other := curve())
    with pytest.raises(AssertionError, match=found):  # what conftest.py holds every figure of a result to
        drawn(other)


def test_lines_are_named_between_the_axes_and_their_title() -> None:
    one = curve()
    one.axes[0].set_title("title")
    legend_above(one.axes[0], 1)
    drawn(one)
    legend, title = one.axes[0].get_legend(), one.axes[0].title
    assert legend is not None
    box = legend.get_window_extent()
    assert one.axes[0].bbox.y1 <= box.y0 and box.y1 <= title.get_window_extent().y0
