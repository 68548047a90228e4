"""What a robot may still spend."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Budget"]


@dataclass(frozen=True, slots=True)
class Budget:
    """One thing that runs out.

    Attributes:
        name: ``time``, ``distance`` or ``battery``.
        unit: of ``whole`` and ``left``: seconds, metres, or percent of the charge.
        whole: what there was for the mission.
        left: what there is still.
        per_s, per_m: what a second and a metre take.
    """

    name: str
    unit: str
    whole: float
    left: float
    per_s: float = 0.0
    per_m: float = 0.0

    def need(self, way_m: float, way_s: float) -> float:
        """What a way of so many metres and seconds takes."""
        return self.per_m * way_m + self.per_s * way_s

    def __str__(self) -> str:
        return f"{self.left:.0f} of {self.whole:.0f} {self.unit}"
