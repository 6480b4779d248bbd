"""200 g taken up after babbling: what counting on is worth, against one that babbled with them and against a line."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from babbling.axes import FloatArray
from babbling.features import BEFORE
from babbling.mind import Mind
from experiments.notice.options import Config
from experiments.shared.judging import rmse_deg
from experiments.shared.kept import once
from experiments.shared.minds import body_of, learn_mind
from experiments.shared.progress import Report
from experiments.shared.watching import watch
from imitation.acting.counting_on import CountingOn
from imitation.acting.loop import Attempt, imitate
from imitation.inference.inverse import Term
from imitation.inference.moving import Decided, Here
from models.hoap2.facts import PAYLOAD

ATTEMPTS = 4
KEEP = 0.03
"""Share of what babbling counted that is kept once a change was noticed."""
FORGETTING = 0.999
"""Of the line, per tick."""
WHO = ("counts on", "does not", "babbled with it", "line counts on", "line does not")


class RecursiveLine:
    """w = b . (1, v, c - q) by recursive least squares with forgetting; solved for c - q."""

    def __init__(self, mind: Mind) -> None:
        fit = mind.forward_model.fit("line")
        self.precision, self.weights = fit.precision, fit.coefficients[:, 0]

    def count(self, columns: FloatArray, outcome: FloatArray) -> None:
        """What was felt, in order."""
        x = columns[..., [0, 1, len(BEFORE)]]
        weight = FORGETTING ** np.arange(len(x))[::-1]
        old = FORGETTING ** len(x) * self.precision
        self.precision = old + np.einsum("n,nfx,nfy->fxy", weight, x, x)
        target = np.einsum("fxy,fy->fx", old, self.weights) + np.einsum("n,nfx,nf->fx", weight, x, outcome)
        self.weights = np.linalg.solve(self.precision, target[..., None])[..., 0]

    def choose(self, here: Here, wanted: FloatArray, terms: Sequence[Term], rng: np.random.Generator) -> Decided:
        """See `MovingInverse`."""
        stay, coast, pull = self.weights.T
        return Decided.bare((wanted - stay - coast * here.rate) / pull)

    def expect(self, here: Here, command: FloatArray) -> FloatArray:
        """See `MovingInverse`."""
        stay, coast, pull = self.weights.T
        return np.asarray(stay + coast * here.rate + pull * (command - here.posture))


def count_on(config: Config, report: Report) -> dict[str, FloatArray]:
    """Who -> (learners, demonstrations, ATTEMPTS) error of the arm that carries, degrees; every attempt aims at the
    sub-goals themselves."""
    shape = (config.learners, len(config.demonstrations), ATTEMPTS)
    errors = {who: np.zeros(shape) for who in WHO}
    for learner in range(config.learners):
        here = replace(config, seed=config.seed + learner)
        laden = replace(here, robot="hoap2-payload")
        mind, other = (
            once(learn_mind, one, config.babbling_minutes, report=lambda done: None).mind for one in (here, laden)
        )
        for d, demonstration in enumerate(config.demonstrations):
            body, born = body_of(here, 1, stream=3), body_of(laden, 1, stream=3)
            body.carry(PAYLOAD, "right_hand")
            seen = watch(demonstration, body, unit=config.unit)
            arm = [j for j, joint in enumerate(body.joints) if joint.startswith("right_arm")]

            def off(attempt: Attempt, angles: FloatArray = seen.angles, arm: list[int] = arm) -> float:
                return rmse_deg(attempt.truth[:, 0][:, arm], angles[:, arm])

            act = partial(imitate, movement=seen.movement, rng=np.random.default_rng(0))  # nothing is drawn
            for who in WHO:
                counting, line = CountingOn(other if who == "babbled with it" else mind), RecursiveLine(mind)
                one = born if who == "babbled with it" else body
                for attempt in range(ATTEMPTS):
                    [done] = act(
                        one,
                        mind=counting.mind,
                        inverse=line if "line" in who else None,
                        witness=partial(getattr, one, "joint_angles"),
                        heed=counting,
                    )
                    errors[who][learner, d, attempt] = off(done)
                    if who == "line counts on":
                        line.count(*counting.count())
                    elif who == "counts on":
                        counting.count(1.0 if attempt else KEEP)
            report((learner + (d + 1) / len(config.demonstrations)) / config.learners)
    return errors
