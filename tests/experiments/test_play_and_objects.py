"""Play in a hurry, and acts on objects upon it: what is learned, kept, seen, remembered and done."""

import json
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

import experiments.shared.children as children
import experiments.shared.rounds as rounds
from babbling.files import load, save
from babbling.mind import Mind, learn
from babbling.play import Play
from experiments.__main__ import main
from experiments.objects import study
from experiments.objects.deciding import UNSEEN, decide, remembered, respond
from experiments.objects.found import Studied
from experiments.objects.showing import demonstrated, watched
from experiments.play.options import Config as Playing
from experiments.play.run import command
from experiments.shared.children import Child, beside, keep, meet
from experiments.shared.rounds import play_on, round_minutes
from imitation.acting.primitives import NAMES
from models.loading import load_body
from models.objects.states import LIT_BY_HEAD, STATES

HEAD, PRESS = NAMES.index("press with the head"), NAMES.index("press")


@pytest.fixture(scope="module")
def hurried() -> Iterator[None]:
    """Few children, who look at their hands for a moment."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rounds, "CHILDREN", 13)
        patch.setattr(rounds, "KEPT_EVERY", 1)
        patch.setattr(rounds, "LOOKING_MINUTES", 2.5)
        yield


@pytest.fixture(scope="module")
def mind() -> Mind:
    return learn(load_body("hoap2-seated", copies=8, threads=1), minutes=0.5, seed=0)


@pytest.fixture(scope="module")
def child(hurried: None, mind: Mind) -> Child:
    """Who played with a panel for two rounds, hands free and bound."""
    image = rounds.look_at_hands(mind, 0)
    play = play_on(mind, image, rounds.empty(mind, ("panel",)), ("panel", "panel:busy"), 2, 0, 1)
    return Child(mind, image, play)


def test_play_learns_that_the_forehead_lights_it_and_that_bound_hands_do_not(child: Child) -> None:
    table = child.play.outcomes.predictive[0, 0]
    assert table[0, HEAD, LIT_BY_HEAD] > 0.6 and table[0, PRESS, STATES.index("lit by hand")] > 0.6
    assert table[1, PRESS, STATES.index("lit by hand")] < 0.3
    surest = child.play.reached[0, :, STATES.index("lit by hand")].argmax()
    assert child.play.practised(0)[surest] == STATES.index("lit by hand")


def test_play_goes_on_where_it_was_interrupted(child: Child, hurried: None) -> None:
    things, saved = ("panel", "panel:busy"), list[Play]()

    def interrupt(play: Play) -> None:
        saved.append(play)
        raise KeyboardInterrupt

    begun = child.mind, child.image, rounds.empty(child.mind, ("panel",)), things, 2, 0
    with pytest.raises(KeyboardInterrupt):
        play_on(*begun, 1, after=interrupt)
    again = play_on(child.mind, child.image, saved[0], things, 2, 0, 1)
    for one in ("outcomes", "aims"):
        assert (getattr(again, one).counts == getattr(child.play, one).counts).all()
    assert (again.moved == child.play.moved).all() and again.rounds == 2
    assert again.minutes == pytest.approx(2 * round_minutes(things), abs=1e-4)


def test_what_was_seen_is_remembered_as_states_and_recognised_from_wherever_it_is_seen(child: Child) -> None:
    acts = demonstrated(child, "panel", "press with the head", "lit by head", 4, 1, keep=True)
    for seeing, condition in product(("points", "pixels"), ("live", "room", "television")):
        if (seeing, condition) == ("pixels", "room"):
            continue  # from one side the head may hide its own forehead as it touches
        act = acts if seeing == "points" else acts.only(np.arange(1))
        memories = remembered(child.play, "panel", watched(act, condition, np.random.default_rng(2), seeing))
        assert [memory.states[-1] for memory in memories] == [LIT_BY_HEAD] * len(act.rows), condition
        assert [int(memory.primitive.argmax()) for memory in memories] == [HEAD] * len(act.rows), (condition, seeing)


def test_who_saw_the_head_uses_it_and_who_saw_nothing_does_what_it_likes(child: Child) -> None:
    goals = np.array([LIT_BY_HEAD, UNSEEN])
    posterior, _ = decide(child.play, 0, 0, goals, "map")
    assert posterior.probability[0].argmax() == HEAD and posterior.probability[0, HEAD] > 0.6
    np.testing.assert_allclose(posterior.probability[1], child.play.liking[0, 0])
    done = respond(child, "panel", np.full(6, LIT_BY_HEAD), 2, "map", np.random.default_rng(0))
    assert done.ever(LIT_BY_HEAD).mean() > 0.8
    assert (done.states[:, 1] == -1).mean() > 0.5  # who has reached it stops


def test_eq_1_is_brute_force_bayes_on_the_table_of_play(child: Child) -> None:
    counts = child.play.outcomes.counts[0, 0, 0].astype(float)
    usual = (counts.sum(0) + 1 / len(STATES)) / (counts.sum() + 1)
    strength = child.play.outcomes.prior_strength
    likely = (counts[:, LIT_BY_HEAD] + strength * usual[LIT_BY_HEAD]) / (counts.sum(1) + strength)
    done = child.play.outcomes.counts[0].sum(-1).astype(float)
    common = (done.sum((0, 1)) + 1 / len(NAMES)) / (done.sum() + 1)
    habit = (done[0, 0] + strength * common) / (done[0, 0].sum() + strength)
    expected = likely * habit / (likely * habit).sum()
    found = decide(child.play, 0, 0, np.array([LIT_BY_HEAD]), "map")[0].probability[0]
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_a_child_is_kept_whole_and_somebody_else_s_mind_is_refused(child: Child, tmp_path: Path) -> None:
    keep(child, tmp_path / "play.nc")
    again = meet(tmp_path / "play.nc")
    assert (again.play.aims.counts == child.play.aims.counts).all() and again.mind.fingerprint == child.mind.fingerprint
    other = learn(load_body("hoap2-seated-small", copies=8, threads=1), minutes=0.2, seed=0)
    save(other, beside(tmp_path / "play.nc", "mind"))
    with pytest.raises(children.ExperimentError, match="of another body"):
        meet(tmp_path / "play.nc")


def test_both_commands(child: Child, hurried: None, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save(child.mind, tmp_path / "mind.nc")
    out = tmp_path / "play.nc"
    minutes = round_minutes(("panel",))
    told = Playing(
        minutes=2 * minutes, things=("panel",), forward_model=tmp_path / "mind.nc", out=out, workers=1, seed=0
    )
    with pytest.MonkeyPatch.context() as patch, pytest.raises(KeyboardInterrupt):  # before the first round
        patch.setattr("experiments.play.run.play_on", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        command(told)
    command(told)
    played = load(out, Play)
    assert played.rounds == 2 and played.minutes == pytest.approx(2 * minutes, abs=1e-4)
    shown = json.loads(out.with_suffix(".json").read_text())
    assert shown["tries"] == 2 * 13 and out.with_suffix(".png").stat().st_size > 10_000
    assert main(["play", "--merge", str(out), str(out), "--out", str(tmp_path / "twice.nc")]) == 0
    assert (load(tmp_path / "twice.nc", Play).outcomes.counts == 2 * played.outcomes.counts).all()
    capsys.readouterr()
    assert main(["play", "--out", str(out), "--things", "cup", "--workers", "1"]) == 2
    assert "name the same things" in capsys.readouterr().err
    for condition in ("live", "week"):
        words = ["objects", "--play", str(out), "--condition", condition, "--selection", "map", "--acts", "1"]
        assert main([*words, "--out", str(tmp_path / condition)]) == 0
        found = json.loads((tmp_path / condition / "metrics.json").read_text())
        assert found["goal"] == "lit by head" and found["acts"][0]["act"] == "press with the head"
        assert sum(found["posterior"].values()) == pytest.approx(1)
        assert (tmp_path / condition / "recording.rrd").stat().st_size > 50_000


def test_what_cannot_be_is_one_line(child: Child, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    keep(child, tmp_path / "play.nc")
    for words, part in (
        (["objects", "--object", "pannel"], "did you mean 'panel'"),
        (["objects", "--act", "prees"], "did you mean 'press'"),
        (["objects", "--object", "cup", "--play", str(tmp_path / "play.nc")], "never played with"),
        (["objects", "--plays", str(tmp_path / "play.nc")], "for --study"),
        (["objects", "--selection", "mean"], "no mean"),
        (["objects", "--further-m", "0.3", "--play", str(tmp_path / "play.nc")], "out of reach"),
        (["play", "--minutes", "0"], "more than 0"),
        (["play", "--things", "panel:tired"], "there are busy, free"),
        (["play", "--merge", str(tmp_path / "play.nc")], "two or more"),
        (["play", "--out", str(tmp_path / "play.txt")], "ends in .nc"),
    ):
        assert main(words) == 2, words
        said = capsys.readouterr().err
        assert part in said and len(said.splitlines()) == 1, said


def test_the_study_measures_what_it_says(child: Child, hurried: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(study, "PLACEMENTS", 6)
    monkeypatch.setattr(study, "SUCCESS", (("head", "panel", "press with the head", "lit by head"),))
    monkeypatch.setattr(study, "PLAYED", ("panel",))
    monkeypatch.setattr(study, "CELL", 1)
    monkeypatch.setattr(study, "TEST", 1)
    task = study.Task("", child, child, 0, 3, 1, "map", 0)
    monkeypatch.setattr(study, "ACTS", 2)
    parts = [study.measured(replace(task, part=part)) for part in ("success", "tables", "live", "emulate")]
    parts.append({"new": {"square": {"first": np.ones(4, bool), "own": np.ones(4, bool)}}, "creep_mm_per_s": 0.1})
    parts[-1] |= {"below": np.zeros(3, bool), "above": np.ones(5, bool)}
    parts[-1] |= {"recognised": {"points": np.ones(5, bool), "pixels": np.array([True, False])}}
    found = Studied([child], parts).metrics
    assert found["primitive_success_unaimed"]["head"] <= found["primitive_success"]["head"] > 0.6
    assert found["head_touch"]["live"] >= 2 / 3
    assert found["head_touch"]["emulate"] == 0 and found["recognition_pixels"] == 0.5
    assert found["new_object_ratio"] == 1 and found["apart_rate_above"] == 1 and found["apart_rate_below"] == 0
    assert np.isfinite(found["outcome_gain_bits"])
    low, high = found["head_touch_interval"]["live"]
    assert low < found["head_touch"]["live"] <= high
