"""Reading what people wrote: expecting a mapping, a list or a text, and noting faults otherwise."""

from __future__ import annotations

from collections.abc import Collection

from explore_bt.mission.document import Entries, Items, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.words import did_you_mean, show

__all__ = ["check_keys", "expect_entries", "expect_items", "expect_text", "is_null", "written"]


def written(value: Value) -> str:
    """What was found, in a few words."""
    if isinstance(value, Scalar):
        return show(value.data if value.plain else value.text)
    return "a list" if isinstance(value, Items) else "a mapping"


def is_null(value: Value | None) -> bool:
    """Whether nothing is written there."""
    return value is None or (isinstance(value, Scalar) and value.data is None)


def expect_entries(value: Value | None, what: str, example: str, faults: Faults) -> Entries | None:
    """``value`` as a mapping; None where there is none (nothing written is no fault)."""
    if isinstance(value, Entries):
        return value
    if value is not None and not is_null(value):
        faults.add(value.place, f"{what}: {written(value)} is not a mapping", f"write {example}")
    return None


def expect_items(value: Value | None, what: str, example: str, faults: Faults) -> tuple[Value, ...]:
    """``value`` as a list; empty where there is none (nothing written is no fault)."""
    if isinstance(value, Items):
        return value.values
    if value is not None and not is_null(value):
        faults.add(value.place, f"{what}: {written(value)} is not a list", f"write {example}")
    return ()


def expect_text(value: Value | None, what: str, faults: Faults) -> str | None:
    """``value`` as text; None where there is none (nothing written is no fault)."""
    if isinstance(value, Scalar) and isinstance(value.data, str):
        return value.data
    if value is not None and not is_null(value):
        faults.add(value.place, f"{what}: {written(value)} is not text", "put it in quotes")
    return None


def check_keys(entries: Entries, known: Collection[str], owner: str, faults: Faults) -> None:
    """Note every key that is not known."""
    for entry in entries:
        if entry.key not in known:
            faults.add(entry.place, f'{owner} has no key "{entry.key}"', did_you_mean(entry.key, known))
