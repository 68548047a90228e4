"""The files that exporters make, and the state of SLAM beside them."""

from __future__ import annotations

import logging
from pathlib import Path

from explore_bt.interfaces import Exporter, RobotProduct, Slam
from explore_bt.plugin import Registry

__all__ = ["export"]

_log = logging.getLogger("explore_bt")

_SAVED_MAP = "slam"
"""Folder of the results with the state of SLAM; a robot with ``map:`` goes on in it."""


def export(registry: Registry, product: RobotProduct, slam: Slam | None, folder: Path) -> None:
    """Let every exporter write and SLAM save; one that fails is named in the log and costs only its files.

    Args:
        registry: where the exporters come from.
        product: what they write.
        slam: its state is saved; None where nobody knows it any more.
        folder: where to.
    """
    for name in registry.names("exporter"):
        make: type[Exporter] = registry.get("exporter", name)
        try:
            make(make.Options()).export(product, folder)
        except Exception:  # one format that cannot be written must not cost the others
            _log.exception("exporter %s wrote nothing", name)
    if slam is None:
        return
    try:
        slam.save(folder / _SAVED_MAP)
    except Exception:  # nor may a state that cannot be saved
        _log.exception("slam %s saved nothing", slam.name)
