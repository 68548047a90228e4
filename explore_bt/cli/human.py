"""Figures as people read them."""

from __future__ import annotations

__all__ = ["count", "duration", "percent"]


def duration(seconds: float) -> str:
    """``48 s``, ``3 min 52 s``, ``1 h 05 min``."""
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


def percent(share: float) -> str:
    """``98.9 %``; 100 % only where nothing at all is missing."""
    return "100 %" if share >= 1.0 else f"{min(share * 100.0, 99.9):.1f} %"


def count(number: int, noun: str) -> str:
    """``1 robot``, ``2 robots``."""
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
