"""The key ``material`` of walls and furniture."""

from __future__ import annotations

import yaml

from explore_bt.maps import MarkedFile
from explore_bt_drivers.world.solid import Material

__all__ = ["read_material"]


def read_material(file: MarkedFile, node: yaml.Node | None) -> Material:
    """``matt`` (the default), ``glass`` or ``mirror``."""
    word = file.text(node, "material")
    names = {material.name.lower(): material for material in Material}
    if word is None or node is None or word in names:
        return names.get(word or "", Material.MATT)
    file.fault(node, f"material is {word}; expected one of {', '.join(names)}")
    return Material.MATT
