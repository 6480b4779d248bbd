"""What can go wrong with a body, a world or a teacher, in words that say what to do."""

from collections.abc import Iterable
from difflib import get_close_matches

LONGEST, HEAD = 380, 240
"""Characters of a line that people are told, and how many of a longer one's are its beginning: its end says more."""


class Told(ValueError):
    """What people are told: in one line that can be printed, of at most LONGEST characters."""

    def __str__(self) -> str:
        line = " ".join(super().__str__().split())
        line = line if len(line) <= LONGEST else f"{line[:HEAD]} ... {line[HEAD + 5 - LONGEST :]}"
        return "".join(letter if letter.isprintable() else "?" for letter in line)


class BodyError(Told):
    """Something about a body, a world or a teacher that the user can mend."""


def unknown(kind: str, name: str, options: Iterable[str]) -> str:
    """One line for a name that does not exist: what was given, what is possible, what was probably meant."""
    known = sorted(options)
    close = get_close_matches(name[:80], known, n=1, cutoff=0.5)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    return f"unknown {kind} {name!r}; there are {', '.join(known)}{hint}"
