"""A body without physics behind wires that nobody knows: servos that go a share of the way each tick."""

import numpy as np

from babbling.axes import FloatArray

TICK = 0.02


class Plant:
    """Servos that go a share of the way each tick, behind permuted, flipped, scaled lines; one may be dead."""

    def __init__(self, seed: int, motors: int = 5, copies: int = 6, dead: int | None = None, size: float = 1.0) -> None:
        rng = np.random.default_rng(seed)
        self.drives = rng.permutation(motors)
        """Motor line of each servo."""
        self.lines = rng.permutation(2 * motors)
        """Which of (angles, speeds) stands on each sense line."""
        self.gain = np.exp(rng.uniform(np.log(0.5), np.log(2), motors)) * rng.choice([-1.0, 1.0], motors) * size
        self.offset = rng.uniform(-0.2, 0.2, motors) * size
        self.copies, self.tick_s, self.fingerprint, self.dead = copies, TICK, "plant", dead
        self.motor_low, self.motor_high = -np.ones(motors), np.ones(motors)
        reach = np.concatenate([np.abs(self.gain) + 0.2 * size, np.full(motors, 5.0 * size)])
        self.sense_low, self.sense_high = -reach[self.lines], reach[self.lines]

    def reset(self) -> FloatArray:
        self.q = np.zeros((self.copies, len(self.drives)))
        self.v = np.zeros_like(self.q)
        return self.feel()

    def act(self, motors: FloatArray) -> FloatArray:
        wanted = self.gain * motors[:, self.drives] + self.offset
        if self.dead is not None:
            wanted[:, self.drives == self.dead] = 0
        step = 0.3 * (wanted - self.q)
        self.q, self.v = self.q + step, step / TICK
        return self.feel()

    def feel(self) -> FloatArray:
        return np.concatenate([self.q, self.v], 1)[:, self.lines]

    def sense_of(self, which: FloatArray) -> FloatArray:
        """Sense line on which angle (0 .. M - 1) or speed (M ..) number `which` stands."""
        return np.argsort(self.lines)[which]
