"""Held-out babbling: its floor is what the next senses add, and looking on changes nothing that is learned."""

from pathlib import Path

import numpy as np
import pytest

from babbling.loop import experience
from babbling.pilot import begin
from experiments.shared.held_out import FURTHER, STREAM, TICKS, HeldOut, Watched, unforeseen
from experiments.shared.minds import body_of
from experiments.shared.options import BodyOptions
from models.body import SimulatedBody


def bodies(arm: Path, noise_deg: float) -> SimulatedBody:
    return body_of(BodyOptions(robot=str(arm), threads=1, sensor_noise_deg=noise_deg), 4, stream=2)


def test_what_the_last_senses_added_shifts_the_belief_by_just_that(arm: Path) -> None:
    found, _ = begin(bodies(arm, 0.2), 0)
    motors, felt = experience(bodies(arm, 0.2), found, 0, 0, 12)
    added = np.random.default_rng(1).normal(0, 0.01, felt[1:].shape)
    shifts = unforeseen(found, added)
    for tick in (0, 3, 11):
        other = felt[: tick + 2].copy()
        other[-1] += added[tick]
        ends = [found.believed(motors[: tick + 1], senses)[0][-1, ..., 0] for senses in (felt[: tick + 2], other)]
        np.testing.assert_allclose(ends[1] - ends[0], shifts[tick], atol=1e-12)


def test_senses_that_add_nothing_leave_no_floor_and_twice_the_noise_twice_of_it(arm: Path) -> None:
    body = bodies(arm, 0.0)
    np.testing.assert_array_equal(body.truth, body.reset())
    found, model = begin(bodies(arm, 0.2), 0)
    none, some, more = (HeldOut(bodies(arm, deg), found, 0) for deg in (0.0, 0.2, 0.4))
    assert none.floor == 0 and more.floor == pytest.approx(2 * some.floor, rel=1e-6)
    some.note(1.0, model)
    assert 0 < some.floor < min(some.curve().table[0], some.curve().line[0])


def test_it_is_the_babbling_it_would_be_if_nobody_looked_at_its_truth(arm: Path) -> None:
    found, _ = begin(bodies(arm, 0.2), 0)
    usual = found.experienced(*experience(bodies(arm, 0.2), found, 5 + STREAM, 0, TICKS))
    held_out = HeldOut(bodies(arm, 0.2), found, 5)
    for ours, theirs in zip((held_out.columns, held_out.outcome), usual, strict=True):
        np.testing.assert_array_equal(ours, theirs)


def test_looking_on_within_a_bout_changes_nothing_and_notes_what_is_new(arm: Path) -> None:
    models, held_out = [], None
    for look_on in (False, True):
        runs: list[tuple[np.ndarray, np.ndarray]] = []
        found, model = begin(bodies(arm, 0.1), 0, lambda *run, kept=runs: kept.append(run))
        run = experience(bodies(arm, 0.1), found, 0, 0, 600)
        if look_on:
            held_out = HeldOut(bodies(arm, 0.1), found, 0)
            held_out.note_pilot(*runs[0], found)
            within = len(held_out.points)
            now = iter(np.linspace(found.minutes, 2 * found.minutes, 40))
            watched = Watched(found, lambda: held_out.note(next(now), model, within=True))  # noqa: B023
            watched.learn(model, *run)
        else:
            found.learn(model, *run)
        models.append(model)
    for name in ("moments", "evidence", "squares", "foretold"):
        np.testing.assert_array_equal(getattr(models[0], name), getattr(models[1], name))
    np.testing.assert_array_equal(models[0].table.counts, models[1].table.counts)
    assert held_out is not None and within >= 2 and len(held_out.points) > within
    minutes = held_out.curve().minutes
    assert (np.diff(minutes) > 0).all() and minutes[0] < found.minutes
    assert (minutes[within + 1 :] >= FURTHER * minutes[within:-1]).all()
