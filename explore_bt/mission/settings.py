"""Options of a single plugin from ``name=value`` texts, without a mission around them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from explore_bt.interfaces import PluginOptions
from explore_bt.mission.checking import check_model
from explore_bt.mission.document import Entries, Entry, Scalar, parse_document
from explore_bt.mission.faults import Faults
from explore_bt.mission.source import Source

__all__ = ["options_from_settings"]


def options_from_settings(
    model: type[PluginOptions],
    owner: str,
    flag: str,
    texts: Sequence[str],
    fixed: Mapping[str, object] | None = None,
) -> PluginOptions:
    """The options, checked as in a mission.

    Args:
        model: the plugin's ``Options``.
        owner: the plugin's name, for messages.
        flag: the command's option that the texts were given with.
        texts: ``name=value``, values as in YAML.
        fixed: options that the command sets itself.

    Raises:
        MissionError: everything that is wrong with them, at once.
    """
    faults, cwd = Faults(), Path()
    head = Source(owner, "", cwd, has_lines=False).place()
    entries = {
        name: Entry(name, head, Scalar(value, str(value), plain=False, place=head))
        for name, value in (fixed or {}).items()
    }
    for text in texts:
        name, equals, _ = text.partition("=")
        name = name.strip()
        shown = Source(f"{flag} {text}", text, cwd, has_lines=False)
        if not equals or not name:
            faults.add(shown.place(), "not of the form name=value", f"for example {flag} voxel='10 cm'")
            continue
        place = shown.place(1, 1, len(name))
        if name in entries:
            faults.add(place, f"{name} is set twice", "set it once")
        parsed = parse_document(shown, faults, skipped=text.index("=") + 1)
        if parsed is not None:
            entries[name] = Entry(name, place, parsed)
    options = check_model(model, Entries(tuple(entries.values()), head), owner, "option", cwd, faults, head)
    faults.raise_if_any()
    assert options is not None  # what is None has been noted as a fault
    return options
