"""Observers as people name them on the command line."""

from __future__ import annotations

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explore_bt.interfaces import Sink
    from explore_bt.plugin import Registry

__all__ = ["make_sinks", "watched_sinks"]

_ALWAYS = ("mcap", "report")


def watched_sinks(registry: Registry, wanted: Iterable[str], *, headless: bool) -> list[Sink]:
    """As ``make_sinks``, and what tells the person at the terminal: a live picture, or lines of text."""
    live = "terminal" if not headless and sys.stdout.isatty() else "progress"
    return make_sinks(registry, (live, *wanted))


def make_sinks(registry: Registry, wanted: Iterable[str]) -> list[Sink]:
    """What looks on at every run, and the sinks of these names, each once.

    Args:
        registry: where they come from.
        wanted: ``rerun``, or ``rerun,to=file`` with options.

    Raises:
        UserError: there is no such sink, or an option is wrong.
    """
    named = {text.partition(",")[0]: text.partition(",")[2] for text in (*_ALWAYS, *wanted)}
    return [_make(registry, name, options) for name, options in named.items()]


def _make(registry: Registry, name: str, options: str) -> Sink:
    from explore_bt.mission.settings import options_from_settings

    cls: type[Sink] = registry.get("sink", name)
    texts = [text for text in options.split(",") if text]
    return cls(options_from_settings(cls.Options, name, "--sink", texts) if texts else cls.Options())
