"""Twenty individuals on their feet: faster and faster, pushed, on slopes, laden; beside other ways to stand."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from babbling.axes import FloatArray
from babbling.balance import Balance
from babbling.mind import Mind
from experiments.gesture.options import Config
from experiments.gesture.standing_shows import resting, squat
from experiments.shared.standing import PUSH_S, Performance, Reflex, paced, perform, shove, standing_of
from experiments.shared.watching import Seen, watch
from imitation.acting.balancing import Balancer
from imitation.acting.movement import Movement
from models.body import SimulatedBody
from models.standing import Individuals, StandingBody

SPEEDS, SEEDS, FIRST = (1.0, 1.5, 2.0, 2.5), 20, 1
BUILT_IN = ("icub-reach", "human-raise", "g1-squat", "romeo-bow", "talos-salute")
GAINS = [(kp, kd) for kp in (0.01, 0.02, 0.04, 0.08) for kd in (0.0, 0.002, 0.005, 0.01)]
"""Of the ankle's PD, rad per unit of pressure and of its change per second; the best on `TRIED` is kept."""
TRIED, PD_LIMIT, PD_SMOOTH = "icub-reach", np.deg2rad(15.0), 0.7
IMPULSES = np.arange(0.8, 3.7, 0.4)
ANGLES = np.arange(8) * np.pi / 4
PUSHED_AT_S, PUSHED_FOR_S = 2.0, 4.0
LADEN_KG = 0.3


class Study:
    """One mind, many bodies."""

    def __init__(self, config: Config, mind: Mind, hung: SimulatedBody, balance: Balance) -> None:
        self.config, self.mind, self.hung, self.balance = config, mind, hung, balance
        ours = Balancer(balance, config.balance_weight)
        self.ways: dict[str, tuple[Balancer, bool]] = {
            "ours": (ours, False), "linear": (Balancer(balance, linear=True), False), "replay": (ours, True),
            "pd": (Balancer(balance, 0.0), False),
        }  # fmt: skip
        self.gains = np.array([GAINS[0]])
        reach = self.moved(watch(TRIED, hung).angles, 2.0)
        body = self.bodies(len(GAINS) * 2)
        self.gains = np.repeat(GAINS, 2, 0)
        done = self.perform(body, reach, "pd")
        lasted = done.upright.sum(0).reshape(len(GAINS), 2).sum(1)
        still = np.abs(balance.pressed(done.loads)).mean((0, 2)).reshape(len(GAINS), 2).sum(1)
        self.gains = np.array([GAINS[int(np.lexsort((still, -lasted))[0])]])

    def bodies(self, copies: int, **how: Any) -> StandingBody:
        """Individuals that never learned."""
        return standing_of(self.config, copies, FIRST, **how)

    def moved(self, angles: FloatArray, speed: float) -> Movement:
        """Joint angles so many times as fast."""
        return paced(angles, speed, self.hung)

    def pd(self, tick_s: float) -> Reflex:
        """An ankle that answers pressure and its change, at `gains` (1 or B, 2)."""
        past: list[FloatArray] = []

        def reflex(number: int, loads: FloatArray, gyro: FloatArray) -> FloatArray:
            felt = self.balance.pressed(loads)
            smooth = felt if not past else PD_SMOOTH * past[-1] + (1 - PD_SMOOTH) * felt
            change = (smooth - past[-1]) / tick_s if past else np.zeros_like(felt)
            past.append(smooth)
            gains = self.gains[:, :, None]
            return np.asarray(np.clip(-gains[:, 0] * smooth - gains[:, 1] * change, -PD_LIMIT, PD_LIMIT))

        return reflex

    def perform(
        self, body: StandingBody, movement: Movement, who: str, push: Callable[[float], FloatArray] | None = None
    ) -> Performance:
        """Everybody does the same movement in one of the ways."""
        balancer, replay = self.ways[who]
        reflex = self.pd(body.tick_s) if who == "pd" else None
        return perform(body, self.hung, self.mind, movement, balancer, replay=replay, reflex=reflex, push=push)

    def impulses(self, movement: Movement, who: str, at_s: float) -> list[float]:
        """(8,) N s in each direction that half of the runs survive: pushes of all sizes, one individual each."""
        direction, size = (grid.ravel() for grid in np.meshgrid(ANGLES, IMPULSES, indexing="ij"))
        force = np.stack([np.cos(direction), np.sin(direction), 0 * direction], 1) * size[:, None] / PUSH_S
        done = self.perform(self.bodies(len(size)), movement, who, shove(force, at_s))
        step = IMPULSES[1] - IMPULSES[0]
        survived = (~done.fell).reshape(len(ANGLES), len(IMPULSES)).sum(1)
        return [float(s) for s in IMPULSES[0] - step + step * survived]


def study(
    config: Config, mind: Mind, hung: SimulatedBody, balance: Balance, seen: Seen, report: Callable[[float], None]
) -> dict[str, Any]:
    """The study's part of metrics.json: `falls` and `runs` by way and speed, `falls_by_clip`, `hardships`, and
    `push_impulse_ns` in eight directions."""
    judge = Study(config, mind, hung, balance)
    clips: Mapping[str, FloatArray] = {clip: watch(clip, hung).angles for clip in config.clips or BUILT_IN}
    falls = {who: {f"{speed:g}": 0 for speed in SPEEDS} for who in judge.ways}
    by_clip: dict[str, dict[str, dict[str, int]]] = {who: {clip: {} for clip in clips} for who in judge.ways}
    total, done = len(judge.ways) * len(SPEEDS) * len(clips) + 14, 0

    def tell() -> None:
        nonlocal done
        done += 1
        report(done / total)

    for clip, angles in clips.items():
        for speed in SPEEDS:
            for who in judge.ways:
                fell = int(judge.perform(judge.bodies(SEEDS), judge.moved(angles, speed), who).fell.sum())
                falls[who][f"{speed:g}"] += fell
                by_clip[who][clip][f"{speed:g}"] = fell
                tell()
    first = next(iter(clips.values()))
    hard: dict[str, dict[str, int]] = {name: {} for name in HARDSHIPS}
    for name, how in HARDSHIPS.items():
        for who in ("ours", "linear"):
            body = judge.bodies(SEEDS, **how)
            if name == "laden":
                for hand in ("left_hand", "right_hand"):
                    body.carry(LADEN_KG, hand)
            hard[name][who] = int(judge.perform(body, judge.moved(first, 1.0), who).fell.sum())
        tell()
    hard["squat"] = {
        who: int(judge.perform(judge.bodies(SEEDS), judge.moved(squat(hung), 1.0), who).fell.sum())
        for who in ("ours", "linear")
    }
    tell()
    still = np.repeat(resting(hung)[None], round(PUSHED_FOR_S / hung.tick_s), 0)
    moving = first[: round(PUSHED_FOR_S / hung.tick_s)]
    pushes: dict[str, dict[str, list[float]]] = {"moving": {}, "at rest": {}}
    for who in ("ours", "replay", "pd"):
        pushes["moving"][who] = judge.impulses(judge.moved(moving, 1.0), who, PUSHED_AT_S)
        pushes["at rest"][who] = judge.impulses(judge.moved(still, 1.0), who, PUSHED_AT_S)
        tell()
    return {
        "falls": falls,
        "runs": {who: {f"{speed:g}": SEEDS * len(clips) for speed in SPEEDS} for who in judge.ways},
        "falls_by_clip": by_clip,
        "hardships": hard,
        "hardship_runs": SEEDS,
        "push_impulse_ns": pushes,
        "pd_gains": judge.gains[0].tolist(),
    }


HARDSHIPS: Mapping[str, Mapping[str, Any]] = {
    "downhill 4 deg": {"tilt_deg": (4.0, 0.0)},
    "uphill 4 deg": {"tilt_deg": (-4.0, 0.0)},
    "across 4 deg": {"tilt_deg": (0.0, 4.0)},
    "friction 0.5": {"individuals": Individuals(friction=(0.5, 0.5))},
    "masses 20 % off": {"individuals": Individuals(masses=0.2)},
    "laden": {},
}
