"""The framework's own plugins, through the same hook as everybody's: leaves, sinks, exporters."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import behaviours, recording, report
from explore_bt.plugin.spec import hookimpl

__all__ = ["explore_bt_register"]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """Every leaf, and the sinks and exporters of recording and report."""
    return [*behaviours.LEAVES, *recording.SINKS, *report.SINKS, *report.EXPORTERS]
