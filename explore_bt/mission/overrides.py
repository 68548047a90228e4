"""``--set name=value``: parameters, and entries of ``limits`` and ``tick`` by their dotted names."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from explore_bt.mission.document import Entries, Entry, Value, parse_document
from explore_bt.mission.faults import Faults
from explore_bt.mission.source import Source
from explore_bt.mission.words import did_you_mean

__all__ = ["SECTIONS", "Override", "as_settings", "overridden", "params_overridden", "read_overrides"]

SECTIONS = ("limits", "tick")


@dataclass(frozen=True, slots=True)
class Override:
    """One override; ``section`` is ``params``, ``limits`` or ``tick``."""

    section: str
    entry: Entry


def as_settings(texts: Sequence[str] | Mapping[str, str]) -> Sequence[str]:
    """Each as ``name=value``."""
    return [f"{name}={value}" for name, value in texts.items()] if isinstance(texts, Mapping) else texts


def read_overrides(
    texts: Sequence[str] | Mapping[str, str], cwd: Path, faults: Faults
) -> tuple[Override, ...]:
    """The overrides, each as the entry it stands for; relative files in them are relative to ``cwd``."""
    found: dict[tuple[str, str], Override] = {}
    for text in as_settings(texts):
        override = _read(text, cwd, faults)
        if override is None:
            continue
        name = (override.section, override.entry.key)
        if name in found:
            faults.add(override.entry.place, f"{override.entry.key} is set twice", "set it once")
        found[name] = override
    return tuple(found.values())


def _read(text: str, cwd: Path, faults: Faults) -> Override | None:
    name, equals, _ = text.partition("=")
    shown = Source(f"--set {text}", text, cwd, has_lines=False)
    if not equals or not name.strip():
        faults.add(shown.place(), "not of the form name=value", "for example --set stride=1.2")
        return None
    parsed = parse_document(shown, faults, skipped=len(name) + 1)
    if parsed is None:
        return None
    section, _, key = name.strip().rpartition(".")
    place = shown.place(1, 1, len(name))
    if section not in ("", "params", *SECTIONS):
        known = (f"{each}.{key}" for each in ("params", *SECTIONS))
        faults.add(place, f'"{name}" cannot be set', did_you_mean(name, known, "sections"))
        return None
    return Override(section or "params", Entry(key, place, parsed))


def params_overridden(
    overrides: Sequence[Override], known: Collection[str], faults: Faults
) -> dict[str, Value]:
    """Parameter -> value; names that are no parameter are noted."""
    values: dict[str, Value] = {}
    for override in overrides:
        entry = override.entry
        if override.section != "params":
            continue
        if entry.key in known:
            values[entry.key] = entry.value
        else:
            hint = did_you_mean(entry.key, known, "parameters")
            faults.add(entry.place, f'there is no parameter "{entry.key}"', hint)
    return values


def overridden(section: str, entries: Entries, overrides: Sequence[Override]) -> Entries:
    """A section with its overrides put in."""
    new = {override.entry.key: override.entry for override in overrides if override.section == section}
    kept = tuple(entry for entry in entries if entry.key not in new)
    return Entries((*kept, *new.values()), entries.place)
