"""The colours of a report: readable on light and dark, and for the colour-blind."""

from __future__ import annotations

__all__ = ["CLEARANCE_STOPS", "ROBOTS", "robot_colour"]

ROBOTS = ("#2f6fed", "#d9730d", "#0f9d76", "#b4489b", "#8a6d00", "#c2413b")
CLEARANCE_STOPS = ("#d7263d", "#f4743b", "#f2c14e", "#2ec4b6", "#1f77b4")
"""From tight to wide."""


def robot_colour(index: int) -> str:
    """One colour a robot, in the mission's order."""
    return ROBOTS[index % len(ROBOTS)]
