"""The body image: where one's parts are seen to point in a posture, P(direction | its joints), learned by looking.

Law, per part with the n senses that move it (organ identification), each on its own axis with middle c_j:

    E[direction | q] = W' phi(q),   phi(q) = kron_j (1, sin(q_j - c_j), 1 - cos(q_j - c_j)),
    direction ~ N(E, (s^2 + s^2 phi' A^-1 phi) I),   A = phi-Gram + s^2 I

3^n numbers per coordinate. A sense that turns something about an axis enters a direction through its sine and cosine
and nothing else, and turns within turns multiply: with this table of harmonics a body of hinges is met exactly and
experience in one posture speaks for all others, so that noise averages away over everything ever seen (a local fit to
the nearest postures keeps most of it). Which axis, how long a limb, what hangs from what: all of that is W, learned.
The prior W ~ N(0, I) is the only smoothing; s is the seeing noise that remains (`babbling.regression`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from babbling.axes import BoolArray, FloatArray, IntArray
from babbling.body import OfOneBody
from babbling.errors import BabblingError
from babbling.kinds import Numbers, kind
from babbling.mirroring import MirrorExperience
from babbling.organs import Organs
from babbling.regression import Regression

MOST_JOINTS = 6
"""A part keeps this many senses, those that tell most about it: 3^6 harmonics."""
AVERAGED = 5
"""Ticks averaged before they are summed; the law is linear in phi and direction, so nothing is lost but time."""
LEAST_VARIANCE = 1e-9
COMFORT = 1.2
"""rad: how far from rest is still comfortable, a Gaussian of this width."""


@dataclass(frozen=True)
class PartImage:
    """One part: its senses (ascending), their middles, W, and the seeing noise s, rad per axis."""

    joints: Annotated[IntArray, Numbers(".joint", low=0, index="factor")]
    centre: Annotated[FloatArray, Numbers(".joint", "rad")]
    weights: Annotated[FloatArray, Numbers(".harmonic coordinate:3")]
    """(3 ** joints, 3) products of harmonics, the first joint's slowest; coordinates last."""
    noise: Annotated[float, Numbers(unit="rad", low=0)]

    def __post_init__(self) -> None:
        count = len(self.joints)
        if count > MOST_JOINTS or len(self.weights) != 3**count or (np.diff(self.joints) <= 0).any():
            raise BabblingError(f"a part of {count} joints and {len(self.weights)} harmonics; n ascending ones and 3^n")

    def expected(self, postures: FloatArray) -> FloatArray:
        """(N, 3) E[direction | posture] at (N, F) postures; not quite unit vectors."""
        return self.slope(postures, self.joints[:0])[0]

    def slope(self, postures: FloatArray, along: IntArray) -> tuple[FloatArray, FloatArray]:
        """(N, 3) expected directions and (N, 3, len(along)) derivatives by those factors."""
        values: dict[int, FloatArray] = {-1: self.weights.reshape(1, -1)}
        harmonics = _harmonics(postures[:, self.joints] - self.centre)
        for joint, basis, rate in zip(self.joints.tolist(), *harmonics, strict=True):
            turned = {which: _contracted(value, basis) for which, value in values.items()}
            if joint in along:
                turned[joint] = _contracted(values[-1], rate)
            values = turned
        slope = np.zeros((len(postures), 3, len(along)))
        for place, joint in enumerate(along.tolist()):
            if joint in values:
                slope[:, :, place] = values[joint]
        return values[-1], slope


@dataclass(frozen=True)
class Image:
    """Where all parts of a body of F posture senses point, learned or known, and the postures one may take."""

    images: Annotated[Mapping[str, PartImage], Numbers("part")]
    low: Annotated[FloatArray, Numbers("factor", "rad")]
    """(F,) least reading of the posture senses."""
    high: Annotated[FloatArray, Numbers("factor", "rad")]
    """(F,) greatest."""
    rest: Annotated[FloatArray, Numbers("factor", "rad")]
    """(F,) posture it rests in: comfortable."""
    library: Annotated[FloatArray, Numbers("posture factor", "rad")]
    """(K, F) postures to choose from: the discrete actions of Eq. (1)."""
    doubt: Annotated[FloatArray, Numbers("posture part", "rad2", low=0)]
    """(K, P) variance of each part's direction in these postures, rad^2: noise, and what is not known yet."""

    @property
    def parts(self) -> tuple[str, ...]:
        """P names."""
        return tuple(self.images)

    @property
    def moves(self) -> BoolArray:
        """(P, F) which sense moves which part, as far as its image goes."""
        return np.array([np.isin(np.arange(len(self.low)), one.joints) for one in self.images.values()])

    def expected(self, postures: FloatArray) -> FloatArray:
        """(N, P, 3) unit vectors that should be seen at (N, F) postures."""
        found = np.stack([one.expected(postures) for one in self.images.values()], 1)
        return np.asarray(found / np.linalg.norm(found, axis=-1, keepdims=True))


@kind("body image", "`imitate correspondence` leaves such files")
@dataclass(frozen=True)
class BodyImage(Image, OfOneBody):
    """An image learned in front of a mirror, from postures that were babbled, and how it came about."""

    fingerprint: str
    """Of the body that looked; see `babbling.body.Body`."""
    organs: Organs
    minutes: Annotated[float, Numbers(unit="min", low=0, high=1e6)]
    """Body time in front of the mirror."""


LIBRARY = 200


def learn_image(
    experience: MirrorExperience,
    organs: Organs,
    low: FloatArray,
    high: FloatArray,
    rest: FloatArray,
    seed: int,
    fingerprint: str,
) -> BodyImage:
    """Body image of a mirror babble.

    Args:
        experience: what was felt and seen.
        organs: what moves what.
        low, high: (F,) ranges of the posture senses.
        rest: (F,) posture of rest.
        seed: which postures are remembered for choosing.
        fingerprint: of the body that looked.

    Raises:
        BabblingError: less experience than there are harmonics to learn.
    """
    q, seen = experience.postures, experience.directions
    flat = q.reshape(-1, q.shape[-1])
    rng = np.random.default_rng([seed, 0x32])
    library = flat[rng.choice(len(flat), min(LIBRARY, len(flat)), replace=False)]
    images: dict[str, PartImage] = {}
    doubt = np.empty((len(library), len(experience.parts)))
    for number, part in enumerate(experience.parts):
        told = np.where(organs.moves[number], 1 + organs.information[number], 0)
        order = np.argsort(-told, kind="stable")
        joints = np.sort(order[: min(MOST_JOINTS, int(organs.moves[number].sum()))])
        images[part], doubt[:, number] = _learned(part, q, seen[:, :, number], joints, (low + high) / 2, library)
    return BodyImage(images, low, high, rest.copy(), library, doubt, fingerprint, organs, experience.minutes)


def _learned(
    part: str, q: FloatArray, seen: FloatArray, joints: IntArray, middle: FloatArray, library: FloatArray
) -> tuple[PartImage, FloatArray]:
    """Sums over (T, B) moments and the posterior of W; and (K,) doubt."""
    size = 3 ** len(joints)
    ticks = len(q) // AVERAGED * AVERAGED
    if ticks // AVERAGED * q.shape[1] < 2 * size**0.5:
        raise BabblingError(f"the {part} was seen too shortly to learn from; babble longer in front of the mirror")
    sums = Regression(1, size, 3)
    for start in range(0, ticks, 10 * AVERAGED):
        block = slice(start, min(start + 10 * AVERAGED, ticks))
        phi = harmonic_products(q[block].reshape(-1, q.shape[-1])[:, joints] - middle[joints])
        phi = phi.reshape(-1, AVERAGED, q.shape[1], size).mean(1).reshape(-1, 1, size)
        sums.observe(phi, seen[block].reshape(-1, AVERAGED, q.shape[1], 3).mean(1).reshape(-1, 1, 3))
    fit, variance = sums.fit_with_noise(prior=1.0, least=LEAST_VARIANCE)
    variance *= AVERAGED
    image = PartImage(joints, middle[joints], fit.coefficients[0].T.copy(), float(variance**0.5))
    unknown = fit.doubt(harmonic_products(library[:, joints] - middle[joints])[:, None])[:, 0]
    return image, variance * (1 + unknown / AVERAGED)


def _harmonics(away: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(n, N, 3) harmonics of (N, n) angles from the middle, joint by joint, and their derivatives."""
    sine, cosine, one = np.sin(away.T), np.cos(away.T), np.ones_like(away.T)
    return np.stack([one, sine, 1 - cosine], -1), np.stack([0 * one, cosine, sine], -1)


def harmonic_products(away: FloatArray) -> FloatArray:
    """(N, 3^n) phi of (N, n) angles from the middle, the first joint's slowest."""
    phi = np.ones((len(away), 1))
    for basis in _harmonics(away)[0]:
        phi = (phi[:, :, None] * basis[:, None, :]).reshape(len(away), -1)
    return phi


def _contracted(value: FloatArray, basis: FloatArray) -> FloatArray:
    """Sum over the first harmonic axis: (1 or N, 3 R) with (N, 3) gives (N, R)."""
    if len(value) == 1:
        return np.asarray(basis @ value.reshape(3, -1))
    parts = value.reshape(len(basis), 3, -1)
    return np.asarray(np.matmul(basis[:, None, :], parts)[:, 0])
