"""Environments of Gymnasium and of dm_control as bodies.

They are asked for the bounds of their actions, to start again and to step; rewards are not looked at. A mind that
learns postures (`babbling.pilot`) wants motors that ask for them: environments with position servos, joints felt.
"""

import hashlib
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from models.arrays import FloatArray
from models.errors import BodyError, unknown
from models.senses import Channel, Senses

LOOK_TICKS, HELD_TICKS = 600, 30
"""How long a look for the ranges of senses takes, and how long each of its commands is held at most."""
MARGIN = 0.1
"""Share of what was met then that a range is wider, either way."""
PARTS = (
    "body_mass", "body_inertia", "body_pos", "jnt_axis", "jnt_range", "dof_damping", "dof_armature",
    "actuator_gainprm", "actuator_biasprm", "actuator_ctrlrange",
)  # fmt: skip
"""What MuJoCo models that feel different differ in."""


class EnvironmentBody:
    """Several environments of one kind, a copy each; see `babbling.body.Body`.

    An environment has `action_space`, `reset(seed=)` and `step` as Gymnasium has them, with vectors in a `Box`; or
    `action_spec`, `reset` and `step` as dm_control has them. An episode that ends while the body acts is an error:
    nothing that follows is a consequence of its commands. Time limits of Gymnasium are passed over (`truncated`).

    Args:
        environments: one for each copy, each an object of its own.
        tick_s: duration of a step, where the environment does not say.
        feel: names of dm_control's observations that are felt, in this order; none named is all.
        sense_low: (S,) least readings; where they are neither given nor said by the environment they are what a look
            about by the first copy meets (random commands, each held), and a tenth less.
        sense_high: (S,) greatest readings, likewise.
        seed: of where copies start: the same every time, until `reseed`.

    Raises:
        BodyError: no environments, one twice, unlike ones; actions or observations that are no bounded vectors; an
            unknown tick; an episode that ends during the look.
    """

    def __init__(
        self,
        environments: Sequence[Any],
        *,
        tick_s: float | None = None,
        feel: Sequence[str] = (),
        sense_low: ArrayLike | None = None,
        sense_high: ArrayLike | None = None,
        seed: int = 0,
    ) -> None:
        if not environments or len({id(one) for one in environments}) < len(environments):
            raise BodyError(f"{len(environments)} environments: at least one is needed, and each copy needs its own")
        self._copies: list[_Copy] = [
            _Control(one, feel) if hasattr(one, "action_spec") else _Gymnasium(one) for one in environments
        ]
        first, self._seed, self.time = self._copies[0], seed, 0.0
        self.name = first.name
        self.motor_low, self.motor_high = first.motors
        tick = first.tick_s if tick_s is None else tick_s
        if tick is None or not 0 < tick < np.inf:
            raise BodyError(f"{self.name}: a step of {tick} s; say how long one takes: tick_s=0.02")
        self.tick_s = float(tick)
        if not np.isfinite(first.motors).all() or not (self.motor_low < self.motor_high).all():
            raise BodyError(f"{self.name}: its actions have no finite bounds; rescale them, such as to [-1, 1]")
        for other in self._copies[1:]:
            if (other.name, other.labels) != (first.name, first.labels) or not np.array_equal(
                other.motors, first.motors
            ):
                raise BodyError(f"{self.name} beside {other.name}: all copies must be of one kind")
        self.reseed(0)
        low, high = first.senses
        low = low if sense_low is None else np.array(np.broadcast_to(sense_low, low.shape), float)
        high = high if sense_high is None else np.array(np.broadcast_to(sense_high, high.shape), float)
        if not np.isfinite([low, high]).all():
            met = self._look()
            room = MARGIN * np.maximum(np.ptp(met, axis=0), 1e-3)
            low = np.where(np.isfinite(low), low, met.min(0) - room)
            high = np.where(np.isfinite(high), high, met.max(0) + room)
        self.senses = Senses([Channel("observation", "reading", "1", first.labels, low, high)])
        self.sense_low, self.sense_high = self.senses.low, self.senses.high
        digest = hashlib.sha256(f"{self.name} {self.tick_s} {first.labels}".encode())
        for array in (*first.motors, *(getattr(first.model, part) for part in PARTS if hasattr(first.model, part))):
            digest.update(np.ascontiguousarray(array, float).tobytes())
        self.fingerprint = digest.hexdigest()[:16]

    @property
    def copies(self) -> int:
        """B, how many environments there are."""
        return len(self._copies)

    def reseed(self, episode: int) -> None:
        """Where copies start from here on depends on the body's seed and this number alone."""
        self._seeds = np.random.default_rng([self._seed, 0xE2F1, episode]).integers(0, 2**31, self.copies)

    def reset(self) -> FloatArray:
        """All copies start again, each from its own seed; returns (B, S) sensations."""
        self.time = 0.0
        return self._felt([one.start(int(seed)) for one, seed in zip(self._copies, self._seeds, strict=True)])

    def act(self, motors: FloatArray) -> FloatArray:
        """(B, M) actions, cut to their bounds, for one step; returns (B, S) sensations.

        Raises:
            BodyError: a command or a sensation is not a number, or an episode ended.
        """
        if not np.isfinite(motors).all():
            raise BodyError(f"{self.name}: a motor command is not a number at {self.time:.2f} s")
        self.time += self.tick_s
        actions = np.clip(motors, self.motor_low, self.motor_high)
        return self._felt([self._step(one, action) for one, action in zip(self._copies, actions, strict=True)])

    def _step(self, one: "_Copy", action: FloatArray) -> FloatArray:
        felt = one.step(action)
        if felt is None:
            raise BodyError(f"{self.name}: its episode ended after {self.time:.2f} s; a body lives on: {one.lasting}")
        return felt

    def _felt(self, copies: Sequence[FloatArray]) -> FloatArray:
        senses = np.array(copies, float)
        if not np.isfinite(senses).all():
            raise BodyError(f"{self.name}: a sensation is not a number at {self.time:.2f} s")
        return senses

    def _look(self) -> FloatArray:
        """(T, S) what the first copy meets while it does this and that."""
        first, rng = self._copies[0], np.random.default_rng([self._seed, 0x100C])
        met, action, until = [first.start(int(self._seeds[0]))], self.motor_low, 0
        for tick in range(LOOK_TICKS):
            if tick == until:
                action, until = rng.uniform(self.motor_low, self.motor_high), tick + int(rng.integers(1, HELD_TICKS))
            self.time = tick * self.tick_s
            met.append(self._step(first, action))
        return self._felt(met)


class _Copy(ABC):
    """One environment, whoever made it."""

    name: str
    tick_s: float | None
    motors: tuple[FloatArray, FloatArray]
    senses: tuple[FloatArray, FloatArray]
    labels: tuple[str, ...]
    """(S,) one for each sense."""
    model: Any
    """MuJoCo's, or nothing."""
    lasting: str
    """How to make one whose episodes do not end."""

    @abstractmethod
    def start(self, seed: int) -> FloatArray:
        """(S,) sensations of a new episode."""

    @abstractmethod
    def step(self, action: FloatArray) -> FloatArray | None:
        """(S,) sensations, or None where the episode ended."""


class _Gymnasium(_Copy):
    lasting = "make it with an option such as terminate_when_unhealthy=False"

    def __init__(self, environment: Any) -> None:
        self.environment, whole, spec = environment, environment.unwrapped, getattr(environment, "spec", None)
        self.name = str(spec.id if spec else type(whole).__qualname__)
        self.tick_s, self.model = getattr(whole, "dt", None), getattr(whole, "model", None)
        self.motors = self._ends("action", "continuous actions, all in one vector")
        self.senses = self._ends("observation", "neither a dict nor an image; wrap it, as FlattenObservation does")
        self.labels = tuple(f"observation {number}" for number in range(len(self.senses[0])))

    def _ends(self, what: str, possible: str) -> tuple[FloatArray, FloatArray]:
        space = getattr(self.environment, f"{what}_space")
        if not hasattr(space, "low") or len(space.shape) != 1 or np.dtype(space.dtype).kind != "f":
            raise BodyError(f"{self.name}: its {what} space is {str(space)[:100]}; a Box of one row of real numbers is "
                            f"possible: {possible}")  # fmt: skip
        return np.asarray(space.low, float), np.asarray(space.high, float)

    def start(self, seed: int) -> FloatArray:
        return np.asarray(self.environment.reset(seed=seed)[0], float)

    def step(self, action: FloatArray) -> FloatArray | None:
        felt, _, terminated, _, _ = self.environment.step(action.astype(self.environment.action_space.dtype))
        return None if terminated else np.asarray(felt, float)


class _Control(_Copy):
    lasting = "load it with time_limit=float('inf')"

    def __init__(self, environment: Any, feel: Sequence[str]) -> None:
        self.environment, task, spec = environment, getattr(environment, "task", None), environment.action_spec()
        self.name = type(task or environment).__qualname__
        self.tick_s = float(environment.control_timestep())
        self.model = getattr(getattr(environment, "physics", None), "model", None)
        if len(getattr(spec, "shape", ())) != 1 or not hasattr(spec, "minimum") or np.dtype(spec.dtype).kind != "f":
            raise BodyError(
                f"{self.name}: its actions are {str(spec)[:100]}; a bounded vector of real numbers is possible"
            )
        low, high = (np.array(np.broadcast_to(end, spec.shape), float) for end in (spec.minimum, spec.maximum))
        self.motors, specs = (low, high), environment.observation_spec()
        for name in feel:
            if name not in specs:
                raise BodyError(unknown(f"observation of {self.name}", name, specs))
        self.feel = tuple(feel or specs)
        for name in self.feel:
            if np.dtype(specs[name].dtype).kind not in "fib" or len(specs[name].shape) > 2:
                raise BodyError(f"{self.name}: observation {name!r} is {str(specs[name])[:100]}; name those that are "
                                f"felt and are vectors of numbers: feel=[...] of {', '.join(specs)}")  # fmt: skip
        sizes = {name: int(np.prod(specs[name].shape)) for name in self.feel}
        self.labels = tuple(f"{name} {number}" for name, size in sizes.items() for number in range(size))
        self.senses = (np.full(len(self.labels), -np.inf), np.full(len(self.labels), np.inf))
        self.random = getattr(task, "random", None) or getattr(environment, "random_state", None)

    def start(self, seed: int) -> FloatArray:
        if self.random is not None:
            self.random.seed(seed)
        return self._felt(self.environment.reset())

    def step(self, action: FloatArray) -> FloatArray | None:
        step = self.environment.step(action)
        return None if step.last() else self._felt(step)

    def _felt(self, step: Any) -> FloatArray:
        return np.concatenate([np.ravel(step.observation[name]) for name in self.feel]).astype(float)
