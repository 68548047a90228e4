"""Collecting every fault of a mission, and showing them."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt.errors import Fault, MissionError
from explore_bt.mission.source import Place

__all__ = ["Faults", "show_faults"]

_LONGEST_LINE = 160


class Faults:
    """The faults found so far; the same fault at the same place counts once."""

    def __init__(self) -> None:
        self._faults: dict[tuple[str, int, int, str], Fault] = {}

    def __bool__(self) -> bool:
        return bool(self._faults)

    def add(self, place: Place, message: str, hint: str = "") -> None:
        """Note a fault."""
        source = place.source
        line = place.line if source.has_lines else 0
        fault = Fault(source.name, line, place.column, message, hint, place.excerpt, place.width)
        self._faults.setdefault((fault.file, fault.line, fault.column, fault.message), fault)

    def raise_if_any(self) -> None:
        """Raise a ``MissionError`` with all faults, in the order of the text."""
        if self._faults:
            files = list(dict.fromkeys(fault.file for fault in self._faults.values()))
            ordered = sorted(self._faults.values(), key=lambda f: (files.index(f.file), f.line, f.column))
            raise MissionError(show_faults(ordered), ordered)


def show_faults(faults: Sequence[Fault]) -> str:
    """All faults as people read them: place, message, hint, the line with a caret; then how many."""
    count = "1 fault" if len(faults) == 1 else f"{len(faults)} faults"
    return "\n".join([*map(_show, faults), f"{count}, nothing was run"])


def _show(fault: Fault) -> str:
    head = f"{fault.place}  {fault.message}"
    head += f"    {fault.hint}" if fault.hint else ""
    if not fault.excerpt.strip():
        return head
    gutter = f"{fault.line:>6} | " if fault.line else " " * 7 + "| "
    before = fault.excerpt[: fault.column - 1]
    indent = "".join("\t" if character == "\t" else " " for character in before)
    if len(fault.excerpt) > _LONGEST_LINE:
        return head
    width = max(1, min(fault.width, len(fault.excerpt) - len(before)))
    return f"{head}\n{gutter}{fault.excerpt}\n{' ' * 7}| {indent}{'^' * width}"
