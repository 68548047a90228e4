"""The files that exporters make."""

from __future__ import annotations

import logging
from pathlib import Path

from explore_bt.interfaces import Exporter, RobotProduct
from explore_bt.plugin import Registry

__all__ = ["export"]

_log = logging.getLogger("explore_bt")


def export(registry: Registry, product: RobotProduct, folder: Path) -> None:
    """Let every installed exporter write; one that fails is named in the log and costs only its own files."""
    for name in registry.names("exporter"):
        make: type[Exporter] = registry.get("exporter", name)
        try:
            make(make.Options()).export(product, folder)
        except Exception:  # one format that cannot be written must not cost the others
            _log.exception("exporter %s wrote nothing", name)
