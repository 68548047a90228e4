"""A node in the making: its type, and the modifiers around it so far."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

from explore_bt.mission.document import Entries, Entry, Items, Scalar, Value
from explore_bt.mission.source import Place

__all__ = ["Draft", "constant", "quoted"]

_INSIDE_OUT = ("timeout", "retry", "on_failure", "if")
_WRITTEN = ("name", "doc", "if", "timeout", "retry", "", "on_failure")


@final
@dataclass(frozen=True)
class Draft:
    """What will be a node of a mission.

    Attributes:
        type: its type key with what stands below it.
        beside: name, comment and modifiers.
    """

    type: Entry
    beside: dict[str, Entry] = field(default_factory=dict)

    def with_text(self, key: str, text: str, place: Place) -> Draft:
        """With a name or a comment."""
        return Draft(self.type, {**self.beside, key: Entry(key, place, quoted(text, place))})

    def modified(self, modifier: str, value: Value, place: Place) -> Draft:
        """With one more modifier around it; inside a sequence of one where two would change places."""
        rank = _INSIDE_OUT.index(modifier)
        entry = Entry(modifier, place, value)
        if any(key in _INSIDE_OUT[rank:] for key in self.beside):
            return Draft(Entry("sequence", place, Items((self.value(),), place)), {modifier: entry})
        return Draft(self.type, {**self.beside, modifier: entry})

    def value(self) -> Value:
        """As it would stand in a mission: a leaf's bare name where that is all."""
        type_ = self.type
        if isinstance(type_.value, Scalar) and type_.value.data is None:
            if not self.beside:
                return Scalar(type_.key, type_.key, True, type_.place)
            type_ = Entry(type_.key, type_.place, Entries((), type_.place))
        entries = {**self.beside, "": type_}
        return Entries(tuple(entries[key] for key in _WRITTEN if key in entries), self.type.place)


def quoted(text: str, place: Place) -> Scalar:
    """A text."""
    return Scalar(text, text, False, place)


def constant(data: int | str | None, place: Place) -> Scalar:
    """A number or a word, or nothing at all."""
    return Scalar(data, "" if data is None else str(data), True, place)
