"""Two hundred single acts of all teachers: which part was that, and how often must one try until it looks right?"""

from dataclasses import dataclass, replace

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.mirroring import angles_between
from experiments.shared.mirrors import Pupil
from imitation.correspondence.organ import identify
from imitation.correspondence.tries import try_again
from models.mirror import Mirror
from models.teachers.acts import movable, single_act
from models.teachers.robots import ROBOTS


@dataclass(frozen=True)
class Acts:
    """truth, said: (A,) part numbers, -1 for nothing; errors_deg (A', tries + 1): how far off the right part points,
    before any try and after each, in acts whose part was identified; parts: names by number."""

    parts: tuple[str, ...]
    truth: IntArray
    said: IntArray
    errors_deg: FloatArray

    @property
    def rate(self) -> float:
        """Share of acts put to the right part."""
        return float(np.mean(self.truth == self.said))


def act_study(pupil: Pupil, count: int, tries: int, seed: int) -> Acts:
    """Random robots, random parts, random postures; the imitator starts its tries at rest."""
    rng = np.random.default_rng([seed, 17])
    image, mirror = pupil.image, Mirror(pupil.body)
    calm = replace(pupil, noise_deg=pupil.noise_deg / 3)
    truth, said, errors = [], [], []
    for number in range(count):
        robot = list(ROBOTS)[number % len(ROBOTS)]
        able = [part for part in movable(robot) if part in image.parts]
        part = able[int(rng.integers(len(able)))]
        seen = single_act(robot, part, rng).directions
        shown = np.stack([seen.get(name, np.full_like(seen[part], np.nan)) for name in image.parts], 1)
        organ = identify(image.organs, pupil.look(shown, rng), pupil.body.tick_s)
        truth.append(image.parts.index(part))
        said.append(organ.part)
        if organ.part == truth[-1]:
            wanted = shown[-1, organ.part]

            def look(posture: FloatArray, which: int = organ.part) -> FloatArray:
                return pupil.look(mirror.shown(pupil.angles(posture[None]))[0, which], rng)

            eye = calm.look(wanted, rng)  # it holds still at the end: ten frames make one good look
            tried = try_again(image, organ.part, eye, image.rest, look, tries, rng)
            shows = mirror.shown(pupil.angles(tried))[:, organ.part]
            errors.append(angles_between(shows, wanted))
    table = np.rad2deg(errors).reshape(-1, tries + 1)
    return Acts(image.parts, np.array(truth), np.array(said), table)
