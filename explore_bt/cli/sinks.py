"""Observers as people name them on the command line."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from explore_bt.interfaces import Sink
    from explore_bt.plugin import Registry

__all__ = ["ALWAYS", "make_sinks"]

ALWAYS = ("mcap", "report")
"""What looks on at every run."""


def make_sinks(registry: Registry, wanted: Iterable[str]) -> list[Sink]:
    """The sinks of these names, each once: ``rerun``, or ``rerun,to=file`` with options.

    Raises:
        UserError: there is no such sink, or an option is wrong.
    """
    named = {text.partition(",")[0]: text.partition(",")[2] for text in wanted}
    return [_make(registry, name, options) for name, options in named.items()]


def _make(registry: Registry, name: str, options: str) -> Sink:
    from explore_bt.mission.settings import options_from_settings

    cls: type[Sink] = registry.get("sink", name)
    texts = [text for text in options.split(",") if text]
    return cls(options_from_settings(cls.Options, name, "--sink", texts) if texts else cls.Options())
