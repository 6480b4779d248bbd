"""Rehearsal: joint by joint, what felt closest is kept, and what a mind was is left where nothing felt closer."""

from dataclasses import replace

import numpy as np
import pytest

from babbling.explanations import UNBELIEVED
from babbling.mind import Mind, Temper
from imitation.acting import rehearsal
from imitation.acting.rehearsal import CALM, CLOSER, EAGERNESS, OTHERWISE, calmest, rehearse
from imitation.inference.moving import AveragedInverse

OWN, PRIOR, LINE = (0.1, 0.0), *OTHERWISE


def felt(monkeypatch: pytest.MonkeyPatch, best: dict[tuple[float, float], list[float]]) -> list[tuple[float, float]]:
    """Rehearsals of each (trust, simple) feel at best so much in each joint, at eagerness number 2, 4, 6; and what was
    tried is kept."""
    tried = []

    def errors(body: object, mind: Mind, inverse: AveragedInverse, seed: int, seconds: float) -> np.ndarray:
        alone = bool((inverse.forward_model.evidence[:, 1:] == -UNBELIEVED).all())
        assert (inverse.forward_model.paced == (inverse.trust >= 1)).all(), "all of habit is habit of pace"
        way = float(inverse.trust[0]), float(alone)
        assert (inverse.trust == way[0]).all()
        tried.append(way)
        found = np.full((len(EAGERNESS), 3), 10.0)
        found[2 * len(tried)] = best[way]
        return found

    monkeypatch.setattr(rehearsal, "felt_errors", errors)
    return tried


def test_a_joint_takes_the_way_that_felt_closer_by_enough(arm_mind: Mind, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each by itself: less than `CLOSER` is no reason to change."""
    hardly, enough = 1 / (CLOSER - 0.01), 1 / (CLOSER + 0.01)
    tried = felt(monkeypatch, {OWN: [1, 1, 1], PRIOR: [hardly, enough, enough], LINE: [hardly, enough * hardly, 0.5]})
    found = rehearse(None, arm_mind, 0).temper  # type: ignore[arg-type]
    assert tried == [OWN, PRIOR, LINE]
    np.testing.assert_array_equal(found.trust, [OWN[0], PRIOR[0], LINE[0]])
    np.testing.assert_array_equal(found.simple, [OWN[1], PRIOR[1], LINE[1]])
    np.testing.assert_array_equal(found.eagerness, np.array(EAGERNESS)[[2, 4, 6]])


def test_where_nothing_feels_closer_a_mind_keeps_its_own_temper(
    arm_mind: Mind, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = Temper(np.full(3, 0.5), np.full(3, 0.3), np.zeros(3))
    mind = replace(arm_mind, temper=own)
    felt(monkeypatch, {(0.3, 0.0): [1, 1, 1], PRIOR: [1, 2, 3], LINE: [1, 0.99, 3]})
    found = rehearse(None, mind, 0)  # type: ignore[arg-type]
    np.testing.assert_array_equal(found.temper.trust, own.trust)
    np.testing.assert_array_equal(found.temper.simple, own.simple)
    np.testing.assert_array_equal(found.temper.eagerness, EAGERNESS[2])
    assert found.forward_model is arm_mind.forward_model and found.pilot is arm_mind.pilot


def test_the_calmest_that_is_nearly_the_best() -> None:
    errors = np.array([[3.0, CALM - 0.01, 2.0], [1.0, 1.0, CALM + 0.01], [2.0, 5.0, 1.0]])
    assert calmest(errors).tolist() == [1, 0, 2]
