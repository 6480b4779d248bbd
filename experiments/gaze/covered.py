"""Teachers with covered eyes, imitators with and without experience of covered eyes of their own."""

from collections.abc import Callable
from itertools import cycle, islice
from typing import Any

import numpy as np

from babbling.axes import Axis
from experiments.gaze.infer import infer
from experiments.gaze.trials import TOYS, Trials, Watcher, run_trials
from experiments.shared.judging import Verdict, alike, difference, interval_95, oftener, within
from imitation.gaze.reader import EyeLore
from imitation.inference.selection import select_matching
from imitation.seeing.finding import Finder
from models.biclops.cloth import through_cloth
from models.retina import Image
from models.seeing_body import SeeingBody

LOOKS = 12
"""Looks through each cloth, and 200 without any: a baby looks all day."""
OPEN_LOOKS = 200
MARGIN = 0.19
"""Rates that differ by less are alike: the difference that 32 infants a group (Meltzoff and Brooks 2008) would have had
one chance in three of telling from none, (1.96 - .43) sqrt(2 / 4 / 32) ("small telescopes", Simonsohn 2015)."""
Z90 = 1.6448536269514722
"""Standard errors to either side of a 90 % interval."""
AGES = {"12 months": (), "14 and 18 months": ("opaque",)}
"""What has lain over an infant's eyes by itself: nothing yet, or blankets and its own hands."""
TRAINING = {"before": None, "after an opaque blindfold": "opaque", "after a see-through one": "see_through"}


def own_experience(
    lore: EyeLore, kind: str | None, images: list[Image], noise: float, rng: np.random.Generator
) -> None:
    """Look at toys through a cloth over one's own eyes (None: with free eyes); whether one sees is seen, not told."""
    find = Finder(TOYS)
    toys = [(image, there) for image in images if (there := np.isfinite(find(image)[:, 0]).sum())]
    for image, there in islice(cycle(toys), OPEN_LOOKS if kind is None else LOOKS):
        saw = there if kind is None else np.isfinite(find(through_cloth(image, kind, noise, rng))[:, 0]).sum()
        lore.experience(covered=kind is not None, saw=bool(2 * saw >= there))


def covered_eyes(
    body: SeeingBody, who: Watcher, count: int, rng: np.random.Generator, report: Callable[[float], None]
) -> dict[str, Any]:
    """How often gaze is followed: by age, own experience and cloth; populations that choose by probability matching."""
    faces = {"blindfold": run_trials(body, who, count, rng, cloth="blindfold", report=lambda done: report(done / 2))}
    faces["headband"] = run_trials(body, who, count, rng, cloth="headband", report=lambda done: report((1 + done) / 2))
    views = [pair[0] for pair in body.images]
    rates: dict[str, Any] = {}
    for age, lived in AGES.items():
        for training, kind in TRAINING.items():
            lore = EyeLore()
            own_experience(lore, None, views, who.config.noise, rng)
            for cover in (*lived, *((kind,) if kind else ())):
                own_experience(lore, cover, views, who.config.noise, rng)
            rates[f"{age}, {training}"] = {c: _followed(who, trials, lore, rng) for c, trials in faces.items()}
    before12, before18 = rates["12 months, before"], rates["14 and 18 months, before"]
    opaque12 = rates["12 months, after an opaque blindfold"]
    through18 = rates["14 and 18 months, after a see-through one"]
    blind, free = ((before12[cloth]["hits"], count) for cloth in ("blindfold", "headband"))
    (gap, error), apart = difference(blind, free), alike(blind, free, MARGIN)
    ends = gap - Z90 * error, gap + Z90 * error
    signs = {
        "12 months: blindfold and headband alike": within(*ends, count, MARGIN),
        "14 and 18 months: headband above blindfold": _above(before18["headband"], before18["blindfold"]),
        "12 months: less after an opaque blindfold": _above(before12["blindfold"], opaque12["blindfold"]),
        "18 months: more after a see-through one": _above(through18["blindfold"], before18["blindfold"]),
    }
    return {
        "equivalence": {"margin": MARGIN, "p": apart, "interval_90": ends},
        "rates": rates,
        "chance": 1 / len(TOYS),
        "signs": {name: verdict.numbers for name, verdict in signs.items()},
    }


def _followed(who: Watcher, trials: Trials, lore: EyeLore, rng: np.random.Generator) -> dict[str, Any]:
    sees = np.where(trials.eyes_seen, lore.sees(False)[0], lore.sees(True)[0])
    looked = select_matching(infer(who, trials, TOYS, sees=sees), Axis.categorical("toy", TOYS), rng)
    hits, n = int((looked == trials.target).sum()), len(looked)
    return {
        "rate": hits / n,
        "hits": hits,
        "interval_95": interval_95(hits, n),
        "n": n,
        "believed_to_see": float(np.median(sees)),
    }


def _above(one: dict[str, Any], other: dict[str, Any]) -> Verdict:
    return oftener((one["hits"], one["n"]), (other["hits"], other["n"]))
