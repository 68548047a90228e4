"""Path feedback of a unicycle in chained form."""

from __future__ import annotations

import math

__all__ = ["turn_rate"]


def turn_rate(
    speed_mps: float,
    lateral_m: float,
    heading_error_rad: float,
    curvature: float,
    curvature_rate: float,
    convergence_m: float,
) -> float:
    """Turn rate that follows the path's curvature and takes the error back over a fixed length.

    Samson, "Control of chained systems", 1995: with d the lateral offset, θ the heading error and c the
    curvature, x2 = d, x3 = (1 - c d) tan θ and u2 = dx3/dt, the choice u2 = -|u1| (x2/λ² + 2 x3/λ) makes
    both errors die out critically damped in arc length, at any speed. Offsets beyond 2 λ are taken for
    2 λ, so that the way back is met at 45° at most.

    Args:
        speed_mps: of the robot.
        lateral_m: offset, left is positive.
        heading_error_rad: robot's heading minus path's.
        curvature: of the path, 1/m.
        curvature_rate: its change with arc length, 1/m².
        convergence_m: λ.

    Returns:
        rad/s.
    """
    theta = max(-1.2, min(1.2, heading_error_rad))
    offset = max(-2.0 * convergence_m, min(2.0 * convergence_m, lateral_m))
    shrink = max(0.2, 1.0 - curvature * offset)
    tangent, cosine = math.tan(theta), math.cos(theta)
    u1 = speed_mps * cosine / shrink
    x3 = shrink * tangent
    u2 = -abs(u1) * (offset / convergence_m**2 + 2.0 * x3 / convergence_m)
    drift = (curvature_rate * u1 * offset + curvature * speed_mps * math.sin(theta)) * tangent
    return curvature * u1 + (u2 + drift) * cosine * cosine / shrink
