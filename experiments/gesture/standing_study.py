"""Twenty individuals on their feet: faster and faster, pushed, on slopes, laden; beside other ways to stand."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import FloatArray
from babbling.balance import Balance
from babbling.mind import Mind
from experiments.gesture.options import Config
from experiments.gesture.standing_found import touches
from experiments.gesture.standing_shows import (
    SQUAT_DEG,
    STEPS,
    knees_deg,
    resting,
    shows,
    steps_on_the_spot,
    stood_on_one_leg,
)
from experiments.shared.judging import rmse_deg
from experiments.shared.minds import body_of
from experiments.shared.parallel import in_parallel
from experiments.shared.standing import PUSH_S, Performance, Reflex, paced, perform, shove, standing_of
from experiments.shared.watching import watch
from imitation.acting.balancing import Balancer
from models.body import SimulatedBody
from models.standing import Individuals

SPEEDS, SEEDS, FIRST = (1.0, 1.5, 2.0, 2.5), 20, 1
BUILT_IN = ("icub-reach", "human-raise", "g1-squat", "romeo-bow", "talos-salute")
GAINS = np.array([(kp, kd) for kp in (0.01, 0.02, 0.04, 0.08) for kd in (0.0, 0.002, 0.005, 0.01)])
"""Of the ankle's PD, rad per unit of pressure and of its change per second; the best on `TRIED` is kept."""
TRIED, PD_LIMIT, PD_SMOOTH = "icub-reach", np.deg2rad(15.0), 0.7
WAYS = ("ours", "blind", "linear", "replay", "pd", "both")
"""Eq. (1) and what stays of what is felt; Eq. (1) alone; the line of the same experience, feeling as well; sub-goals
simply sent, legs and all; an ankle that answers pressure; Eq. (1) and that ankle on top."""
IMPULSES = np.arange(0.8, 4.5, 0.4)
ANGLES = np.arange(8) * np.pi / 4
PUSHED_AT_S, PUSHED_FOR_S = 2.5, 4.0
PUSHED = ("ours", "blind", "replay", "pd")
HARDSHIPS: Mapping[str, Mapping[str, Any]] = {
    "downhill 4 deg": {"tilt_deg": (4.0, 0.0)},
    "uphill 4 deg": {"tilt_deg": (-4.0, 0.0)},
    "across 4 deg": {"tilt_deg": (0.0, 4.0)},
    "downhill 5.5 deg": {"tilt_deg": (5.5, 0.0)},
    "uphill 5.5 deg": {"tilt_deg": (-5.5, 0.0)},
    "friction 0.5": {"individuals": Individuals(friction=(0.5, 0.5))},
    "masses 20 % off": {"individuals": Individuals(masses=0.2)},
    "0.3 kg a hand": {"kg": 0.3},
    "0.6 kg a hand": {"kg": 0.6},
}
FACING, FACED_S = ("ours", "blind", "linear"), 12.0
"""Who does how much of the first demonstration there."""
ONCE = {"blind": 1.5, "both": 1.5}
"""Ways that are tried at one speed."""
SHOWN: Mapping[str, Callable[[Performance, SimulatedBody], FloatArray]] = {
    "squat": knees_deg,
    "left leg": lambda done, body: stood_on_one_leg(done, body.tick_s, "left"),
    "right leg": lambda done, body: stood_on_one_leg(done, body.tick_s, "right"),
    "walking on the spot": lambda done, body: steps_on_the_spot(done),
}
ENOUGH = {"squat": SQUAT_DEG, "left leg": 8.0, "right leg": 8.0, "walking on the spot": STEPS}
"""Degrees, seconds, steps."""


class Cell(NamedTuple):
    """What twenty individuals, or one for every push, do."""

    who: str
    show: str
    speed: float = 1.0
    hardship: str = ""
    pushed: bool = False


class Tried(NamedTuple):
    """How it went; B copies."""

    fell: list[bool]
    error_deg: list[float | None]
    """Of joints that do not carry, at ticks at which nothing touches."""
    touching: float
    """Share of ticks."""
    reached: list[float]
    """Of a show: degrees of knees, seconds on one leg, steps; 0 who fell."""


@dataclass(frozen=True)
class Study:
    """One mind, many bodies."""

    config: Config
    mind: Mind
    balance: Balance
    shows: Mapping[str, FloatArray]
    """(T, J) joint angles of everything that is done."""
    gains: FloatArray
    """(1 or B, 2) of the PD."""

    def reflex(self, tick_s: float) -> Reflex:
        """An ankle that answers pressure and its change."""
        past: list[FloatArray] = []

        def answer(number: int, loads: FloatArray, gyro: FloatArray) -> FloatArray:
            felt = self.balance.pressed(loads)
            smooth = felt if not past else PD_SMOOTH * past[-1] + (1 - PD_SMOOTH) * felt
            change = (smooth - past[-1]) / tick_s if past else np.zeros_like(felt)
            past[:] = [smooth]
            gains = self.gains[:, :, None]
            return np.asarray(np.clip(-gains[:, 0] * smooth - gains[:, 1] * change, -PD_LIMIT, PD_LIMIT))

        return answer

    def perform(self, cell: Cell, copies: int, push: Callable[[float], FloatArray] | None = None) -> Performance:
        """Individuals that never learned do what the cell says."""
        how = dict(HARDSHIPS.get(cell.hardship, {}))
        kg, hung, who = how.pop("kg", 0.0), body_of(self.config, 1, stream=3), cell.who
        body = standing_of(self.config, copies, FIRST, **how)
        for hand in ("left_hand", "right_hand") if kg else ():
            body.carry(kg, hand)
        movement = paced(self.shows[cell.show], cell.speed, hung)
        balancer = Balancer(self.balance, 0.0 if who == "pd" else self.config.balance_weight, linear=who == "linear")
        reflex = self.reflex(body.tick_s) if who in ("pd", "both") else None
        feels, replay = who in ("ours", "linear"), who == "replay"
        return perform(
            body, hung, self.mind, movement, balancer, replay=replay, feels=feels, reflex=reflex, push=push
        )  # fmt: skip


def prepared(config: Config, mind: Mind, balance: Balance, hung: SimulatedBody, own: FloatArray) -> Study:
    """All that is done, (T, J) `own` demonstration included; and the PD's best gains: who stands longest, and of those
    the stillest."""
    clips = {clip: watch(clip, hung, unit=config.unit).angles for clip in config.clips or BUILT_IN}
    done = {**clips, TRIED: watch(TRIED, hung).angles, **shows(hung), config.demonstration: own}
    done["at rest"] = np.repeat(resting(hung)[None], round((PUSHED_AT_S + PUSHED_FOR_S) / hung.tick_s), 0)
    done["begin"] = next(iter(clips.values()))[: round(FACED_S / hung.tick_s)]
    done["moving"] = next(iter(clips.values()))[: round((PUSHED_AT_S + PUSHED_FOR_S / 2) / hung.tick_s)]
    study = Study(replace(config, threads=1), mind, balance, done, GAINS[:1])
    each = replace(study, gains=np.repeat(GAINS, 2, 0))
    pd = each.perform(Cell("pd", TRIED, 2.0), 2 * len(GAINS))
    lasted = pd.upright.sum(0).reshape(-1, 2).sum(1)
    still = np.abs(balance.pressed(pd.loads)).mean((0, 2)).reshape(-1, 2).sum(1)
    return replace(study, gains=GAINS[[int(np.lexsort((still, -lasted))[0])]])


def tried(cell: Cell, study: Study) -> Tried:
    """Do it, judge it. Pushed, every copy gets another push: all directions, all sizes."""
    push, copies = None, SEEDS
    if cell.pushed:
        direction, size = (grid.ravel() for grid in np.meshgrid(ANGLES, IMPULSES, indexing="ij"))
        force = np.stack([np.cos(direction), np.sin(direction), 0 * direction], 1) * size[:, None] / PUSH_S
        push, copies = shove(force, PUSHED_AT_S), len(size)
    done = study.perform(cell, copies, push)
    fell, judge = done.fell.tolist(), standing_of(study.config, 1, 0)
    if cell.show in SHOWN:
        return Tried(fell, [], 0.0, SHOWN[cell.show](done, judge).tolist())
    if cell.pushed or cell.who != "ours" or cell.hardship or cell.speed != 1:
        return Tried(fell, [], 0.0, [])
    wanted = study.shows[cell.show]
    during = slice(done.first, done.first + len(wanted))
    labels = [judge.sense_labels[line] for line in study.mind.pilot.schema.posture]
    free = np.array([joint in labels and not study.balance.carries[labels.index(joint)] for joint in judge.joints])
    errors, touched = [], []
    for copy in range(copies):
        touching, ticks = touches(done, copy, during, judge)
        found = rmse_deg(done.angles[during, copy][ticks][:, free], wanted[ticks][:, free]) if ticks.any() else None
        errors.append(found)
        touched.append(touching.mean())
    return Tried(fell, errors, float(np.mean(touched)), [])


def study(whole: Study, workers: int) -> dict[str, Any]:
    """The study's part of metrics.json: `falls` and `runs` by way and speed, `falls_by_clip`, `hardships`,
    `joint_rmse_free_deg` by clip and individual, and `push_impulse_ns` in eight directions."""
    clips = whole.config.clips or BUILT_IN
    paces = {who: (ONCE[who],) if who in ONCE else SPEEDS for who in WAYS}
    cells = [Cell(who, clip, speed) for clip in clips for who in WAYS for speed in paces[who]]
    cells += [Cell(who, "begin", hardship=one) for one in HARDSHIPS for who in FACING]
    cells += [Cell(who, show) for show in SHOWN for who in FACING]
    cells += [Cell(who, when, pushed=True) for when in ("moving", "at rest") for who in PUSHED]
    found = in_parallel(partial(tried, study=whole), cells, workers, "twenty individuals")
    results = dict(zip(cells, found, strict=True))

    def fell(who: str, shows: Sequence[str], speed: float) -> int:
        return sum(sum(results[Cell(who, show, speed)].fell) for show in shows)

    return {
        "falls": {who: {f"{speed:g}": fell(who, clips, speed) for speed in paces[who]} for who in WAYS},
        "runs": {who: {f"{speed:g}": SEEDS * len(clips) for speed in paces[who]} for who in WAYS},
        "falls_by_clip": {
            who: {clip: {f"{speed:g}": fell(who, [clip], speed) for speed in paces[who]} for clip in clips}
            for who in WAYS
        },
        "joint_rmse_free_deg": {clip: results[Cell("ours", clip)].error_deg for clip in clips},
        "touching_share": {clip: results[Cell("ours", clip)].touching for clip in clips},
        "hardships": {
            one: {who: sum(results[Cell(who, "begin", hardship=one)].fell) for who in FACING} for one in HARDSHIPS
        },
        "shown": {show: {who: results[Cell(who, show)].reached for who in FACING} for show in SHOWN},
        "shown_enough": {
            show: {who: sum(one >= ENOUGH[show] for one in results[Cell(who, show)].reached) for who in FACING}
            for show in SHOWN
        },
        "hardship_runs": SEEDS,
        "push_impulse_ns": {
            when: {who: survived(results[Cell(who, when, pushed=True)].fell) for who in PUSHED}
            for when in ("moving", "at rest")
        },
        "pd_gains": whole.gains[0].tolist(),
    }


def survived(fell: Sequence[bool]) -> list[float]:
    """(8,) N s in each direction that half of the runs survive."""
    step = IMPULSES[1] - IMPULSES[0]
    stood = (~np.array(fell)).reshape(len(ANGLES), len(IMPULSES)).sum(1)
    return [float(impulse) for impulse in IMPULSES[0] - step + step * stood]
