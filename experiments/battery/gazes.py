"""Stage two, head and gaze: eyes learn what their saccades do; then somebody turns to a toy."""

from collections.abc import Iterator, Sequence

import numpy as np

from babbling.axes import FloatArray
from experiments.battery.acting import chances
from experiments.battery.films import OFF, Camera, following
from experiments.battery.life import Life
from experiments.battery.table import IMITATOR, WHOLE, Trial, joined
from experiments.gaze.covered import AGES, TRAINING, own_experience
from experiments.gaze.infer import infer
from experiments.gaze.options import Config
from experiments.gaze.scene import episode
from experiments.gaze.trials import COPIES, TOYS, lesson_for_gaze, run_trials, shown, table_body
from experiments.shared.caregiver import TURN_S
from experiments.shared.eyes import learn_to_look, nursery
from imitation.gaze.reader import EyeLore

HEADS, LESSONS = 4, 60
"""Copies that babble saccades at once. Looks at a caregiver who repeats one's posture."""
COUNT = COPIES
"""Trials of each cloth."""
CLOTHS = {"open": None, "blindfold": "blindfold", "headband": "headband"}
LIVES = {
    "12 months": ("12 months", "before"),
    "12 months, after an opaque blindfold": ("12 months", "after an opaque blindfold"),
    "18 months": ("14 and 18 months", "before"),
    "18 months, after a see-through one": ("14 and 18 months", "after a see-through one"),
}
"""Of those who follow: what has lain over their own eyes, by age and by training."""


def gazes(lives: Sequence[Life], camera: Camera = OFF) -> Iterator[Trial]:
    """Every age and training meets every cloth; of lives that began as the first."""
    life = lives[0]
    config = Config(robot="hoap2", seed=life.seed, aim_deg=life.how.aim_deg)
    eyes = learn_to_look(nursery(config, life.seed, HEADS), life.how.looking_minutes, life.seed)
    naive = lesson_for_gaze(config, eyes, LESSONS, life.seed, lambda share: None)
    body, rng = table_body(config, COPIES, 100 * life.seed + 11, TURN_S), life.rng(4)
    who = shown(naive, run_trials(body, naive, life.how.gaze_lessons, rng))
    camera.take("gaze-1", lambda: following(episode(who, None, 0, life.seed)))
    met = {cloth: run_trials(body, who, COUNT, rng, cloth=kind) for cloth, kind in CLOTHS.items()}
    views = [pair[0] for pair in body.images]
    lores = [EyeLore() for _ in LIVES]
    for lore, (age, training) in zip(lores, LIVES.values(), strict=True):
        own_experience(lore, None, views, config.noise, rng)
        for cover in (*AGES[age], *((TRAINING[training],) if TRAINING[training] else ())):
            own_experience(lore, cover, views, config.noise, rng)
    for number, (cloth, trials) in enumerate(met.items()):
        seen = [np.where(trials.eyes_seen, lore.sees(False)[0], lore.sees(True)[0]) for lore in lores]
        before, *beliefs = infer(who, trials, TOYS, sees=np.stack([np.zeros(COUNT), *seen]))  # first, salience alone
        for (place, name), belief in zip(enumerate(LIVES), beliefs, strict=True):
            for one in lives:
                what = one.rng(4, number, place), f"gaze, {cloth}", name
                yield from _followed(one, *what, belief, before, trials.target.tolist())


def _followed(
    life: Life,
    rng: np.random.Generator,
    task: str,
    name: str,
    beliefs: FloatArray,
    priors: FloatArray,
    targets: list[int],
) -> Iterator[Trial]:
    for number, (belief, prior, target) in enumerate(zip(beliefs, priors, targets, strict=True)):
        seen = np.flatnonzero(prior > 0)
        if not len(seen):
            continue
        there, now, before = [TOYS[k] for k in seen], belief[seen], prior[seen]
        fits = now / before
        looked = there[int(rng.choice(len(there), p=chances(fits, before, life.how)))]
        told = [joined(one) if len(there) > 1 else "" for one in (there, fits / fits.sum(), before)]
        yield Trial(
            life.agent, life.seed, WHOLE, IMITATOR, 2, task, name, number, looked, TOYS[target],
            float(looked == TOYS[target]), np.nan, "", *told,
        )  # fmt: skip
