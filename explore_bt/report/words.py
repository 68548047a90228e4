"""Figures as people say them."""

from __future__ import annotations

import math

from explore_bt.types import Outcome, Result

__all__ = ["clock", "duration", "figure", "headline", "length", "outcome_words", "percent"]

_OUTCOMES = {
    Outcome.EXPLORED: "Explored",
    Outcome.MAPPED: "Mapped",
    Outcome.STOPPED: "Stopped by hand",
    Outcome.BUDGET: "Budget used up",
    Outcome.FAILED: "Failed",
    Outcome.CUT: "Cut off",
}
NOBODY_KNOWS = "–"


def clock(seconds: float) -> str:
    """Mission time as ``m:ss``."""
    whole = max(0, int(seconds))
    hours, minutes = divmod(whole // 60, 60)
    return f"{hours}:{minutes:02d}:{whole % 60:02d}" if hours else f"{minutes}:{whole % 60:02d}"


def duration(seconds: float) -> str:
    """A time span: ``41.7 s``, ``3 min 52 s``, ``1 h 05 min``."""
    if seconds < 60.0:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def length(metres: float | None) -> str:
    """A length: centimetres below half a metre."""
    if metres is None or not math.isfinite(metres):
        return NOBODY_KNOWS
    return (
        f"{metres * 100:.1f} cm"
        if metres < 0.1
        else f"{metres:.2f} m"
        if metres < 10.0
        else f"{metres:.1f} m"
    )


def percent(share: float | None) -> str:
    """A share in percent with one decimal."""
    return NOBODY_KNOWS if share is None or not math.isfinite(share) else f"{share * 100:.1f} %"


def figure(value: float) -> str:
    """A number whose unit stands in its name."""
    return f"{value:,.0f}".replace(",", " ") if float(value).is_integer() else f"{value:.4g}"


def outcome_words(outcome: Outcome) -> str:
    """How a mission ended, in a word or three."""
    return _OUTCOMES[outcome]


def headline(result: Result) -> str:
    """The outcome with its reason, one sentence."""
    reason = result.reason.strip()
    return f"{outcome_words(result.outcome)}: {reason}" if reason else outcome_words(result.outcome)
