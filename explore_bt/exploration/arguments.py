"""Checks of what callers pass in, with one message a person can act on."""

from __future__ import annotations

import math

from explore_bt.errors import UserError

__all__ = ["ArgumentError", "require_at_least", "require_positive"]


class ArgumentError(UserError, ValueError):
    """A number that the mathematics has no meaning for."""


def require_positive(**values: float) -> None:
    """Every named value must be finite and above zero.

    Raises:
        ArgumentError: names the first one that is not.
    """
    for name, value in values.items():
        if not (value > 0.0 and math.isfinite(value)):
            raise ArgumentError(f"{name}: {value} found, expected a finite number above 0; give such a value")


def require_at_least(minimum: float, **values: float) -> None:
    """Every named value must be finite and not below ``minimum``.

    Raises:
        ArgumentError: names the first one that is.
    """
    for name, value in values.items():
        if not (value >= minimum and math.isfinite(value)):
            raise ArgumentError(
                f"{name}: {value} found, expected a finite number of at least {minimum:g}; give such a value"
            )
