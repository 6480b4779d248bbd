"""Getting a mind: how many bodies babble for how long, and in which unit what is held out is judged."""

from pathlib import Path

import numpy as np
import pytest

from babbling.files import save
from babbling.pilot import begin, pilot_minutes
from experiments.errors import ExperimentError
from experiments.shared.held_out import HeldOut
from experiments.shared.minds import COPIES, PILOT_SHARE, body_of, copies_for, learn_mind
from experiments.shared.options import BodyOptions
from models.units import SHOWN


def test_as_many_bodies_as_leave_time_to_babble() -> None:
    """The pilot never takes longer than there is, nor more than its share where there are several bodies."""
    minutes = np.linspace(pilot_minutes(1), 12, 400)
    many = [copies_for(float(one)) for one in minutes]
    assert many[0] == 1 and many[-1] == COPIES and (np.diff(many) >= 0).all() and {*many} == {*range(1, COPIES + 1)}
    for one, copies in zip(minutes, many, strict=True):
        assert pilot_minutes(copies) <= (one if copies == 1 else PILOT_SHARE * one)
        assert copies == COPIES or pilot_minutes(copies + 1) > PILOT_SHARE * one
    with pytest.raises(ExperimentError, match=r"--babbling-minutes 0.29: to find out .* takes 0.29 alone"):
        copies_for(0.29)


@pytest.mark.parametrize("minutes", [pilot_minutes(1), 0.4])
def test_minutes_are_body_time_in_all(arm: Path, hasty: None, minutes: float) -> None:
    """Even where the pilot is all there is."""
    learned = learn_mind(BodyOptions(robot=str(arm), threads=1), minutes, lambda done: None)
    spent = learned.metrics["pilot_body_minutes"] + learned.metrics["babbling_body_minutes"]
    assert spent == pytest.approx(minutes, abs=0.02 / 60 + 1e-9)
    assert learned.mind.pilot.minutes == pilot_minutes(1)
    curve = learned.curve
    assert curve is not None and curve.unit == "deg" and len(curve.minutes) == len(curve.table) > 0
    assert curve.minutes[-1] == pytest.approx(spent) and curve.minutes[0] < learned.mind.pilot.minutes


def test_who_is_not_judged_learns_the_very_same(arm: Path, hasty: None, tmp_path: Path) -> None:
    for judged in (True, False):
        learned = learn_mind(BodyOptions(robot=str(arm), threads=1), 0.6, lambda done: None, judged=judged)
        save(learned.mind, tmp_path / f"{judged}.nc")
        assert (learned.curve is not None) == bool(learned.metrics) == judged
    assert (tmp_path / "True.nc").read_bytes() == (tmp_path / "False.nc").read_bytes()


RAIL = """<mujoco><compiler autolimits="true"/><option timestep=".005" gravity="0 0 0"/><worldbody><body>
  <joint name="x" type="slide" axis="1 0 0" range="0 .5"/><geom size=".05" mass="1"/><body>
  <joint name="y" type="{kind}" axis="0 1 0" range="0 .4"/><geom size=".05" mass="1"/></body></body></worldbody>
  <actuator><position joint="x" kp="900" kv="60"/><position joint="y" kp="{kp}" kv="{kv}"/></actuator></mujoco>"""


@pytest.mark.parametrize(("kind", "unit"), [("slide", "mm"), ("hinge", "deg")])
def test_a_body_that_only_slides_is_judged_in_millimetres(tmp_path: Path, kind: str, unit: str) -> None:
    path = tmp_path / "rail.xml"
    gains = {"kp": 900, "kv": 40} if kind == "slide" else {"kp": 2, "kv": 0.05}
    path.write_text(RAIL.format(kind=kind, **gains).replace("autolimits", 'angle="radian" autolimits'))
    options = BodyOptions(robot=str(path), threads=1, scramble=1)
    found, model = begin(body_of(options, 2), 0)
    held_out = HeldOut(body_of(options, 2), found, 0)
    assert held_out.unit == unit and held_out.counted.sum() == (2 if kind == "slide" else 1)
    held_out.note(0.1, model)
    curve = held_out.curve()
    away = (model.foretold_by(held_out.columns)[..., 0] - held_out.outcome)[:, held_out.counted]
    assert curve.line[0] == pytest.approx(dict(SHOWN.values())[unit] * np.sqrt(np.mean(away**2)))
    assert curve.unit == unit
