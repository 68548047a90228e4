"""Finding out whether the library of a plugin is there, without the seconds that importing it takes."""

from __future__ import annotations

import importlib.util

__all__ = ["require"]


def require(module: str, extra: str, *, otherwise: str = "") -> None:
    """Refuse to be loaded without a library.

    Args:
        module: what has to be importable.
        extra: of explore-bt, which brings it.
        otherwise: another way to have it, after the line to type.

    Raises:
        ModuleNotFoundError: it is not installed; the message names the line to type.
    """
    if importlib.util.find_spec(module) is None:
        raise ModuleNotFoundError(
            f"it needs the module {module}, which is not installed; "
            f'type pip install "explore-bt[{extra}]"{otherwise}',
            name=module,
        )
