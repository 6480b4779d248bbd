"""What a field of numbers may hold, and which classes are kinds of file: declared beside the class, in its annotations.

`babbling.files` writes and reads every class that is declared so; nothing else has to be said about it.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

from babbling.errors import BabblingError

LARGEST = 1e9
"""No number that means anything to a mind is larger, unless its field says so."""
T = TypeVar("T")


@dataclass(frozen=True)
class Numbers:
    """What the numbers of a field may be: `slope: Annotated[FloatArray, Numbers("motor", "rad", zero=False)]`."""

    dims: str = ""
    """Names of the dimensions, with spaces between; a name has one size throughout a file. "state:3" has this size in
    every file; ".joint", first among several things of one class, is each one's own."""
    unit: str = ""
    low: float = -LARGEST
    high: float = LARGEST
    zero: bool = True
    """Whether 0 is possible."""
    index: str = ""
    """Dimension along which these numbers count, from 0."""
    covariance: bool = False
    """Whether the last two dimensions are symmetric matrices without negative eigenvalues."""
    scale: float = 1.0
    """What to multiply the stored whole numbers by for this unit; programs that know NetCDF do it unasked."""


class Kind(NamedTuple):
    """A class that files hold, what to do about a file of it that cannot be used, and as which error."""

    holds: type
    remedy: str
    error: type[BabblingError]


KINDS: dict[str, Kind] = {}
"""Every kind of file that was imported; `kind` enters it."""


def kind(name: str, remedy: str, error: type[BabblingError] = BabblingError) -> Callable[[type[T]], type[T]]:
    """Make the decorated class a kind of file."""

    def enter(holds: type[T]) -> type[T]:
        KINDS[name] = Kind(holds, remedy, error)
        return holds

    return enter
