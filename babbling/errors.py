"""What can go wrong with experience and forward models, in words that say what to do."""

from collections.abc import Iterable
from difflib import get_close_matches

from models.errors import Told


class BabblingError(Told):
    """Something about experience or a forward model that the user can mend."""


def unknown(kind: str, name: str, options: Iterable[str]) -> str:
    """One line for a name that does not exist: what was given, what is possible, what was probably meant."""
    known = sorted(options)
    close = get_close_matches(name[:80], known, n=1, cutoff=0.5)
    hint = f"; did you mean {close[0]!r}?" if close else ""
    return f"unknown {kind} {name!r}; there are {', '.join(known)}{hint}"
