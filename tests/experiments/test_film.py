"""A film of an imitation: as long as the movement, all of it in the picture, refused before anything is spent."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageSequence

import experiments.shared.options as options
from experiments.__main__ import main
from experiments.shared.film import FRAMES_S, SIZES, filmed
from experiments.shared.palette import DEMONSTRATED, GROUND
from models.body import SimulatedBody
from models.loading import load_body
from models.teachers.performance import Performance

SECONDS = 1.2


def moving(arm: Path) -> tuple[SimulatedBody, np.ndarray, np.ndarray]:
    """A body, its configurations and those of its ghost."""
    body = load_body(arm)
    t = np.arange(round(SECONDS / body.tick_s)) * body.tick_s
    angles = np.stack([0.8 * np.sin(3 * t), 1 + 0 * t, 0 * t], 1)
    return body, body.configurations(angles), body.configurations(angles + 0.3)


def stick() -> Performance:
    time = np.arange(0, SECONDS, 0.02)
    points = np.tile([[0.0, 0, 0], [0, 0, 1.0]], (len(time), 1, 1))
    return Performance("made", "nobody", time, {}, points, ((0, 1),))


def test_a_gif_is_as_long_as_the_movement_and_shows_both(arm: Path, tmp_path: Path) -> None:
    [(name, write)] = filmed("gif", "made", *moving(arm), stick()).items()
    write(tmp_path / name)
    with Image.open(tmp_path / "film.gif") as film:
        pictures = [np.array(frame.convert("RGB"), int) for frame in ImageSequence.Iterator(film)]
        assert film.info["duration"] == 1000 / FRAMES_S and film.info["loop"] == 0 and film.size == SIZES["gif"]
    assert name == "film.gif" and len(pictures) == SECONDS * FRAMES_S
    assert np.abs(pictures[0] - pictures[5]).max() > 50
    corner = pictures[0][0, 0]
    assert np.abs(corner - GROUND).max() < 8
    drawn = (np.abs(pictures[0] - DEMONSTRATED).max(-1) < 8).any(0)
    assert drawn.any()  # the teacher's stick
    assert (np.abs(pictures[0] - corner).max(-1) > 8).mean() > 0.02


def test_an_mp4_is_read_again(arm: Path, tmp_path: Path) -> None:
    av = pytest.importorskip("av")
    [(name, write)] = filmed("mp4", "made", *moving(arm), None).items()
    write(tmp_path / name)
    with av.open(str(tmp_path / "film.mp4")) as film:
        pictures = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
        assert float(film.streams.video[0].average_rate) == FRAMES_S
    assert len(pictures) == SECONDS * FRAMES_S and pictures[0].shape == (*SIZES["mp4"][::-1], 3)


def test_no_film_is_no_file(arm: Path) -> None:
    assert filmed(None, "made", *moving(arm), None) == {}


def test_without_its_package_an_mp4_is_refused_at_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(options, "find_spec", lambda name: None)
    assert main(["gesture", "--film", "mp4"]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert "imitation-laboratory[film]" in line and "--film gif" in line
    assert main(["gesture", "--film", "mov"]) == 2
    options.a_film("--film", "gif")
