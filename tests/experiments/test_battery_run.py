"""`imitate battery` as a whole, upon lives that take no time: the same rows whoever else lives, failures, resuming."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

import experiments.battery.figures as figures
import experiments.battery.run as battery
from experiments.__main__ import main
from experiments.battery.chapters import FILMS, STAGES
from experiments.battery.faces import Ward
from experiments.battery.films import Camera, Shot
from experiments.battery.found import Battery
from experiments.battery.life import Adult, Life
from experiments.battery.options import Config
from experiments.battery.parameters import QUICK
from experiments.battery.sensitivity import Change, changes
from experiments.battery.shards import Shard
from experiments.battery.table import IMITATOR, WHOLE, Trial, tidy
from experiments.errors import ExperimentError
from experiments.face.watching import Look, Looking

TOUCH = ("a week before", "nothing")
LIVED = list[int]()
FAILS = set[int]()


def nobody(life: Life, filmed: Life | None = None) -> Adult:
    return Adult({}, {})


def nothing(looking: Looking) -> list[Look]:
    return []


def row(life: Life, task: str, condition: str, hit: bool, without: str = WHOLE, who: str = IMITATOR) -> Trial:
    return Trial(life.agent, life.seed, without, who, 3, task, condition, 0, "", "", float(hit))


def grey() -> Shot:
    rng = np.random.default_rng(0)
    return (Image.fromarray(rng.integers(0, 255, (6, 8, 3), np.uint8)) for _ in range(2)), 12.5


def lived(shard: Shard, camera: Camera) -> list[Trial]:
    """Somebody who does it by a chance of its own, the likelier the larger the exponent."""
    rows = []
    camera.take("touch-1", grey)
    for life in shard.lives:
        LIVED.append(life.agent)
        if life.agent in FAILS:
            raise ValueError("it stumbled")
        chance = np.random.default_rng(life.seed).random()
        for without, share in ((WHOLE, 0.8), ("play", 0.1)):
            rows += [row(life, "head touch", one, chance < share * (one != "nothing"), without) for one in TOUCH]
        rows.append(row(life, "intention", "failed", chance < 0.2 * life.how.exponent))
    return rows


def faced(ward: Ward, camera: Camera) -> list[Trial]:
    return [row(life, "face", "tongue out, strong", True) for alike in ward.lives for life in alike]


Run = Callable[..., tuple[int, Path]]


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Run:
    for name, instead in (("adult", nobody), ("bank", nothing), ("lived", lived), ("faces", faced)):
        monkeypatch.setattr(battery, name, instead)
    LIVED.clear()
    FAILS.clear()

    def asked(*words: str, out: str = "it") -> tuple[int, Path]:
        folder = tmp_path / out
        return main(["battery", "--workers", "1", "--out", str(folder), *words]), folder

    return asked


def table(folder: Path) -> pd.DataFrame:
    return pd.read_parquet(folder / "trials.parquet")


def test_an_agent_is_itself_however_many_there_are_and_alone(run: Run) -> None:
    status, few = run("--agents", "8")
    assert status == 0
    assert run("--agents", "25", out="many")[0] == run("--agents", "8", "--only", "3", out="one")[0] == 0
    whole = table(few)
    pd.testing.assert_frame_equal(whole, table(few.with_name("many")).query("agent < 8"))
    alone = table(few.with_name("one"))
    pd.testing.assert_frame_equal(alone, whole[whole["agent"] == 3].reset_index(drop=True))


def test_two_agents_are_enough_for_a_result(run: Run) -> None:
    status, folder = run("--agents", "2")
    assert status == 0 and {"trials.csv", "dictionary.csv", "effects.csv"} <= {one.name for one in folder.iterdir()}


def test_what_fails_is_named_and_only_that_is_done_again(run: Run, capsys: pytest.CaptureFixture[str]) -> None:
    FAILS.add(4)
    status, folder = run("--agents", "6", "--stages", "objects", "face")
    said = capsys.readouterr().err
    assert status == 1 and sorted(set(table(folder)["agent"])) == [0, 1, 2, 3, 4, 5]
    assert set(table(folder).query("task != 'face'")["agent"]) == {0, 1, 2, 3, 5}
    assert "agent 4" in said and "ValueError: it stumbled" in said
    assert "imitate battery --stages objects face --agents 6 --seed 0 --only 4 --out" in said
    FAILS.clear()
    LIVED.clear()
    assert run("--agents", "6", "--stages", "objects", "face")[0] == 0 and LIVED == [4]
    assert set(table(folder).query("task != 'face'")["agent"]) == set(range(6))
    assert not folder.with_name("it.partial").exists()


def test_cells_have_the_same_seeds_and_verdicts_are_of_the_first_alone(run: Run) -> None:
    status, folder = run("--agents", "30", "--vary", "exponent=1,4")
    assert status == 0
    found, metrics = table(folder), json.loads((folder / "metrics.json").read_text())
    seeds = found.groupby("exponent")["seed"].agg(lambda column: sorted(set(column)))
    assert seeds[1.0] == seeds[4.0] and len(seeds[1.0]) == 30
    [week, *_] = [one for one in metrics["rows"] if one["task"] == "head touch: a week before"]
    assert week["agents"] == 30  # not 60: the other cell has the same children
    varied = [one for one in metrics["effects"] if one["between"] == "exponent" and one["task"] == "intention"]
    assert len(varied) == 1 and varied[0]["paired"] and varied[0]["high"] < 0
    [play] = [one for one in metrics["effects"] if one["between"] == "without" and one["condition"] == TOUCH[0]]
    assert play["n_a"] == play["n_b"] == 30 and abs(play["difference"]) > 0.3
    assert (folder / "vary_exponent.png").exists() and (folder / "power.png").exists()


def test_one_by_one_it_shows_what_depends_on_which_parameter(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    seen = list[Change]()
    draw = figures.sensitivity_figure
    monkeypatch.setattr(figures, "sensitivity_figure", lambda found: seen.extend(found) or draw(found))
    status, folder = run("--agents", "30", "--one-by-one", "--vary", "exponent=0,2", "trust=0.5")
    assert status == 0 and (folder / "sensitivity.png").exists()
    found = table(folder)
    assert len(found.groupby(["exponent", "trust"])) == 4 and found["agent"].nunique() == 120
    by = {(one.parameter, one.value, str(one.cell)): one for one in seen}
    assert len(by) == len(seen) and {one.usual for one in seen} == {1.0}
    shares = found[found["task"] == "intention"].groupby(["exponent", "trust"])["hit"].mean()
    for exponent in (0.0, 2.0):
        one = by["exponent", exponent, "intention: failed"].difference
        assert one.value == pytest.approx(shares[exponent, 1.0] - shares[1.0, 1.0])
        assert not one.low <= 0 <= one.high
    assert by["trust", 0.5, "intention: failed"].difference.value == 0


def test_it_says_how_busy_its_workers_were(run: Run) -> None:
    status, folder = run("--agents", "6")
    told = json.loads((folder / "metrics.json").read_text())
    assert status == 0 and told["workers"] == 1 and told["shards"] > 6
    assert 0 < told["efficiency_factor"] < 1.5 and told["shard_overhead_ms"] >= 0


def test_the_first_agent_is_filmed_which_changes_nothing(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    on = list[int]()
    monkeypatch.setattr(battery, "lived", lambda shard, camera: on.append(camera.on) or lived(shard, camera))
    assert run("--agents", "3", "--stages", "objects")[0] == 0 and on == [True, False, False]
    status, plain = run("--agents", "3", "--stages", "objects", "--without-films", out="plain")
    assert status == 0 and not any(on[3:]) and not list(plain.glob("film*"))
    folder = plain.with_name("it")
    with Image.open(folder / "film-touch-1.gif") as film:
        assert film.size == (8, 6) and film.n_frames == 2 and film.info["duration"] == 80
    pd.testing.assert_frame_equal(table(folder), table(plain))
    page = (folder / "report.html").read_text()
    assert page.count("data:image/gif;base64,") == 1 and FILMS["touch-1"] in page
    assert page.index("data:image/gif") > page.index(STAGES["touch"][0])
    assert {name.rpartition("-")[0] for name in FILMS} == set(STAGES)


def test_a_camera_takes_each_film_once_and_none_while_it_is_off() -> None:
    def never() -> Shot:
        raise AssertionError

    Camera().take("a", never)
    camera = Camera(on=True)
    camera.take("a", grey)
    first = camera.films["a"]
    camera.take("a", never)
    assert camera.films["a"] is first and first[:3].tobytes() == b"GIF"

    def unknown() -> Shot:
        raise ExperimentError("babble longer")

    camera.take("b", unknown)
    assert set(camera.films) == {"a"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--vary", "exponnent=1,2"], "did you mean|exponent"),
        (["--vary", "acts=0,2"], "between 1 and 20"),
        (["--vary", "exponent=-1"], "between 0 and 100"),
        (["--agents", "1"], "between 2 and"),
        (["--scheduler", "nowhere"], "tcp://HOST:PORT"),
    ],
)
def test_what_cannot_be_meant_is_refused_before_anybody_lives(
    run: Run, capsys: pytest.CaptureFixture[str], words: list[str], said: str
) -> None:
    status, folder = run(*words)
    err = capsys.readouterr().err
    assert status == 2 and len(err.splitlines()) == 1 and not folder.exists() and not LIVED
    assert any(one in err for one in said.split("|"))


def test_a_change_by_degrees_shows_in_few_agents_and_a_few_who_turn_round_do_not() -> None:
    rows = []
    for number in range(20):
        block, usual = number // 2, number % 2 == 0
        hits = 12 + block % 3 + (4 + block % 2) * usual
        rows += [
            Trial(number, block, WHOLE, IMITATOR, 2, "gaze, headband", "12 months", n, "", "", float(n < hits))
            for n in range(20)
        ]
        rows.append(row(Life(number, block, QUICK, ()), "head touch", "live", usual or block > 3))
    frame = tidy(rows, {number: {"exponent": (1.0, 0.5)[number % 2]} for number in range(20)})
    found = changes(Battery(Config(agents=10), frame, (), 1, 1.0, None), rng=np.random.default_rng(0))
    told = {str(one.cell): one.difference for one in found}
    assert told["gaze, headband: 12 months"].value == pytest.approx(-0.225)
    assert told["gaze, headband: 12 months"].high < 0
    assert told["head touch: live"].value == pytest.approx(-0.4) and told["head touch: live"].high > 0


def test_one_alone_asks_for_a_folder_of_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["battery", "--only", "3"]) == 2
    assert "--out" in capsys.readouterr().err
