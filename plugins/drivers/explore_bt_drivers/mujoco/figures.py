"""The robot in figures, for who needs no physics."""

from __future__ import annotations

__all__ = [
    "BODY_HEIGHT_M",
    "BODY_RADIUS_M",
    "FORESIGHT_S",
    "STEP_M",
    "TRACK_M",
    "WHEEL_RADIUS_M",
]

WHEEL_RADIUS_M = 0.0935
TRACK_M = 0.48
"""Between the middles of the wheels."""
BODY_RADIUS_M = 0.27
"""Circle about ``base_link`` that the upright body keeps within: the rims of its wheels."""
BODY_HEIGHT_M = 0.6
"""What is higher is passed under, leaning included."""
STEP_M = 0.05
"""What is lower is driven over, or is the floor: the body passes sills of 2 cm, no lidar tells under 5."""
FORESIGHT_S = 0.2
"""So much later than they come set-points are acted on: 1.1 cm past a stop instead of 3.3 cm."""
