"""The battery: what agents of one childhood share, what they choose, what stands beside infants; upon hurried lives."""

from collections.abc import Iterator
from dataclasses import fields, replace

import numpy as np
import pandas as pd
import pytest

import experiments.battery.faces as faces_module
import experiments.battery.films as films
import experiments.shared.rounds as rounds
from babbling.mind import Mind, learn
from experiments.battery.acting import VIEWS, acting, chances
from experiments.battery.beside import of, rows
from experiments.battery.chapters import STAGES, stage_of
from experiments.battery.effects import FEW, INSIDE, NOT_COMPARABLE, OTHER, OUTSIDE, SAME
from experiments.battery.faces import Ward, bank, faces, looks
from experiments.battery.figures import beside_infants, beside_signs
from experiments.battery.films import Camera
from experiments.battery.found import told
from experiments.battery.infants import RATES, SIGNS, Cell
from experiments.battery.life import Adult, Grown, Life, played_with, pool, unplayed
from experiments.battery.parameters import ALIKE, QUICK, Parameters
from experiments.battery.run import tasks
from experiments.battery.table import IMITATOR, WHOLE, Trial, parted, tidy
from experiments.objects.showing import demonstrated
from experiments.shared.children import Child
from experiments.shared.rounds import play_on
from imitation.acting.primitives import NAMES
from models.loading import load_body

THINGS = ("dumbbell", "panel")
CALM = replace(QUICK, acts=2, shown=1)


@pytest.fixture(scope="module")
def mind() -> Mind:
    return learn(load_body("hoap2-seated", copies=8, threads=1), minutes=0.5, seed=0)


@pytest.fixture(scope="module")
def grown(mind: Mind) -> Iterator[Grown]:
    """Who played with two things for two rounds, in a hurry."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(rounds, "CHILDREN", 13)
        patch.setattr(rounds, "LOOKING_MINUTES", 2.5)
        image, one = rounds.look_at_hands(mind, 0), Life(0, 5, CALM, THINGS)
        hands = rounds.look_at_hands(mind, 0, outline=True)
        play = play_on(mind, image, rounds.empty(mind, played_with(one)), played_with(one), 2, 0, 1)
        child = Child(mind, image, play)
        yield Grown(one, mind, image, None, hands, child, pool(child, 0, THINGS, means=2))


@pytest.fixture(scope="module")
def adult(grown: Grown) -> Adult:
    touch = demonstrated(grown.child, "panel", "press with the head", "lit by head", 4, 3)
    return Adult(pool(grown.child, 9, played_with(grown.life), 6, 0), {"live": touch, "room": touch})


@pytest.fixture
def camera(monkeypatch: pytest.MonkeyPatch) -> Camera:
    """Draws the first picture of each film alone."""
    monkeypatch.setattr(films, "write_gif", lambda file, pictures, rate: next(pictures).save(file, "GIF"))
    return Camera(on=True)


def test_agents_of_one_childhood_differ_in_nothing_that_growing_up_depends_on() -> None:
    first = Life(0, 1, QUICK, THINGS)
    for one in fields(Parameters):
        value = getattr(QUICK, one.name)
        other = Life(1, 1, replace(QUICK, **{one.name: not value if isinstance(value, bool) else value + 1}), THINGS)
        for part, names in ALIKE.items():
            assert (other.childhood(part) != first.childhood(part)) == (one.name in names), one.name
    assert all(Life(0, 2, QUICK, THINGS).childhood(part) != first.childhood(part) for part in ALIKE)
    assert sum(map(len, ALIKE.values())) == len(set().union(*ALIKE.values()))


def test_whoever_is_alike_lives_that_part_of_life_once() -> None:
    usual, later, looked, played = (
        Life(n, 1, replace(QUICK, **how), THINGS)
        for n, how in enumerate(({}, {"exponent": 2.0}, {"looking_minutes": 2.0}, {"play_rounds": 2}))
    )
    lives = [usual, later, looked, played]
    wards, shards = tasks(("movements", "gaze", "face"), lives, (), [])
    assert [[life.agent for life in some] for ward in wards for some in ward.lives] == [[0, 1, 2, 3]]
    together = {one.stages: [] for one in shards}
    for one in shards:
        together[one.stages].append([life.agent for life in one.lives])
    assert together == {("gaze",): [[0, 1, 3], [2]], ("movements",): [[0, 1, 2], [3]]}


def test_a_choice_is_eq_1_with_trust_in_habit_and_an_exponent() -> None:
    rng = np.random.default_rng(1)
    likelihood, prior = rng.random(5), rng.random(5)
    for trust, exponent in ((1.0, 1.0), (0.5, 1.0), (0.0, 2.0), (2.0, 0.3)):
        brute = [(one * habit**trust) ** exponent for one, habit in zip(likelihood, prior, strict=True)]
        found = chances(likelihood, prior, replace(QUICK, trust=trust, exponent=exponent))
        assert found == pytest.approx(np.array(brute) / sum(brute))
    assert chances(likelihood, prior, replace(QUICK, exponent=0.0)) == pytest.approx(np.full(5, 0.2))
    assert chances(np.zeros(5), prior, QUICK) == pytest.approx(prior / prior.sum())  # nothing is known to lead there


def test_who_saw_the_forehead_uses_it_and_who_never_played_or_forgets_does_not(
    grown: Grown, adult: Adult, camera: Camera
) -> None:
    keen = [replace(grown.life, agent=n, how=replace(CALM, exponent=20.0)) for n in range(2)]
    sieve = replace(keen[0], agent=2, how=replace(keen[0].how, forgets=1.0))
    found = tidy(acting(grown, [*keen, sieve], adult, camera))
    assert set(camera.films) == {"touch-2", "intentions-2"}
    touch = found[(found["task"] == "head touch") & (found["without"] == WHOLE)].set_index(["condition", "agent"])[
        "hit"
    ]
    assert set(touch.index.get_level_values(0)) == set(VIEWS)
    assert (touch[["live", "a week before"]].drop(index=2, level=1) == 1).all() and (touch["nothing"] < 1).all()
    assert touch["live", 2] == 1 and touch["a week before", 2] < 1  # it has forgotten
    none = found[(found["task"] == "head touch") & (found["without"] == "play")]
    assert (none[none["condition"] == "live"]["hit"] < 1).any()
    told = found[found["options"] != ""].iloc[0]
    assert told["options"].split("|") == list(NAMES) and len(parted(told["likelihood"])) == len(NAMES)
    meant = found[found["task"] == "intention"]
    assert {"target", "failed", "baseline", "device failed"} <= set(meant["condition"])
    assert set(meant[meant["without"] == WHOLE]["who"]) == {IMITATOR, "repeats the movement", "wants the end seen"}
    alike = [found[found["agent"] == n].drop(columns="agent").reset_index(drop=True) for n in (0, 1)]
    pd.testing.assert_frame_equal(*alike)  # of one childhood and one seed, and the same way of being


def test_who_never_played_knows_nothing_of_things(grown: Grown) -> None:
    play = unplayed(grown).child.play
    assert play.outcomes.counts.sum() == 0 and (play.practised(0) < 0).all()


def test_every_infant_is_shown_every_gesture_once_and_is_itself_whoever_else_is_asked_for(
    monkeypatch: pytest.MonkeyPatch, camera: Camera
) -> None:
    monkeypatch.setattr(faces_module, "WARD", 2)
    monkeypatch.setattr(faces_module, "EACH", 1)
    some = replace(QUICK, face_acts=60)
    seen = tuple(bank(looks(0)[0]))
    lives = [(Life(n, n, some, THINGS),) for n in range(2)]
    found = tidy(faces(Ward(0, 60, tuple(lives), seen), camera))
    assert set(camera.films) == {"face-1", "face-2"}
    counted = found[found["condition"] != "nothing shown"].groupby(["agent", "condition"]).size()
    assert len(counted) == 24 and (counted == 3).all()
    assert (found["hit"] == (found["response"] == found["target"])).all()
    alone = tidy(faces(Ward(0, 60, (lives[1],), seen)))
    pd.testing.assert_frame_equal(alone, found[found["agent"] == 1].reset_index(drop=True))


def row(agent: int, task: str, condition: str, hit: float, target: str = "", who: str = IMITATOR) -> Trial:
    return Trial(agent, agent, WHOLE, who, 3, task, condition, 0, "", target, hit)


def table(shares: dict[tuple[str, str, str], float], agents: int = 60) -> pd.DataFrame:
    """Populations in which a share of agents does it."""
    return tidy(
        row(n, task, condition, float(n < share * agents), target)
        for (task, condition, target), share in shares.items()
        for n in range(agents)
    )


def verdicts(shares: dict[tuple[str, str, str], float], agents: int = 60) -> dict[str, str]:
    found = rows(table(shares, agents), np.random.default_rng(0))
    return {f"{one['study']}: {one['task']}": one["verdict"] for one in map(told, found)}


def test_verdicts_follow_from_both_intervals() -> None:
    week, none = ("head touch", "a week before", ""), ("head touch", "nothing", "")
    found = verdicts({week: 0.65, none: 0.4})
    assert found["Meltzoff 1988, 14 months: head touch: a week before"] == INSIDE
    assert found["Heimann et al. 2017, 13 to 17 months: head touch: nothing"] == OUTSIDE
    assert found["Meltzoff 1988, 14 months: head touch: a week before > head touch: nothing"] == SAME
    found = verdicts({week: 0.4, none: 0.65})
    assert found["Meltzoff 1988, 14 months: head touch: a week before > head touch: nothing"] == OTHER
    assert verdicts({week: 0.5, none: 0.5}, 6)[
        "Meltzoff 1988, 14 months: head touch: a week before > head touch: nothing"
    ] == FEW  # fmt: skip
    found = verdicts({("intention", "failed", "dumbbell apart"): 0.6, ("intention", "failed", "box buzz"): 0.6})
    assert found["Meltzoff 1995, 18 months: intention: failed"] == NOT_COMPARABLE
    assert found["Meltzoff 1995, 18 months: intention: failed, dumbbell"] == INSIDE


def test_no_difference_is_agreed_to_only_where_it_is_small_for_sure() -> None:
    live, room = ("head touch", "live", ""), ("head touch", "another room", "")
    name = "Klein and Meltzoff 1999, 12 months: head touch: live = head touch: another room"
    assert verdicts({live: 1.0, room: 1.0})[name] == SAME
    assert verdicts({live: 1.0, room: 0.5})[name] == OTHER
    assert verdicts({live: 1.0, room: 0.9}, 10)[name] == FEW


def test_peers_and_other_things_do_not_count_as_agents() -> None:
    frame = tidy([row(0, "intention", "failed", 1.0, "dumbbell apart"), row(0, "intention", "failed", 0.0, "box buzz")])
    assert of(frame, Cell("intention", "failed", "dumbbell")).tolist() == [1.0]
    assert of(frame, Cell("intention", "failed")).tolist() == [0.5]
    peers = tidy(row(n, "head touch", "live", 1.0, who="repeats the movement") for n in range(5))
    assert all(one.simulated is None for one in rows(peers, np.random.default_rng(0)))


def test_every_published_row_names_what_agents_are_given() -> None:
    cells = [one.cell for one in RATES] + [cell for one in SIGNS for cell in (one.more, one.less)]
    tasks = {"head touch", "intention", "face", *(f"gaze, {cloth}" for cloth in ("headband", "blindfold"))}
    assert {cell.task for cell in cells} <= tasks
    assert all(one.n is None or one.share == pytest.approx((one.hits or 0) / one.n) for one in RATES)
    assert {stage_of(cell.task) for cell in cells} <= set(STAGES)


def test_figures_beside_infants_have_a_line_for_every_row() -> None:
    week = {("head touch", "a week before", ""): 0.65, ("head touch", "nothing", ""): 0.4}
    found = rows(table(week), np.random.default_rng(0))
    assert len(beside_infants(found).axes[0].get_yticklabels()) == 4
    assert len(beside_signs(found).axes[0].get_yticklabels()) == 1
