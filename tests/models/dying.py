"""What a native reader may do to a process, as work for a trial."""

import os
import signal
import time
from pathlib import Path

import pinocchio as pin

from models.errors import BodyError


def crash(path: Path) -> None:
    os.kill(os.getpid(), signal.SIGSEGV)


def abort(path: Path) -> None:
    os.abort()


def wait(path: Path) -> None:
    time.sleep(1000)


def spin(path: Path) -> None:
    while True:
        pass


def eat(path: Path) -> None:
    eaten = []
    while True:
        eaten.append(bytearray(b"x" * (1 << 24)))
        time.sleep(0.005)


def reserve(path: Path) -> None:
    bytearray(1 << 36)


def talk(path: Path) -> None:
    for stream in (1, 2):
        os.write(stream, b"native words\n" * 1000)
    raise BodyError(f"{path}: no\nbody")


def stumble(path: Path) -> None:
    raise KeyError("what")


def well(path: Path) -> None:
    print("fine")


def parse(path: Path) -> None:
    pin.buildModelFromXML(path.read_text())
