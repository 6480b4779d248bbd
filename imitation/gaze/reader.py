"""Following gaze: what somebody looks at, by Eq. (2), with one's own forward model as the other's ("like me").

To look at a thing that appears at (u, v) I would turn so: that is Eq. (1) on my own forward model. Were my head where
the other's is, each thing would appear elsewhere: perspective taking is the correspondence (chapter, 3.2). So for every
thing k that could be the goal my own inverse model says how the other would turn its head, and

    P(g_k | pose) = c P(pose | g_k) P(g_k)                                    (Eq. (2); the pose is the action seen)
    P(pose | g_k) = N(pose; the pose of Eq. (1) for thing k, C).

C and the place in the other's head that it looks from are learned where the goal is shown afterwards (the toy is taken
up). P(g) is salience, which experience with this teacher overrules (`Preferences`); and whether a head that turns looks
at all is learned from one's own eyes (`EyeLore`).
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import least_squares

from babbling.axes import Axis, FloatArray
from babbling.forward_model import ForwardModel
from imitation.errors import ImitationError
from imitation.gaze.fixation import Fixation
from imitation.inference.bayes import Posterior, goal_posterior
from imitation.seeing.stereo import Geometry

COVERS = ("eyes free", "eyes covered")
SEES = ("sees", "does not see")
LAPSE, ANYWHERE = 0.02, 0.7
"""Share of the time that a head points at nothing that is seen (it rests, it passes by), and the density of such poses:
uniform over a radian and a half of pan and a radian of tilt, 1/rad^2."""
LEAST_SHOWN = 12
MOST_FITTED = 60
"""Shown goals needed before anything can be learned from them."""


def facing(places: FloatArray, other: FloatArray) -> FloatArray:
    """(..., 3) places as they would be from (3,) where somebody sits who faces us: moved, and turned half around."""
    return np.asarray((places - other) * (-1.0, -1.0, 1.0))


@dataclass(frozen=True)
class GazeReader:
    """Poses of another's head to goals.

    Args:
        fixations: one's own Eq. (1), for the left and for the right eye.
        geometry: how places appear.
        tilt: the posture of one's own neck from which looking is imagined, rad.
        origin: (3,) from the middle of the face to where gaze comes from, in the other's frame (learned).
        bias: (2,) rad, what poses are beside expectation (learned).
        covariance: (2, 2) rad^2 (learned).
    """

    fixations: tuple[Fixation, Fixation]
    geometry: Geometry
    tilt: float
    origin: FloatArray = field(default_factory=lambda: np.zeros(3))
    bias: FloatArray = field(default_factory=lambda: np.zeros(2))
    covariance: FloatArray = field(default_factory=lambda: np.diag([0.1, 0.1]) ** 2)

    def imagined(self, places: FloatArray, head: FloatArray, origin: FloatArray | None = None) -> FloatArray:
        """(N, 2) poses with which I would look at (N, 3) places, were my eyes in the other's head at (3,): the posture
        that carries things along u first, then that along v."""
        offset = self.origin if origin is None else origin
        mine = facing(places, head) - offset
        things = self.geometry.appear(mine, self.tilt)
        movers = self.fixations[0].mind.pilot.movers
        posture = np.tile(np.array([0.0, self.tilt])[np.argsort(movers)], (len(things), 1))
        rng = np.random.default_rng(0)  # the mean of Eq. (1)'s posterior asks nothing of it
        turns = [fixation.choose(things, posture, rng).change for fixation in self.fixations]
        return np.asarray((posture + (turns[0] + turns[1]) / 2)[:, movers])

    def learned(self, places: FloatArray, pose: FloatArray, head: FloatArray) -> "GazeReader":
        """With origin, bias and covariance from trials whose goals, at (N, 3) places, were shown afterwards: (N, 2)
        poses of a head whose face is at (3,) when at rest; places as located.

        Raises:
            ImitationError: too few of them.
        """
        if len(pose) < LEAST_SHOWN:
            raise ImitationError(f"{len(pose)} shown goals; {LEAST_SHOWN} are needed to learn what gaze means")

        def away(x: FloatArray) -> FloatArray:
            rest = pose[:MOST_FITTED] - self.imagined(places[:MOST_FITTED], head, x)
            return np.asarray(np.clip(rest, -0.5, 0.5).ravel())

        found = least_squares(away, self.origin, loss="soft_l1", f_scale=0.06, diff_step=0.02, x_scale=0.3, max_nfev=12)
        rest = pose - self.imagined(places, head, found.x)
        kept = np.abs(rest - np.median(rest, 0)).max(1) < 0.4
        rest = rest[kept]
        return GazeReader(
            self.fixations, self.geometry, self.tilt, found.x, rest.mean(0), np.cov(rest.T) * (1 + 5 / len(rest))
        )

    def expected(self, places: FloatArray, head: FloatArray) -> FloatArray:
        """(N, 2) poses of one who looks at (N, 3) places with the face at (3,): one's own, and what others' are beside
        them."""
        return np.asarray(self.imagined(places, head) + self.bias)

    def like_me(self, pose: FloatArray, expected: FloatArray) -> FloatArray:
        """(G,) P(pose | g_k) density: how one who wanted to look there would hold the head, of (G, 2) `expected`."""
        away = pose - expected
        distance = np.einsum("gi,ij,gj->g", away, np.linalg.inv(self.covariance), away)
        scale = 2 * np.pi * np.sqrt(np.linalg.det(self.covariance))
        return np.asarray(np.exp(-distance / 2) / scale)

    def read(self, pose: FloatArray, expected: FloatArray, prior: FloatArray, sees: float = 1.0) -> Posterior:
        """Eq. (2): P(g | pose) over things of (G, 2) `expected` poses; with probability 1 - `sees` the pose has nothing
        to do with them."""
        meant = (1.0 - LAPSE) * self.like_me(pose, expected) + LAPSE * ANYWHERE
        level = meant @ prior
        action_prior = sees * meant + (1.0 - sees) * level
        return goal_posterior(np.ones(1), action_prior, prior)


class Preferences:
    """P(g) of one teacher: Dirichlet counts of what it was seen to look at, salience where nothing is known yet."""

    def __init__(self, strength: float = 4.0) -> None:
        self.strength = strength
        self.counts: dict[str, float] = {}

    def prior(self, labels: tuple[str, ...], salience: FloatArray) -> FloatArray:
        """(G,) P(g_k) = (n_k + strength s_k) / sum, with s the share of salience."""
        share = salience / salience.sum()
        weight = np.array([self.counts.get(label, 0.0) for label in labels]) + self.strength * share
        return np.asarray(weight / weight.sum())

    def observe(self, labels: tuple[str, ...], probability: FloatArray) -> None:
        """Count a trial softly: each thing by the probability that it was the goal."""
        for label, p in zip(labels, probability, strict=True):
            self.counts[label] = self.counts.get(label, 0.0) + float(p)


class EyeLore:
    """P(sees | eyes free or covered): a forward model with two contexts, learned by looking with one's own eyes.

    Where nothing was ever tried (one's eyes have never been covered) the row has no evidence: the belief is then that
    of all looking there was, and the answer says so.
    """

    def __init__(self) -> None:
        self.forward_model = ForwardModel(
            (Axis.categorical("cover", COVERS),), Axis.categorical("act", ("look",)), Axis.categorical("outcome", SEES)
        )

    def experience(self, covered: bool, saw: bool, times: int = 1) -> None:
        """Having looked so often, eyes covered or free, and seen something or nothing."""
        column = np.ones((times, 1))
        self.forward_model.observe((column * float(covered),), column * 0.0, column * float(not saw))

    def sees(self, covered: bool) -> tuple[float, bool]:
        """P(sees | cover), and whether there was any experience of it; one pseudo-count from all looking there was.

        Raises:
            ImitationError: nobody ever looked at anything.
        """
        visits = self.forward_model.counts[0, :, 0] / self.forward_model.unit  # (cover, outcome)
        total = visits.sum()
        if not total > 0:
            raise ImitationError("these eyes have never looked at anything; nothing is known about eyes")
        general = (visits.sum(0)[0] + 0.5) / (total + 1.0)
        row = visits[int(covered)]
        return float((row[0] + general) / (row.sum() + 1.0)), bool(row.sum() > 0)
