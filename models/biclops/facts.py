"""What the data say about the Biclops; a test compares the compiled model with them. Sources: README.md."""

from typing import Final

PAN_RANGE_DEG: Final = 180.0
"""Hard stop either side (BC1, BC2, VP); the soft limit lies 2 degrees inside."""
TILT_RANGE_DEG: Final = 60.0
"""Hard stop either side (BC1, BC2; VP has 40); the soft limit lies 2 degrees inside."""
SOFT_MARGIN_DEG: Final = 2.0
MAX_SPEED_DEG_S: Final = (150.0, 200.0)
"""Pan, tilt; run profile of BC1."""
MAX_ACCELERATION_DEG_S2: Final = (300.0, 80.0)
"""Pan, tilt; run profile of BC1 (BC2 has 300 for both)."""
ENCODER_COUNTS: Final = 12000
"""Per turn of the axis (BC1: 2000 x 6)."""
CAMERA_HEIGHT: Final = 0.048
"""Metres of the camera centres above the tilt axis (VP)."""
PAN_CYLINDER: Final = (0.1016, 0.0762)
"""Radius and length, metres (BC1, BC2: 4 and 3 inches)."""
TILT_CYLINDER: Final = (0.0381, 0.0635)
"""Radius and length, metres (BC1, BC2: 1.5 and 2.5 inches)."""
MASSES: Final = {"base": 1.5, "pan": 0.8, "tilt": 0.4, "mount": 0.3}
"""Kilograms; chosen, no source (the mount carries two cameras of 0.15)."""
BASELINE: Final = 0.10
"""Metres between the cameras; chosen, no source."""
PAN_HEIGHT: Final = 0.15
"""Metres of the axes above the table; chosen, no source."""
TORQUE_LIMIT: Final = 2.0
"""Newton metres, both axes; chosen, no source."""
