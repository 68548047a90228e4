"""Finding out whether the library of a driver is there, without the seconds that importing it takes."""

from __future__ import annotations

import importlib.util

__all__ = ["require"]


def require(module: str, extra: str) -> None:
    """Refuse to be loaded without a library.

    Raises:
        ModuleNotFoundError: it is not installed; the message names the line to type.
    """
    if importlib.util.find_spec(module) is None:
        raise ModuleNotFoundError(
            f'it needs the module {module}, which is not installed; type pip install "explore-bt[{extra}]"',
            name=module,
        )
