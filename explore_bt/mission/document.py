"""YAML text as a tree of values that know their places.

The tree is made from the events of libyaml's parser, not by ``yaml.compose``: the composer recurses in C
and ends the process on deep nesting, and it forgets which tags were written out.
Nothing is ever constructed from a tag.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import yaml

from explore_bt.mission.faults import Faults
from explore_bt.mission.scalars import plain_scalar
from explore_bt.mission.source import Place, Source

__all__ = ["Entries", "Entry", "Items", "Scalar", "Value", "parse_document"]

_DEEPEST = 60
_LARGEST = 50_000
_LIBYAML: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True)
class Scalar:
    """A single value.

    Attributes:
        data: what it means: text, number, boolean, None; after resolving also a ``Key`` or a path.
        text: as written.
        plain: whether it stood without quotes.
    """

    data: object
    text: str
    plain: bool
    place: Place
    size: int = 1


@dataclass(frozen=True)
class Items:
    """A list."""

    values: tuple[Value, ...]
    place: Place
    size: int = 1


@dataclass(frozen=True)
class Entry:
    """A key of a mapping with its value."""

    key: str
    place: Place
    value: Value


@dataclass(frozen=True)
class Entries:
    """A mapping; keys are text and occur once."""

    entries: tuple[Entry, ...]
    place: Place
    size: int = 1

    @cached_property
    def by_key(self) -> Mapping[str, Entry]:
        """Key -> entry."""
        return {entry.key: entry for entry in self.entries}

    def get(self, key: str) -> Value | None:
        """The value of a key, None where it does not occur."""
        entry = self.by_key.get(key)
        return entry.value if entry else None

    def __iter__(self) -> Iterator[Entry]:
        return iter(self.entries)


Value = Scalar | Items | Entries


def parse_document(source: Source, faults: Faults, skipped: int = 0) -> Value | None:
    """The document in ``source``; None if it is no YAML (the faults then say why).

    The first ``skipped`` characters are no part of it, but count in its places.
    """
    try:
        return _Composer(source, faults, skipped).document()
    except _Abandoned:
        return None
    except yaml.MarkedYAMLError as error:
        faults.add(_place_of(source, error), f"not YAML: {error.problem}", _syntax_hint(source, error))
    except (yaml.reader.ReaderError, UnicodeEncodeError) as error:
        faults.add(source.place(), f"not YAML: {error.reason}", "write plain UTF-8 text")
    return None


class _Abandoned(Exception):
    """The fault is noted; the rest of the document makes no sense."""


class _Composer:
    def __init__(self, source: Source, faults: Faults, skipped: int) -> None:
        self._source = source
        self._faults = faults
        self._anchors: dict[str, Value] = {}
        self._events = iter(yaml.parse(" " * skipped + source.text[skipped:], Loader=_LIBYAML))

    def document(self) -> Value:
        nothing = Scalar(None, "", True, self._source.place())
        root: Value | None = None
        for event in self._events:
            if isinstance(event, yaml.DocumentStartEvent) and root is not None:
                self._abandon(event, "a second document begins here", "one mission a file; remove the ---")
            if isinstance(event, yaml.NodeEvent):
                root = self._value(event, 0)
        return root or nothing

    def _value(self, event: yaml.Event, depth: int) -> Value:
        assert isinstance(event, yaml.NodeEvent)  # inside a document nothing else begins
        if isinstance(event, yaml.AliasEvent):
            anchor = str(event.anchor)
            if anchor not in self._anchors:
                self._abandon(event, f"*{anchor} names no value above it", "aliases point upwards")
            return self._anchors[anchor]
        if depth > _DEEPEST:
            self._abandon(
                event, f"nested more than {_DEEPEST} levels deep", "give subtrees names under trees:"
            )
        value = self._fresh(event, depth)
        if value.size > _LARGEST:
            self._abandon(event, "too large once its aliases are written out", "use fewer aliases")
        if event.anchor:
            self._anchors[event.anchor] = value
        return value

    def _fresh(self, event: yaml.NodeEvent, depth: int) -> Value:
        tag = getattr(event, "tag", None)
        if tag is not None and not (tag == "!" and isinstance(event, yaml.ScalarEvent)):
            shown = tag.replace("tag:yaml.org,2002:", "!!")
            self._faults.add(
                self._place(event), f"the tag {shown} is refused", "missions hold plain values only"
            )
        if isinstance(event, yaml.SequenceStartEvent):
            return self._items(event, depth)
        if isinstance(event, yaml.MappingStartEvent):
            return self._entries(event, depth)
        assert isinstance(event, yaml.ScalarEvent)  # the only kind of node left
        plain = event.style is None or event.style == ""
        data = plain_scalar(event.value) if plain else event.value
        return Scalar(data, event.value, plain, self._place(event))

    def _items(self, start: yaml.NodeEvent, depth: int) -> Items:
        values: list[Value] = []
        for event in self._events:
            if isinstance(event, yaml.SequenceEndEvent):
                break
            values.append(self._value(event, depth + 1))
        return Items(tuple(values), self._place(start), 1 + sum(value.size for value in values))

    def _entries(self, start: yaml.NodeEvent, depth: int) -> Entries:
        entries: dict[str, Entry] = {}
        size = 1
        for event in self._events:
            if isinstance(event, yaml.MappingEndEvent):
                break
            key, value = self._value(event, depth + 1), self._value(next(self._events), depth + 1)
            size += 1 + value.size
            if not isinstance(key, Scalar):
                self._faults.add(
                    self._place(event), "a key has to be a word", "quote it if it is meant as text"
                )
            elif key.text == "<<" and key.plain:
                self._faults.add(key.place, "merge keys (<<) are not supported", "write the entries out")
            elif key.text in entries:
                first = entries[key.text].place
                self._faults.add(key.place, f'"{key.text}" is given twice', f"first given at {first}")
            else:
                entries[key.text] = Entry(key.text, key.place, value)
        return Entries(tuple(entries.values()), self._place(start), size)

    def _place(self, event: yaml.Event) -> Place:
        start, end = event.start_mark, event.end_mark
        assert start is not None  # libyaml marks every event
        assert end is not None  # the same
        width = end.column - start.column if end.line == start.line else 1
        return self._source.place(start.line + 1, start.column + 1, max(1, width))

    def _abandon(self, event: yaml.Event, message: str, hint: str) -> None:
        self._faults.add(self._place(event), message, hint)
        raise _Abandoned


def _place_of(source: Source, error: yaml.MarkedYAMLError) -> Place:
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return source.place()
    last = len(source.lines) if source.lines[-1] or len(source.lines) == 1 else len(source.lines) - 1
    if mark.line + 1 > last:
        return source.place(last, len(source.lines[last - 1]) + 1)
    return source.place(mark.line + 1, mark.column + 1)


def _syntax_hint(source: Source, error: yaml.MarkedYAMLError) -> str:
    line = _place_of(source, error).excerpt
    mark = error.problem_mark
    before = line[: mark.column + 1] if mark else line
    if "${" in line:
        return "write $name instead of ${name}"
    if "\t" in before:
        return "indent with spaces, not tabs"
    if before[-1:] in ("@", "`", "%"):
        return f'quote text that begins with "{before[-1]}"'
    if "mapping values" in str(error.problem):
        return 'quote text that contains ": ", or check the indentation'
    return "check brackets, quotes and indentation"
