"""A bar tells of work: it never goes back, moves with every tick, and where there is no terminal nothing is said."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.progress import Progress

from experiments.shared import minds, progress
from experiments.shared.options import BodyOptions
from experiments.shared.progress import part, ticking
from models.loading import load_body


def test_what_was_shown_is_never_taken_back(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = list[float]()
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setattr(Progress, "update", lambda self, task, **now: shown.append(now["completed"]))
    with progress.progress("work") as report:
        for done in (0.1, 0.5, 0.2, 0.9, 1.2):
            report(done)
    assert shown == [0.1, 0.5, 0.5, 0.9, 1.0]


def test_without_a_terminal_nothing_is_said(capfd: pytest.CaptureFixture[str]) -> None:
    with progress.progress("work") as report:
        report(0.5)
    assert capfd.readouterr() == ("", "")


def test_ticks_are_progress_and_change_nothing(arm: Path) -> None:
    body, twin, told = load_body(arm), load_body(arm), list[float]()
    move = np.zeros((1, len(body.motor_low)))
    with ticking(body, part(told.append, 0.5, 1), 8, 4):
        felt = [body.act(move) for _ in range(4)]
    np.testing.assert_array_equal(felt, [twin.act(move) for _ in range(4)])
    np.testing.assert_allclose(told, [0.8125, 0.875, 0.9375, 1])
    body.act(move)
    assert len(told) == 4


def test_babbling_tells_from_its_first_second_to_its_last(arm: Path, hasty: None) -> None:
    told: list[Any] = []
    minds.learn_mind(BodyOptions(robot=str(arm), threads=1), 1.0, told.append)
    steps = np.diff([0, *told])
    assert (steps >= 0).all() and told[0] < 0.01 and told[-1] == 1
    assert steps[:-1].max() < 0.05
