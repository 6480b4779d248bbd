"""What was meant, and what is done then: laws of one imitator, what is shown, the commands upon a play in a hurry."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import experiments.intentions.found as found
import experiments.intentions.run as intentions
import experiments.intentions.showing as showing
import experiments.intentions.study as study
import experiments.shared.rounds as rounds
from babbling.mind import Mind, learn
from babbling.play import MIDDLE, PRIOR_STRENGTH, Play
from experiments.__main__ import main
from experiments.intentions.agents import GOALS, Agent, Belief, How, emulation
from experiments.intentions.options import CONDITIONS
from experiments.intentions.showing import Looks, presented
from experiments.intentions.trials import Trials
from experiments.shared.children import Child, keep
from experiments.shared.rounds import play_on
from imitation.acting.primitives import NAMES
from imitation.inference.meaning import Presentation
from models.loading import load_body
from models.objects.states import APART, JOINED, MOVED, SAME, STATES, UP

PULL, SPREAD, LIFT, SWEEP = (NAMES.index(name) for name in ("pull", "spread", "lift", "sweep"))
KIND = 0
USUAL = How()
CHILDREN = 3


def dumbbells() -> Play:
    """Who has pulled, spread, lifted and swept dumbbells, eight times each."""
    play = Play.empty("me", ("dumbbell",), NAMES, STATES, 6, CHILDREN)
    which = np.repeat([PULL, SPREAD, LIFT, SWEEP], 8)
    states = np.concatenate([np.repeat([APART, MOVED], [5, 3]), np.full(8, APART), np.full(8, UP), np.full(8, MOVED)])
    for child in range(CHILDREN):
        aims, strain = np.tile(MIDDLE, (32, 1)), np.ones(32)
        play = play.after(KIND, 0, which, states, aims, np.zeros((32, 6)), strain, np.full(32, child), 1.0)
    return play


PLAY = dumbbells()


def only(act: int) -> np.ndarray:
    return (np.arange(len(NAMES)) == act).astype(float)


def believed(seen: list[Presentation], somebody: float, how: How = USUAL) -> Belief:
    return Agent(PLAY.alone(0), how).believes(seen, KIND, KIND, 0, somebody)[0]


def ends(act: int, goal: int) -> int:
    """A world in which pulling fails and spreading works."""
    return {PULL: MOVED, SPREAD: APART, LIFT: UP, SWEEP: MOVED}.get(act, SAME)


IN_VAIN = [Presentation(only(PULL), MOVED, again) for again in (True, True, False)]


def reached(belief: Belief, count: int = 400, how: How = USUAL) -> float:
    """Share of imitators with whom it came apart."""
    agent = Agent(PLAY.alone(0), how)
    did = [agent.responds(belief, KIND, ends, np.random.default_rng(n)) for n in range(count)]
    return float(np.mean([(one.states == APART).any() for one in did]))


def test_who_saw_somebody_fail_does_what_was_meant_and_who_saw_a_thing_fail_does_not() -> None:
    agent = Agent(PLAY.alone(0), How())
    base = reached(agent.nothing_seen)
    somebody, thing = (reached(believed(IN_VAIN, p)) for p in (0.999, 1e-6))
    assert believed(IN_VAIN, 0.999).goal.argmax() == APART
    assert somebody > base + 0.2 and thing < base + 0.05
    everybody = How(all_somebody=True)
    assert reached(believed(IN_VAIN, 1e-6, everybody), how=everybody) > base + 0.2  # the difference is who it is


def test_the_end_that_a_thing_brought_about_is_sought_all_the_same() -> None:
    worked = [Presentation(only(PULL), APART, False)] * 3
    somebody, thing = (reached(believed(worked, p)) for p in (0.999, 1e-6))
    assert abs(somebody - thing) < 0.1 and thing > reached(Agent(PLAY.alone(0), How()).nothing_seen) + 0.2


def test_own_acts_count_at_once_and_the_play_is_left_as_it_was() -> None:
    """Where nothing works, what seemed best is done until (8 + k q) / (8 + k + n) falls below (5 + k q) / (8 + k)."""
    agent, belief = Agent(PLAY.alone(0), How(acts=12, selection="map")), believed(IN_VAIN, 0.999)
    before = agent.play.outcomes.counts.copy()
    did = agent.responds(belief, KIND, lambda act, goal: SAME, np.random.default_rng(0))
    k, q = PRIOR_STRENGTH, (13 + 1 / len(STATES)) / 33
    n = next(n for n in range(12) if (8 + k * q) / (8 + k + n) < (5 + k * q) / (8 + k))
    assert did.primitives.tolist()[: n + 1] == [SPREAD] * n + [PULL]
    np.testing.assert_array_equal(agent.play.outcomes.counts, before)


def test_peers_know_no_goals() -> None:
    agent, rng = Agent(PLAY.alone(0), How()), np.random.default_rng(0)
    assert set(agent.mimics(only(PULL), ends, rng).primitives) == {PULL}
    belief = emulation(IN_VAIN)
    assert belief is not None and belief.goal[MOVED] == 1 and belief.somebody == 1
    assert emulation([Presentation(only(PULL), SAME, False)]) is None


@pytest.mark.parametrize("change", [{"selection": "map"}, {"prior_strength": 2.0}, {"even_goals": True}, {"acts": 1}])
def test_an_imitator_may_be_otherwise(change: dict[str, object]) -> None:
    how = How(**change)  # type: ignore[arg-type]
    agent = Agent(PLAY.alone(0), how)
    assert agent.wants(KIND).sum() == pytest.approx(1)
    did = agent.responds(believed(IN_VAIN, 0.999, how), KIND, ends, np.random.default_rng(0))
    assert len(did.primitives) == how.acts
    if how.selection == "map":
        assert did.primitives[0] == SPREAD
    if how.even_goals:
        assert len(set(agent.wants(KIND)[agent.wants(KIND) > 0])) == 1


@pytest.mark.parametrize("change", [{}, {"even_goals": True}, {"trust": 0.0}, {"exponent": 0.0}, {"own_weight": 1.0}])
def test_who_never_played_wants_something_all_the_same(change: dict[str, object]) -> None:
    how = How(**change)  # type: ignore[arg-type]
    agent = Agent(PLAY.nothing(), how)
    assert agent.wants(KIND).sum() == pytest.approx(1)
    did = agent.responds(agent.nothing_seen, KIND, ends, np.random.default_rng(0))
    assert (did.primitives >= 0).all()


def made_up(toy: str, acts: list[tuple[str, int]]) -> Looks:
    which, states = np.array([NAMES.index(name) for name, _ in acts]), np.array([state for _, state in acts])
    count = len(acts)
    trials = Trials(
        toy, which, states, np.zeros(count, bool), False, np.zeros((count, 2, 5, 3)), np.zeros((count, 2), bool),
        np.zeros((count, 2, 7, 3)),
    )  # fmt: skip
    return Looks(trials, states, np.eye(len(NAMES))[which], np.eye(len(NAMES))[which])


LOOKS = {
    "dumbbell": made_up(
        "dumbbell", [("pull", APART), ("pull", MOVED), ("pull", SAME), ("lift with both", UP), ("sweep", MOVED)]
    ),
    "cup": made_up("cup", [("carry", JOINED), ("lift", UP)]),
}


@pytest.mark.parametrize("condition", [name for name, toys in CONDITIONS.items() if "dumbbell" in toys])
def test_what_is_shown_is_what_the_condition_says(condition: str) -> None:
    for n in range(10):
        shown = presented(condition, "dumbbell", LOOKS, 3, np.random.default_rng(n))
        assert shown is not None
        states, again = [one.state for one in shown.seen], [one.again for one in shown.seen]
        if "fail" in condition:
            assert APART not in states and again == [True, True, False] and shown.target == APART
        elif condition in ("target", "device_success"):
            assert states == [APART] * 3 and not any(again)
        elif condition == "manipulation":
            assert not any(one.movement[PULL] for one in shown.seen) and APART not in states
        elif condition == "baseline":
            assert not shown.seen
        else:
            assert sorted(again) == [False, True] and set(states) == {APART, UP}
            accident = next(one.state for one in shown.seen if one.again)
            assert (shown.target == accident) == (condition == "accidental")
        assert (shown.body == "poles and pincers") == condition.startswith("device")
        assert shown.contact == (not condition.startswith("device") and condition != "failed_unlooked")


def test_what_no_try_was_like_is_not_made_up() -> None:
    assert presented("failed", "cup", LOOKS, 3, np.random.default_rng(0)) is None


def test_bodies_are_less_and_less_like_one_s_own() -> None:
    outline = np.random.default_rng(0).normal(0, 0.1, (2, 4, 7, 3))
    for body, made in showing.BODIES.items():
        np.testing.assert_array_equal(
            np.isnan(made(outline)).any(-1).all((0, 1)), np.isnan(made(outline)).any((0, 1, 3))
        )
        assert (made(outline)[..., 1, :] == outline[..., 1, :]).all() == (body[:4] not in ("a sm", "arms"))
    long = showing.stretched(outline, 2.0)
    for hand, shoulder in ((0, 5), (1, 6)):
        arm = outline[..., hand, :] - outline[..., shoulder, :]
        np.testing.assert_allclose(long[..., hand, :] - outline[..., shoulder, :], 2 * arm)


# --- the commands -----------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def hurried() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rounds, "CHILDREN", 7)
        patch.setattr(rounds, "LOOKING_MINUTES", 4.0)
        yield


@pytest.fixture(scope="module")
def play(hurried: None, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of seven children with two dumbbells, for a round."""
    mind: Mind = learn(load_body("hoap2-seated", copies=8, threads=1), minutes=0.5, seed=0)
    image, things = rounds.look_at_hands(mind, 0), ("dumbbell", "outsized")
    file = tmp_path_factory.mktemp("play") / "play.nc"
    keep(Child(mind, image, play_on(mind, image, rounds.empty(mind, things), things, 1, 0, 1)), file)
    return file


def test_the_demo_infers_and_acts_and_draws(play: Path, hurried: None, tmp_path: Path) -> None:
    words = ["intentions", "--play", str(play), "--selection", "map", "--out", str(tmp_path / "out")]
    assert main([*words, "--condition", "manipulation", "--acts", "1"]) == 0
    told = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert sum(told["goal"].values()) == pytest.approx(1) and len(told["shown"]) == 3 and len(told["acts"]) == 1
    assert told["agent"] > 0.9
    assert (tmp_path / "out" / "recording.rrd").stat().st_size > 50_000
    memory = tmp_path / "memory.nc"
    (tmp_path / "out" / "memory.nc").rename(memory)
    assert main([*words, "--memory", str(memory), "--acts", "1"]) == 0
    later = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert later["goal"] == pytest.approx(told["goal"]) and later["agent"] == told["agent"] and not later["shown"]
    assert main([*words, "--memory", str(memory), "--condition", "outsized"]) == 2
    assert main([*words, "--condition", "baseline", "--acts", "1", "--wants", "apart=2", "up=0"]) == 0
    told = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert told["acts"][0]["goal"] == "apart" and told["goal_inferred"] is None


def test_the_study_of_a_few(play: Path, hurried: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = {name: CONDITIONS[name][:1] for name in ("target", "failed", "baseline", "device_failed", "outsized")}
    few["head_free"] = few["head_bound"] = few["head_none"] = ("dumbbell",)
    monkeypatch.setattr(study, "CONDITIONS", few)
    monkeypatch.setattr(found, "CONDITIONS", few)
    monkeypatch.setattr(intentions, "OBJECTS", ("dumbbell", "outsized"))
    monkeypatch.setattr(study, "MEANS", 2)
    monkeypatch.setattr(study, "CARELESS", 4)
    monkeypatch.setattr(intentions, "FILM_SEEDS", range(2))
    monkeypatch.setattr(intentions, "SENSITIVITY", {"1 act": {"acts": 1}})
    monkeypatch.setattr(showing, "SHOWS", {**showing.SHOWS, "panel": showing.SHOWS["dumbbell"]})
    monkeypatch.setattr(showing, "BODIES", {name: showing.BODIES[name] for name in ("person", "poles and pincers")})
    monkeypatch.setattr(study, "BODIES", showing.BODIES)
    few.pop("head_bound")
    words = ["intentions", "--study", "--sensitivity", "--plays", str(play), "--agents", "5", "--workers", "1"]
    monkeypatch.setattr(intentions, "told", lambda metrics: [("agents", str(metrics["agents"]))])
    assert main([*words, "--out", str(tmp_path / "out")]) == 0
    assert {f"{name}.png" for name in ("rates", "somebody", "goals", "films", "sensitivity")} <= {
        one.name for one in (tmp_path / "out").iterdir()
    }
    told = json.loads((tmp_path / "out" / "metrics.json").read_text())
    assert told["agents"] == 5 and set(told["rates"]) <= set(few) and told["rates"]["target"] >= 0
    for key in ("rates", "rates_mimicry", "rates_emulation"):
        assert all(0 <= share <= 1 for share in told[key].values())
    assert told["agent_posterior"]["person"] > 0.9 > 0.7 > told["agent_posterior"]["poles and pincers"]
    assert set(told["sensitivity"]) == {"as they are", "1 act"}
    assert 0 <= told["goal_calibration_error"] <= 1 and told["goal_presentations"] > 0


def test_what_cannot_be_is_one_line(play: Path, hurried: None, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(play)
    for words, part in (
        (["--condition", "faild"], "did you mean 'failed'"),
        (["--object", "panel"], "failed is shown with dumbbell or box"),
        (["--object", "cup", "--play", file], "never played with"),
        (["--plays", file], "for --study"),
        (["--sensitivity"], "a part of --study"),
        (["--selection", "mean"], "no mean"),
        (["--agents", "0"], "between 1"),
        (["--child", "90", "--play", file], "7 children played"),
        (["--study", "--plays", file, "--agents", "9"], "but 7 children played"),
        (["--play", file, "--wants", "apart=0"], "sum to something"),
        (["--play", file, "--wants", "apart=-1"], "0 or more"),
        (["--play", file, "--wants", "broken=1"], "a state being one of"),
    ):
        assert main(["intentions", *words]) == 2, words
        said = capsys.readouterr().err
        assert part in said and len(said.splitlines()) == 1, said


def test_goals_are_states_and_whatever_several_states_have_in_common() -> None:
    assert GOALS[: len(STATES)] == STATES and "lit" in GOALS
