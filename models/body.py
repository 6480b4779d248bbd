"""A simulated body: many copies of one MJCF on `mujoco.batch`, motor lines in, sense lines out.

The mind on the other side sees a motor vector in [-1, 1]^M and a sense vector, and nothing else. Senses are those of
servo drives, for every motor its joint's angle (an encoder that counts pulses) and its speed (the drive's tachometer),
and what sensors of the MJCF are asked for by name (touch, gyro, accelerometer ...).
"""

from collections.abc import Mapping, Sequence

import mujoco
import mujoco.batch
import numpy as np
from numpy.typing import NDArray

from models.arrays import FloatArray, IntArray
from models.errors import BodyError, unknown
from models.fingerprints import fingerprint
from models.hush import unheard
from models.senses import Channel, Senses, numeric, sensor_channels
from models.servos import PULLS, Gains, driven, posed, position, reach, resting
from models.units import SHOWN
from models.wear import Wear, ball_radius
from models.wiring import Wiring

JAMMED = 1e9
"""Damping of a jammed gear, N m s/rad: 9 N m turn it by less than a pulse of an encoder in an hour."""
SLIDES_PER_S = 2.0
"""Ranges of a slide that its motor crosses in a second, about as HOAP-2's turn."""
EVERY = slice(None)


class SimulatedBody:
    """`copies` bodies of one compiled model, stepped together; see `babbling.body.Body` for what it offers.

    Args:
        model: compiled MJCF whose actuators are position servos on single joints (see `models.loading`). It rests at
            the keyframe `home`, or in the zero posture.
        copies: how many bodies.
        threads: worker threads (results do not depend on it).
        tick_s: control tick; an integer number of physics steps.
        noise: standard deviation of the angle sense, rad (m of what slides), one or (M,). The speed sense gets
            sqrt(2) noise / tick_s, as if the drive differenced two such readings.
        wear: worn gears.
        motors: joints whose motors it has, in that order; none named is all. The rest holds still at home.
        sensors: names of the model's <sensor> elements that are felt too; see `models.senses.sensor_channels`.
        scramble: seed of an unknown wiring, or None for straight.
        scramble_senses: whether it permutes the senses too.
        seed: randomness of the sensor noise.

    Raises:
        BodyError: a control tick that is no whole number of physics steps, or a motor or sensor that the model lacks.
    """

    def __init__(
        self,
        model: mujoco.MjModel,
        *,
        name: str,
        copies: int = 1,
        threads: int = 2,
        tick_s: float = 0.02,
        noise: FloatArray | float = 0.0,
        wear: Wear | None = None,
        motors: Sequence[str] = (),
        sensors: Sequence[str] = (),
        scramble: int | None = None,
        scramble_senses: bool = True,
        seed: int = 0,
    ) -> None:
        self.name, self.tick_s = name, tick_s
        self.wear = wear or Wear()
        steps = tick_s / model.opt.timestep
        self.substeps = round(steps)
        if abs(steps - self.substeps) > 1e-9 or self.substeps < 1:
            raise BodyError(
                f"{name}: a control tick of {tick_s:g} s is {steps:g} physics steps of {model.opt.timestep:g} s; "
                "it must be a whole number"
            )
        self.model = model
        model.dof_frictionloss[:] *= self.wear.friction_factor
        pulls = np.flatnonzero(np.isin(model.actuator_trntype, PULLS))  # all but what palms hold with
        known = {one.name: one for one in (driven(model, int(i), name) for i in pulls)}
        names = [*known]
        for motor in motors:
            if motor not in names:
                raise BodyError(unknown("joint with a motor", motor, names))
        self.joints = tuple(motors or names)
        self.actuators = pulls[[names.index(joint) for joint in self.joints]]
        self.moved = tuple(known[joint] for joint in self.joints)
        self.units = tuple(one.unit for one in self.moved)
        self.shown_units = tuple(SHOWN[unit][0] for unit in self.units)
        self.shown_scale = np.array([SHOWN[unit][1] for unit in self.units])
        """(M,) what one rad or m is in those, which people read."""
        both, paces = (" or ".join(sorted({unit + per for unit in self.units}, reverse=True)) for per in ("", "/s"))
        joints = [one.joints[0] for one in self.moved]
        self._qpos, self._dof = model.jnt_qposadr[joints], model.jnt_dofadr[joints]
        self._tendons = [(m, [*one.joints], [*one.shares]) for m, one in enumerate(self.moved) if len(one.joints) > 1]
        self.joint_range: FloatArray = np.array([reach(model, one) for one in self.moved])
        control: FloatArray = model.actuator_ctrlrange[self.actuators]
        self._low, self._high = control.T.copy()
        self._centre, self._half = control.mean(1), (control[:, 1] - control[:, 0]) / 2
        self._key = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_KEY, "home")
        held, self._held = [position(model, one, resting(model)) for one in known.values()], np.zeros(model.nu)
        self._held[pulls] = np.clip(held, *model.actuator_ctrlrange[pulls].T)
        low, high = self.joint_range.T
        turns, pulses = numeric(model, "speed_limit", 5.0), numeric(model, "encoder_pulses_per_degree", 0.0)
        speed = np.where([unit == "m" for unit in self.units], SLIDES_PER_S * (high - low), turns)
        self._sensors = sensor_channels(model, sensors)
        self._stage = int(mujoco.mjtStage.mjSTAGE_ACC if self._sensors else mujoco.mjtStage.mjSTAGE_NONE)
        shaken = np.sqrt(2) * noise / tick_s
        channels = (
            Channel("angle", "angle", both, self.joints, low, high, noise=noise, pulses=float(np.rad2deg(pulses))),
            Channel("speed", "speed", paces, self.joints, -speed, speed, (), shaken, suffix="speed"),
            *(channel for channel, _ in self._sensors),
        )
        count, felt = len(self.joints), len(Senses(channels))
        self.wiring = Wiring.of(count, felt, scramble, senses_too=scramble_senses)
        self.senses = Senses(channels, self.wiring.sense)
        self.sense_low, self.sense_high = self.senses.low, self.senses.high
        self.sense_labels = self.senses.labels  # for people only
        self.motor_labels = tuple(self.joints[j] for j in np.argsort(self.wiring.motor))
        self.motor_low, self.motor_high = -np.ones(count), np.ones(count)
        self.batch = mujoco.batch.Batch(model, copies, threads)
        self._played = np.zeros((len(self.wear.backlash), copies, count))
        self._plugs = np.tile(np.arange(count), (copies, 1))
        self._seed = seed
        self.reseed(0)
        self.time = 0.0
        self.fingerprint = fingerprint(model, self.wear, self.wiring, tick_s, (*motors, *sensors))
        self.given: Mapping[str, Gains] = {}
        """Servos that its file did not give it, by joint; see `models.servos`."""
        self.reset()

    @property
    def copies(self) -> int:
        """B, how many bodies there are."""
        return int(self.batch.nsim)

    def reseed(self, episode: int) -> None:
        """Make the sensor noise from here on depend on the body's seed and this number alone."""
        self._rng = np.random.default_rng([self._seed, 0xB0D7, episode])

    def reset(self) -> FloatArray:
        """All copies to the rest posture, their servos holding it; returns (B, S) sensations."""
        with unheard():
            self.batch.reset(keyframe=self._key)
        if self._key < 0:
            self.batch.ctrl[:] = self._held
        if self._sensors:
            self.batch.forward()
        self._played[:] = self.batch.ctrl[:, self.actuators]
        self.time = 0.0
        return self._feel()

    def act(self, motors: FloatArray) -> FloatArray:
        """Hold (B, M) motor lines for one tick; returns (B, S) sensations.

        Raises:
            BodyError: the physics became unstable (which joint, when) or a command is not a number.
        """
        if not np.isfinite(motors).all():
            raise BodyError(f"{self.name}: a motor command is not a number at {self.time:.2f} s")
        command = self.commands(np.take_along_axis(np.asarray(motors, float), self._plugs, 1))
        self.batch.ctrl[:, self.actuators] = self.wear.follow(self._played, command, self._low, self._high)
        warnings = self.batch.warning[..., 1].copy()
        with unheard():  # `_check` raises instead
            self.batch.step(ids=self._awake(), nstep=self.substeps, stage=self._stage)
        self.time += self.tick_s
        self._check(self.batch.warning[..., 1] - warnings)
        return self._feel()

    def jam(self, joint: str, copies: slice | IntArray = EVERY) -> None:
        """The gear of this joint locks where it is, in these copies, whatever is commanded (until `mend`).

        What happens to a body while it lives leaves its fingerprint and `reset` as they are: it is still the body that
        babbled, and a jammed joint is jammed at home after a reset.

        Raises:
            BodyError: it has no motor on such a joint.
        """
        if joint not in self.joints:
            raise BodyError(unknown("joint with a motor", joint, self.joints))
        for dof in self.model.jnt_dofadr[list(self.moved[self.joints.index(joint)].joints)]:
            self.batch.expand("dof_damping")[copies, dof] = JAMMED
            self.batch.qvel[copies, dof] = 0

    def carry(self, kg: float, body: str, copies: slice | IntArray = EVERY) -> None:
        """From now on this body of the model holds a steel ball of so many kg at its centre of mass; 0 drops it.

        Raises:
            BodyError: no such body, or a mass below 0.
        """
        bodies = [self.model.body(i).name for i in range(self.model.nbody)]
        if body not in bodies or not 0 <= kg < np.inf:
            raise BodyError(f"{self.name}: {kg:g} kg on {body!r}: 0 kg or more, on one of {', '.join(bodies[1:])}")
        part = bodies.index(body)
        for field, more in (("body_mass", kg), ("body_inertia", 0.4 * kg * ball_radius(kg) ** 2)):
            self.batch.expand(field)[copies, part] = self._born(field)[copies, part] + more
        self.batch.set_const()

    def rewire(self, first: int, second: int, copies: slice | IntArray = EVERY) -> None:
        """Two motor lines change places; `commands` and `command_angles` still speak of the old wiring.

        Raises:
            BodyError: no such motor lines.
        """
        if not {first, second} <= set(range(len(self.joints))):
            raise BodyError(f"{self.name}: motor lines {first} and {second} of 0 to {len(self.joints) - 1}")
        plugs = self._plugs[copies]
        plugs[:, [first, second]] = plugs[:, [second, first]]
        self._plugs[copies] = plugs

    def mend(self) -> None:
        """Nothing is jammed, carried or rewired any more; postures stay as they are."""
        self._plugs[:] = np.arange(len(self.joints))
        for name in ("dof_damping", "body_mass", "body_inertia"):
            self.batch.expand(name)[:] = self._born(name)
        self.batch.set_const()

    def _awake(self) -> IntArray | None:
        """Copies to be stepped; None is all of them."""
        return None

    def _born(self, field: str) -> FloatArray:
        """(B, ...) numbers of the copies' models as they were made."""
        whole: FloatArray = getattr(self.model, field)
        return np.broadcast_to(whole, (self.copies, *whole.shape))

    def commands(self, motors: FloatArray) -> FloatArray:
        """(..., M) motor lines as angles asked of the servos (before any play of their gears)."""
        return np.asarray(self._centre + self._half * self.wiring.fractions(motors))

    @property
    def joint_angles(self) -> FloatArray:
        """(B, M) true angles of the joints, in the model's order; for those who judge, not for the mind."""
        return self._read(self.batch.qpos, self._qpos, self.model.jnt_qposadr)

    @property
    def joint_speeds(self) -> FloatArray:
        """(B, M) their true speeds, likewise."""
        return self._read(self.batch.qvel, self._dof, self.model.jnt_dofadr)

    def _read(self, of: FloatArray, firsts: IntArray, places: IntArray) -> FloatArray:
        found: FloatArray = of[:, firsts]
        for m, joints, shares in self._tendons:
            found[:, m] = of[:, places[joints]] @ shares
        return found

    def configurations(self, angles: FloatArray) -> FloatArray:
        """(T, nq) configurations of the model with these (T, M) joint angles, all else at rest: to draw it."""
        return posed(self.model, self.moved, resting(self.model), angles)

    def command_angles(self, angles: FloatArray) -> FloatArray:
        """Motor lines that command these joint angles (..., M): what a replay that knows the wiring sends."""
        return self.wiring.lines(np.clip((angles - self._centre) / self._half, -1, 1))

    def sensations(self, angles: FloatArray) -> FloatArray:
        """(..., S) sense lines as they would read at joint angles (..., M); all else is NaN (not seen)."""
        return self.senses.vector({"angle": angles})

    @property
    def truth(self) -> FloatArray:
        """(B, S) what senses without noise, in parts of a pulse, would read now; for those who judge."""
        return self.senses.vector(self._true())

    def _true(self) -> dict[str, FloatArray]:
        true = {"angle": self.joint_angles, "speed": self.joint_speeds}
        return true | {channel.name: self.batch.sensordata[:, columns] for channel, columns in self._sensors}

    def _feel(self) -> FloatArray:
        return self.senses.vector({n: self.senses[n].measured(true, self._rng) for n, true in self._true().items()})

    def _check(self, warnings: NDArray[np.int32]) -> None:
        """(B, kinds) warnings that the last tick added."""
        if not warnings.any() and np.isfinite(self.batch.qpos).all():
            return
        raise BodyError(
            f"{self.name}: the physics became unstable at joint {self._suspect(warnings)!r} after {self.time:.2f} s; "
            "lower its actuator's gain, raise its damping or armature, or take a smaller timestep"
        )

    def _suspect(self, warnings: NDArray[np.int32]) -> str:
        """The joint whose servo is too stiff for the timestep, otherwise the one that MuJoCo names.

        An explicit step of dt is stable while kp dt^2 / inertia < 4; MuJoCo names the first joint that went wrong,
        and one servo that is too stiff shakes them all.
        """
        stiffness = self.model.actuator_gainprm[self.actuators, 0] * self.model.dof_invweight0[self._dof]
        stiffness = stiffness * self.model.opt.timestep**2
        if stiffness.max() > 1 or not warnings.any():
            return self.joints[int(np.argmax(stiffness))]
        copy, kind = np.argwhere(warnings > 0)[0]
        place = int(self.batch.warning[copy, kind, 0])
        if kind == mujoco.mjtWarning.mjWARN_BADQPOS:
            joint = int(np.searchsorted(self.model.jnt_qposadr, place, side="right")) - 1
        else:
            joint = int(self.model.dof_jntid[min(place, self.model.nv - 1)])
        return self.model.joint(joint).name or f"joint {joint}"
