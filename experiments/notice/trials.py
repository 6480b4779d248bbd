"""Bodies that change while they imitate, and what of it is noticed."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from babbling.axes import FloatArray, IntArray
from babbling.mind import Mind
from experiments.notice.options import Config
from experiments.shared.judging import interval_95
from experiments.shared.minds import body_of
from imitation.acting.loop import Info, State, imitate
from imitation.acting.movement import Movement, together
from imitation.acting.noticing import LAGS, Alarm, Normal, Run
from imitation.acting.rehearsal import made_up_movement
from imitation.inference.moving import MovingInverse
from models.body import SimulatedBody
from models.hoap2.facts import PAYLOAD

KINDS = {"jam": "a motor jams", "carry": f"a hand takes up {1000 * PAYLOAD:g} g", "swap": "two wires are swapped"}
SIDES = ("left", "right")
COPIES, CASE_S, IN_TIME_S = 16, 3.0, 0.5
MOVES = np.deg2rad(1.0)
"""A joint that is asked for less within `IN_TIME_S` may jam unnoticed: it is not drawn."""
REHEARSING, HEALTHY, CHANGING = 0, 1, 2


class Heard(NamedTuple):
    """A run, T ticks with the approach, and the peer's: how far off each posture felt."""

    run: Run
    off: FloatArray
    """(T, 1, B, F) rad."""
    angles: FloatArray
    """(T, J) true ones of copy 0, for those who judge."""


@dataclass(frozen=True)
class Changed:
    """Cases of one kind: (T, B, F) surprise by way, and what was to be noticed."""

    surprise: dict[str, FloatArray]
    whole: dict[str, FloatArray]
    """(T, B)."""
    at: IntArray
    """(B,) tick before which the body changed."""
    joints: list[set[int]]
    """Joints that may be named."""
    named: int
    """How many are to be named."""
    heard: Heard


def movements(body: SimulatedBody, mind: Mind, config: Config, use: int, copies: int, seconds: float) -> Movement:
    """Everybody makes up another one."""
    rngs = (np.random.default_rng([config.seed, 20, use, copy]) for copy in range(copies))
    return together([made_up_movement(body, mind, rng, seconds) for rng in rngs])


def listen(
    body: SimulatedBody,
    movement: Movement,
    mind: Mind,
    inverse: MovingInverse | None,
    change: Callable[[int], None] = lambda tick: None,
) -> Heard:
    """Imitate; `change` is told of every tick of the movement before it is done, the approach below 0."""
    rows, schema, angles = [], mind.pilot.schema, []

    def heed(state: State, senses: FloatArray, info: Info) -> None:
        off = np.abs(senses[:, schema.posture] - state.targets[state.tick])
        rows.append((info.missed, info.believed[..., 1], info.commands, off[None]))
        angles.append(body.joint_angles[0].copy())
        change(len(movement.senses) - state.left)

    imitate(body, movement, mind, inverse=inverse, rng=np.random.default_rng(0), heed=heed)
    missed, rate, command, off = map(np.stack, zip(*rows, strict=True))
    return Heard(Run(missed, rate, command), off, np.stack(angles))


@dataclass(frozen=True)
class Senses:
    """One that listens for changes: by its evidence, or, the simplest way, by how far off it feels."""

    normal: Normal
    off: Alarm
    usual_off: FloatArray
    """(F,) root mean square."""

    @classmethod
    def rehearsed(cls, heard: Heard, tick_s: float) -> "Senses":
        """By what a rehearsal was like."""
        usual = np.sqrt((heard.off**2).mean((0, 1, 2)))
        return cls(Normal.found(heard.run, tick_s), Alarm.found(heard.off / usual, tick_s), usual)

    def surprise(self, heard: Heard, *, by_error: bool = False) -> tuple[FloatArray, FloatArray]:
        """(T, B, F) of joints and (T, B) of the body."""
        if by_error:
            alarm, found = self.off, self.off.surprise(heard.off / self.usual_off)
        else:
            alarm = self.normal.alarm
            found = np.pad(alarm.surprise(self.normal.sizes(heard.run)), ((LAGS, 0), (0, 0), (0, 0)))
        return found, alarm.whole(found)


def cases(body: SimulatedBody, movement: Movement, mind: Mind, kind: str, config: Config) -> tuple[Any, ...]:
    """What happens to whom and when: (B,) ticks, the deeds, and which joints (factors) may be named."""
    rng = np.random.default_rng([config.seed, 21, [*KINDS].index(kind)])
    labels = [body.sense_labels[line] for line in mind.pilot.schema.posture]
    goals, soon = movement.postures(mind.pilot.schema), round(IN_TIME_S / body.tick_s)
    at = rng.integers(soon, len(goals) - soon, body.copies)
    deeds: list[Callable[[], None]] = []
    joints: list[set[int]] = []
    for copy, tick in enumerate(at):
        alone = np.array([copy])
        if kind == "jam":
            moving = np.flatnonzero(np.ptp(goals[tick : tick + soon, copy], axis=0) > MOVES)
            joint = int(rng.choice(moving)) if len(moving) else 0
            deeds.append(lambda joint=joint, alone=alone: body.jam(labels[joint], alone))  # type: ignore[misc]
            joints.append({joint})
        elif kind == "carry":
            side = SIDES[rng.integers(2)]
            deeds.append(lambda side=side, alone=alone: body.carry(PAYLOAD, f"{side}_hand", alone))  # type: ignore[misc]
            joints.append({f for f, label in enumerate(labels) if label.startswith(f"{side}_arm")})
        else:
            one, two = (int(line) for line in rng.choice(len(labels), 2, replace=False))
            deeds.append(lambda one=one, two=two, alone=alone: body.rewire(one, two, alone))  # type: ignore[misc]
            joints.append({one, two})
    return at, deeds, joints


def changed(mind: Mind, ways: dict[str, tuple[MovingInverse | None, Senses]], kind: str, config: Config) -> Changed:
    """All cases of one kind at once, a copy each, in every way."""
    surprise, whole = dict[str, FloatArray](), dict[str, FloatArray]()
    for way, (inverse, senses) in ways.items():
        body = body_of(config, config.cases, stream=30)
        movement = movements(body, mind, config, CHANGING, config.cases, CASE_S)
        at, deeds, joints = cases(body, movement, mind, kind, config)

        def change(tick: int, at: IntArray = at, deeds: Any = deeds) -> None:
            for copy in np.flatnonzero(at == tick):
                deeds[copy]()

        heard = listen(body, movement, mind, inverse, change)
        surprise[way], whole[way] = senses.surprise(heard)
        if inverse is None:
            first = heard
            surprise["error"], whole["error"] = senses.surprise(heard, by_error=True)
    lead = len(first.off) - len(movement.senses)
    return Changed(surprise, whole, at + lead, joints, 2 if kind == "swap" else 1, first)


def judge(done: Changed, way: str, limit: float, tick_s: float) -> dict[str, Any]:
    """How many were noticed in time and how soon, and how often the right joints had surprised most by then."""
    soon, copies = round(IN_TIME_S / tick_s), np.arange(len(done.at))
    window = done.at[:, None] + 1 + np.arange(soon)
    over = done.whole[way][window, copies[:, None]] > limit
    early = (done.whole[way][done.at, copies] > limit).sum()
    hit, delay = over.any(1), tick_s * (1 + over.argmax(1))
    most = done.surprise[way][window, copies[:, None]].max(1)
    named = [set(np.argsort(-most[c])[: done.named]) <= done.joints[c] for c in copies]
    count = int(hit.sum())
    return {
        "noticed": count / len(hit),
        "noticed_95": interval_95(count, len(hit)),
        "delay_median": float(np.median(delay[hit])) if count else None,
        "delay_95": float(np.quantile(delay[hit], 0.95)) if count else None,
        "named_right": float(np.mean(named)),
        "already_alarmed": int(early),
    }


def alarms(whole: FloatArray, limit: float, tick_s: float) -> int:
    """How often (T, B) surprises come to exceed the limit; what follows within a second is the same alarm."""
    over, quiet = whole > limit, round(1 / tick_s)
    return sum(int(1 + (np.diff(np.flatnonzero(one)) > quiet).sum()) for one in over.T if one.any())
