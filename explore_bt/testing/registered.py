"""Every plugin class that is installed, for tests that run over all of them."""

from __future__ import annotations

from explore_bt.plugin import load_plugins

__all__ = ["registered"]

_EXTRA = 'pip install "explore-bt['


def registered(kind: str) -> tuple[type, ...]:
    """The classes of one kind, by name; what could not be loaded fails the test that asks.

    A plugin that only lacks an extra is no fault: it is unavailable here.

    Raises:
        AssertionError: an installed plugin is broken.
    """
    host = load_plugins()
    broken = [
        f"{each.name}, {each.origin}: {each.reason}" for each in host.broken if _EXTRA not in each.reason
    ]
    assert not broken, "broken plugins: " + "; ".join(broken)
    return tuple(entry.cls for entry in host.registry.entries() if entry.kind == kind)
