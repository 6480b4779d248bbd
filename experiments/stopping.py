"""Being told to stop, and having the last word: light to load, for whoever is stopped while everything else loads."""

import os
import signal
import sys
import time

STOPS = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
PATIENCE_S, AGAIN_S = 3.0, 0.02
"""Until another signal counts: what was begun is being removed; and until one that got lost is raised anew."""
WORDS = "interrupted; results appear whole or not at all; `imitate babble` and long studies go on when repeated"


class Stopped(KeyboardInterrupt):
    """Told to stop, by which signal; raised wherever the main thread is."""

    def __init__(self, number: int) -> None:
        self.number = number


class _State:
    """Of this process."""

    working = False
    number, since = 0, float("-inf")


def attend() -> None:
    """From now on SIGINT, SIGTERM and SIGHUP end this process in an orderly way, unless it was begun deaf to them
    (`nohup`)."""
    for number in STOPS:
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _stop)
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, lambda *_: _raise())
        sys.unraisablehook = _lost


def work() -> None:
    """From now on there is something to be tidied up: whoever is told to stop leaves through all its `finally`s."""
    _State.working = True


def deaf() -> None:
    """From now on nothing is left to be stopped."""
    _State.since = float("inf")  # for who is told meanwhile
    for number in STOPS:
        signal.signal(number, signal.SIG_IGN)


def stopped() -> int:
    """The signal that told it to stop, 0 for none: any other exception is then what a library made of that."""
    return _State.number


def say(line: str) -> None:
    """A line on standard error, where there is one."""
    try:
        print(f"imitate: {line}", file=sys.stderr or open(os.devnull, "w"), flush=True)
    except (OSError, ValueError):
        pass


def _stop(number: int, frame: object) -> None:
    now = time.monotonic()
    if now - _State.since < PATIENCE_S:
        return
    _State.number, _State.since = number, now
    if not _State.working:  # nothing was begun; and an exception in the midst of an import comes out as any other
        try:
            os.write(2, f"imitate: {WORDS}\n".encode())
        except OSError:
            pass
        os._exit(128 + number)
    _raise()


def _raise() -> None:
    raise Stopped(_State.number)


def _lost(told: "sys.UnraisableHookArgs") -> None:
    """It was raised where nobody can catch it (a weak reference's callback): raise it again shortly."""
    if isinstance(told.exc_value, Stopped):
        signal.setitimer(signal.ITIMER_REAL, AGAIN_S)
    elif not stopped():
        sys.__unraisablehook__(told)
