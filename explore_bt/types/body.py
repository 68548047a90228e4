"""How a robot's body is made, beyond its footprint."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["BodyShape"]


@dataclass(frozen=True, slots=True)
class BodyShape:
    """What a 3D lidar's returns are to be judged by.

    Attributes:
        height_m: of the whole body above the floor; what is higher is passed under.
        step_m: what is lower is driven over.
        base_height_m: ``base_link`` above the floor; the body leans about it.
    """

    height_m: float = 1.0
    step_m: float = 0.05
    base_height_m: float = 0.0
