"""Why a plugin could not be loaded, in one line, with what to type."""

from __future__ import annotations

import re
import traceback
from importlib.metadata import Distribution
from types import TracebackType

__all__ = ["line_in", "reason_of"]

_REQUIREMENT = re.compile(r"""^([A-Za-z0-9._-]+).*;.*\bextra\s*==\s*['"]([^'"]+)['"]""")


def reason_of(raised: BaseException, distribution: Distribution | None) -> str:
    """One line for an exception from a plugin's import or hook.

    A missing module that the plugin's own distribution declares under an extra names that extra.
    """
    text = " ".join(str(raised).split())
    if isinstance(raised, ModuleNotFoundError) and raised.name and "pip install" not in text:
        extra = _extra_with(raised.name, distribution)
        what = f"it needs the module {raised.name}, which is not installed"
        return f"{what}; type pip install {extra}" if extra else what
    if isinstance(raised, SystemExit):
        return f"it ended the program when it was loaded{_place(raised.__traceback__)}"
    kind = type(raised).__name__
    return (
        f"{kind}: {text}{_place(raised.__traceback__)}" if text else f"{kind}{_place(raised.__traceback__)}"
    )


def line_in(raised: BaseException, filename: str) -> int | None:
    """The line of ``filename`` that an exception came from, None if it never was there."""
    if isinstance(raised, SyntaxError) and raised.filename == filename:
        return raised.lineno
    frames = traceback.extract_tb(raised.__traceback__)
    return next((frame.lineno for frame in reversed(frames) if frame.filename == filename), None)


def _extra_with(module: str, distribution: Distribution | None) -> str | None:
    wanted = _normal(module.split(".")[0])
    for requirement in (distribution.requires if distribution else None) or []:
        match = _REQUIREMENT.match(requirement)
        if distribution and match and _normal(match[1]) == wanted:
            return f'"{distribution.name}[{match[2]}]"'
    return None


def _normal(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


def _place(trace: TracebackType | None) -> str:
    frames = traceback.extract_tb(trace)
    return f" ({frames[-1].filename}:{frames[-1].lineno})" if frames else ""
