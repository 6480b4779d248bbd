"""A robot of metal behind `babbling.body.Body`: all that a mind needs to babble with it and to imitate."""

from typing import Protocol

import numpy as np

from babbling.axes import FloatArray


class Bus(Protocol):
    """What drives two servos: a serial line, or a simulation of one."""

    def write(self, angles: FloatArray) -> None:
        """Ask for (2,) angles, rad."""

    def read(self) -> FloatArray:
        """(4,) angles, rad, then speeds, rad/s."""

    def wait(self, seconds: float) -> None:
        """Until so long after the last time: `time.sleep(max(0, next - time.monotonic()))` on a real line."""


class SerialArm:
    """Commands are angles within the ends; senses are what the servos read. One copy, in real time."""

    copies, tick_s, fingerprint = 1, 0.02, "the arm on the bench, gripper off"
    motor_low, motor_high = np.array([-1.5, -1.0]), np.array([1.5, 1.0])
    sense_low, sense_high = np.array([-1.5, -1.0, -4, -4]), np.array([1.5, 1.0, 4, 4])

    def __init__(self, bus: Bus) -> None:
        self.bus = bus

    def reset(self) -> FloatArray:
        """Home, slowly, and a second of rest."""
        away = self._feel()[:, :2]
        for share in (*np.linspace(1, 0, 100), *np.zeros(50)):
            self.act(share * away)
        return self._feel()

    def act(self, motors: FloatArray) -> FloatArray:
        """(1, 2) angles, for one tick; returns the (1, 4) senses."""
        self.bus.write(np.clip(motors[0], self.motor_low, self.motor_high))
        self.bus.wait(self.tick_s)
        return self._feel()

    def _feel(self) -> FloatArray:
        return np.array([self.bus.read()], float)
