"""``--set name=value``."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt.errors import UserError

__all__ = ["parse_overrides"]


def parse_overrides(texts: Sequence[str]) -> dict[str, str]:
    """Parameter name -> value as written; the mission's declarations say what it means.

    Raises:
        UserError: no ``=``, no name, or a name given twice.
    """
    overrides: dict[str, str] = {}
    for text in texts:
        name, equals, value = text.partition("=")
        name = name.strip()
        if not equals or not name:
            raise UserError(f"--set {text}: expected name=value, for example --set stride=1.2")
        if name in overrides:
            raise UserError(f"--set {name} is given twice: {overrides[name]} and {value}; give it once")
        overrides[name] = value
    return overrides
