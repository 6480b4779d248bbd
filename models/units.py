"""Units: radians and metres inside, degrees and millimetres for people."""

from types import MappingProxyType

import numpy as np

SHOWN = MappingProxyType({"rad": ("deg", 180 / np.pi), "m": ("mm", 1e3)})
"""Unit of a joint -> what people read, and how many of it one is."""
