"""Versions of a world whose things do not stay where they were drawn."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from explore_bt_drivers.world.index import build_index
from explore_bt_drivers.world.solid import Solid, materials_of, outline_edges
from explore_bt_drivers.world.world import World, floor_like

__all__ = ["with_every_stand", "with_solids"]


def with_solids(world: World, solids: Sequence[Solid]) -> World:
    """The world with these solids in the place of its things; floor and start stay as drawn."""
    outlines = [outline_edges(solid.corners) for solid in solids]
    segments = np.concatenate([world.index.segments[: world.fixed], *outlines])
    owners = np.repeat(
        [world.names.index(solid.name) for solid in solids], [len(edges) for edges in outlines]
    )
    materials = materials_of(solids)
    return replace(
        world,
        index=build_index(segments, np.concatenate((world.index.materials[: world.fixed], materials))),
        owners=np.concatenate((world.owners[: world.fixed], owners)).astype(np.int32),
    )


def with_every_stand(world: World) -> World:
    """The world with every thing wherever it ever stands, all at once; the floor is what that leaves free."""
    if not world.things:
        return world
    crowded = with_solids(
        world, [solid for thing in world.things for stand in thing.stands for solid in stand.solids]
    )
    return replace(crowded, floor=floor_like(world.floor, crowded.index))
