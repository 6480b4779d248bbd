"""`imitate fit`: what a person with a table gets, with and without a reference, and what is refused in a line."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image

from experiments.__main__ import main
from experiments.battery.fit import MODELS
from experiments.battery.table import IMITATOR, WHOLE, Trial, joined, tidy
from experiments.fit.options import Config
from experiments.fit.run import run
from tests.tables import write

ACTS = ("head", "hand", "elbow")
POINTS = (12, 12, 10)
PARAMETERS = {"temperature", "trust", "lapse"}


@pytest.fixture(autouse=True)
def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """A grid that tests have time for."""
    real = run.__globals__["prior"]
    monkeypatch.setitem(run.__globals__, "prior", lambda spread, lapse: real(spread, lapse, POINTS))


@pytest.fixture
def battery(tmp_path: Path) -> Path:
    """A folder of a battery: 8 imitators that match their posterior but for a lapse, a peer that does nothing else but
    one act."""
    rng, trials = np.random.default_rng(0), []
    for agent in range(8):
        for shown, habit in (("occupied", [0.1, 0.8, 0.1]), ("free", [0.6, 0.3, 0.1])):
            for trial in range(12):
                likelihood, prior = rng.dirichlet(np.array(habit) * 6), rng.dirichlet([1, 4, 1])
                chance = 0.1 / 3 + 0.9 * likelihood * prior / (likelihood @ prior)
                for who, done in ((IMITATOR, str(rng.choice(ACTS, p=chance))), ("peer", "elbow")):
                    trials.append(Trial(
                        agent, agent, WHOLE, who, 3, "panel", shown, trial, done, "head", float(done == "head"),
                        options=joined(ACTS), likelihood=joined(likelihood), prior=joined(prior),
                    ))  # fmt: skip
    (folder := tmp_path / "battery").mkdir()
    write(tidy(trials), folder)
    return folder


def infants(battery: Path, path: Path) -> Path:
    """The imitators' first choices, as a stranger would write them: names, no options."""
    frame = pd.read_csv(battery / "trials.csv").query("who == 'imitator' and trial < 5")
    told = frame[["agent", "task", "condition", "trial", "response"]]
    told.assign(agent=[f"P{agent:02d}" for agent in told["agent"]]).to_csv(path, index=False)
    return path


def test_the_command_leaves_parameters_models_checks_and_figures(battery: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["fit", str(battery / "trials.parquet"), "--recover", "--recoveries", "4", "--out", str(out)]) == 0
    told = json.loads((out / "metrics.json").read_text())
    assert told["individuals"] == 8 and told["choices"] == 192 and told["rows_left_out"] == 0  # the peer's are not
    for found in (told["pooled"], told["population"], *told["individual"].values()):
        assert found.keys() == PARAMETERS
        assert all(0 <= low <= middle <= high for middle, low, high in found.values())
    for _, low, high in (told["pooled"][name] for name in ("temperature", "trust")):
        assert low < 1 < high
    assert told["model_probability"].keys() == set(MODELS) and told["model_probability"]["full"] > 0.99
    assert sum(told["best_model_of"].values()) == 8 and len(told["check"]) == 6
    assert told["recovery"]["individual"].keys() == PARAMETERS
    assert {path.stem for path in out.glob("*.png")} == {"parameters", "check", "models", "recovery"}
    with Image.open(out / "parameters.png") as picture:
        assert min(picture.size) > 300
    assert not (out / "recording.rrd").exists() and "temperature" in (out / "report.html").read_text()


def test_the_same_again_from_text_and_in_any_order(battery: Path, tmp_path: Path) -> None:
    frame = pd.read_csv(battery / "trials.csv", keep_default_na=False, dtype=str)
    frame.sample(frac=1, random_state=3).to_csv(tmp_path / "mixed.csv", index=False)
    one, same, mixed = (
        run(Config(table=path)).metrics
        for path in (battery / "trials.csv", battery / "trials.parquet", tmp_path / "mixed.csv")
    )
    assert one == same
    for name, values in one["pooled"].items():
        assert mixed["pooled"][name] == pytest.approx(values, rel=1e-6)
    assert mixed["individual"].keys() == one["individual"].keys()


def test_infants_of_ones_own_are_fitted_by_what_agents_had_to_choose_among(battery: Path, tmp_path: Path) -> None:
    path = infants(battery, tmp_path / "infants.csv")
    found = run(Config(table=path, reference=battery / "trials.csv"))
    assert set(found.metrics["individual"]) == {f"P{n:02d}" for n in range(8)} and found.metrics["choices"] == 80
    assert found.metrics["log_evidence"]["full"] > found.metrics["log_evidence"]["chance"]
    alone = pd.read_csv(path).query("agent == 'P03'")
    alone.to_csv(path, index=False)
    one = run(Config(table=path, reference=battery / "trials.csv"))
    assert "population" not in one.metrics and "| - |" in one.summary


def refusal(capsys: pytest.CaptureFixture[str], tmp_path: Path, *words: object) -> str:
    capsys.readouterr()
    assert main(["fit", *map(str, words), "--out", str(tmp_path / "none")]) == 2
    [line] = capsys.readouterr().err.splitlines()
    assert line.startswith("imitate: ") and line.isprintable() and not (tmp_path / "none").exists()
    return line


def test_refusals(battery: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "no table is named" in refusal(capsys, tmp_path)
    path = infants(battery, tmp_path / "infants.csv")
    assert "there is no reference" in refusal(capsys, tmp_path, path)
    reference = ("--reference", battery / "trials.csv")
    told = path.read_text()
    path.write_text(told.replace("panel", "pane"))
    assert "same task and condition in a reference (panel, free; panel, occupied)" in refusal(
        capsys, tmp_path, path, *reference
    )
    path.write_text(told.replace("elbow", "elbows"))
    assert "did you mean 'elbow'" in refusal(capsys, tmp_path, path, *reference)
    path.write_text(told.replace("response", "answer"))
    assert "columns missing: response" in refusal(capsys, tmp_path, path, *reference)
