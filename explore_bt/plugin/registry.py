"""Which class stands behind which name, and who brought it."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass

from explore_bt.errors import PluginError
from explore_bt.plugin.checks import KINDS, check_class, kind_of, name_of

__all__ = ["KINDS", "BrokenPlugin", "Entry", "Registry"]


@dataclass(frozen=True, slots=True)
class Entry:
    """One registered class.

    Attributes:
        kind, name: the pair that no other class may have.
        origin: the distribution and module, or the file, that brought it.
        version: the distribution's version, empty for a file.
        doc: the first line of the class's docstring.
    """

    kind: str
    name: str
    cls: type
    origin: str
    version: str
    doc: str


@dataclass(frozen=True, slots=True)
class BrokenPlugin:
    """A plugin that was left out, and why."""

    name: str
    origin: str
    reason: str


class Registry:
    """The plugin classes of one host, by kind and name; no name has two owners."""

    def __init__(self) -> None:
        self._entries: dict[tuple[str, str], Entry] = {}
        self._broken: list[BrokenPlugin] = []

    def add(self, cls: type, origin: str, version: str = "") -> None:
        """Register one class under ``cls.kind`` and ``cls.name`` (leaves: ``cls.type_key``).

        Raises:
            PluginError: not a class, still abstract, of no known kind, without a name, written for
                another version of the contracts, or with a name that is already taken.
        """
        self.add_all([cls], origin, version)

    def add_all(self, classes: Iterable[type], origin: str, version: str = "") -> None:
        """Register all classes of one plugin, or none of them.

        Raises:
            PluginError: as for ``add``, for the first class at fault.
        """
        entries = dict(self._entries)
        for cls in classes:
            check_class(cls, origin)
            entry = _entry(cls, origin, version)
            owner = entries.get((entry.kind, entry.name))
            if owner is not None:
                raise PluginError(_second_owner(entry, owner))
            entries[entry.kind, entry.name] = entry
        self._entries = entries

    def set_aside(self, broken: BrokenPlugin) -> None:
        """Remember a plugin that was left out: it may be the one that somebody asks for."""
        self._broken.append(broken)

    def get(self, kind: str, name: str) -> type:
        """The class behind a name.

        Raises:
            PluginError: nothing of that kind and name; says what there is, and what was left out.
        """
        entry = self._entries.get((kind, name))
        if entry is None:
            raise PluginError(self._unknown(kind, name))
        return entry.cls

    def names(self, kind: str) -> tuple[str, ...]:
        """The names of one kind, sorted."""
        return tuple(sorted(name for of, name in self._entries if of == kind))

    def entries(self) -> tuple[Entry, ...]:
        """Everything registered, by kind (in the order of ``KINDS``), then by name."""
        return tuple(sorted(self._entries.values(), key=lambda entry: (KINDS.index(entry.kind), entry.name)))

    @property
    def broken(self) -> tuple[BrokenPlugin, ...]:
        """The plugins that were left out, in the order they were met."""
        return tuple(self._broken)

    def _unknown(self, kind: str, name: str) -> str:
        if kind not in KINDS:
            return f'there is no plugin kind "{kind}"; kinds are {", ".join(KINDS)}'
        names = self.names(kind)
        close = difflib.get_close_matches(name, names, n=1)
        hint = f'; did you mean "{close[0]}"?' if close else "."
        installed = f"Installed: {', '.join(names)}." if names else f"No {kind} is installed."
        left_out = "".join(f" Left out: {each.name} ({each.reason})." for each in self._broken)
        return (
            f'no {kind} is called "{name}"{hint} {installed}{left_out} See explore-bt plugins --kind {kind}'
        )


def _entry(cls: type, origin: str, version: str) -> Entry:
    doc = (cls.__doc__ or "").strip()
    kind, name = kind_of(cls), name_of(cls)
    assert kind is not None  # check_class lets no other class through
    assert name is not None  # the same
    return Entry(kind, name, cls, origin, version, doc.splitlines()[0] if doc else "")


def _second_owner(entry: Entry, owner: Entry) -> str:
    return (
        f'the {entry.kind} "{entry.name}" has two owners: {owner.origin} ({owner.cls.__qualname__}) and '
        f"{entry.origin} ({entry.cls.__qualname__}); rename one of them"
    )
