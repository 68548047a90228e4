"""The report's account of a run: decisions, recoveries, interventions, health, and each one's reason."""

from __future__ import annotations

from collections import Counter
from html import escape

from explore_bt.interfaces import Event
from explore_bt.report.markup import section, table
from explore_bt.report.run_history import RunHistory
from explore_bt.report.words import clock

__all__ = ["KINDS", "kind_of", "what_happened_section"]

KINDS = {
    "mission": "mission",
    "recovery": "recoveries",
    "gate": "safety gate",
    "slam": "health",
    "fault": "faults and notes",
    "saying": "what leaves say",
}
"""Class in the page -> what people read; all but the last are shown at first."""
_SOURCES = {"mission": "mission", "recovery": "recovery", "safety gate": "gate", "slam": "slam"}


def kind_of(event: Event) -> str:
    """The class of an event's row."""
    return "saying" if event.level == "debug" else _SOURCES.get(event.source, "fault")


def what_happened_section(history: RunHistory) -> str:
    """All events in one table with a switch for each kind; a stamp leads the map above to that moment."""
    title = "What happened and why"
    if not history.events:
        return section(title, "<p>Nothing was worth a line.</p>")
    kinds = [kind_of(event) for event in history.events]
    found = Counter(kinds)
    switches = "".join(_switch(kind, found[kind]) for kind in KINDS if found[kind])
    rows = map(_row, history.events)
    content = f'<div class="switches">{switches}</div>' + table(
        ("at", "robot", "from", "what"), rows, "events", kinds
    )
    more = history.events_left_out
    return section(title, content, f"{more} more are in the recording" if more else "")


def _switch(kind: str, count: int) -> str:
    on = "" if kind == "saying" else " checked"
    return f'<label><input type="checkbox" id="show-{kind}"{on}> {count} {escape(KINDS[kind])}</label>'


def _row(event: Event) -> tuple[str, str, str, str]:
    level = event.level if event.level in ("debug", "info", "warning", "error") else "info"
    shown = "" if level in ("debug", "info") else f'<span class="level {level}">{level}</span> '
    source = event.source.rpartition("/")[2] if level == "debug" else event.source
    stamp = f'<a href="#t={event.stamp_s:.1f}">{clock(event.stamp_s)}</a>'
    name = f'<span title="{escape(event.source, quote=True)}">{escape(source)}</span>'
    return (stamp, escape(event.robot), name, f"{shown}{escape(event.message)}")
