"""What stands in a world, sorted by who sees it and how it collides."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.cells import boxes_of, open_space
from explore_bt_drivers.mujoco.scene.prisms import convex_parts, surfaces_of
from explore_bt_drivers.mujoco.scene.surface import Surface, caps, joined, sides, slab
from explore_bt_drivers.mujoco.scene.tints import EDGE, FLOOR, SILL, Tint, furniture_tint, wall_tint
from explore_bt_drivers.world import Material, Ramp, Solid, World, WorldPlan
from explore_bt_drivers.world.outline import grid_outline
from explore_bt_drivers.world.solid import box_corners

__all__ = ["Convex", "Matter", "fixed_matter", "matter_of"]

Floats = NDArray[np.float64]

MAP_WALL_M = 2.5
"""Height of everything solid in a map, which knows none."""

_EDGE_THICKNESS_M = 0.1
_GLASS: Tint = (0.65, 0.80, 0.85)
_MIRROR: Tint = (0.70, 0.74, 0.78)


@dataclass(frozen=True, slots=True, eq=False)
class Convex:
    """A body to run into.

    Attributes:
        name: of the thing that it is part of.
        corners: (N, 3) float64, metres, ``map`` frame, the lower ones first.
        is_box: a rectangle upright: four corners below, the same above.
    """

    name: str
    corners: Floats
    is_box: bool


@dataclass(frozen=True, slots=True, eq=False)
class Matter:
    """Surfaces by material, and convex bodies."""

    surfaces: dict[Material, Surface]
    bodies: tuple[Convex, ...] = ()


def fixed_matter(world: World, rng: np.random.Generator) -> Matter:
    """Everything that never moves, the floor included."""
    if world.plan is None:
        return _map_matter(world, rng)
    plan = world.plan
    moving = {
        solid for thing in plan.things for solid in (*thing.stands[0].solids, *thing.stands[0].overhangs)
    }
    solids = [solid for solid in (*plan.solids, *plan.overhangs) if solid not in moving]
    return _joined(
        [
            matter_of(_shortened(solids, plan.overhangs), rng),
            _matter(plan.sills, lambda: SILL),
            _matter(_edges(plan), lambda: EDGE),
            *(_ramp_matter(ramp) for ramp in plan.ramps),
            Matter({Material.MATT: _floor(plan.bounds)}),
        ]
    )


def matter_of(solids: Sequence[Solid], rng: np.random.Generator) -> Matter:
    """Walls and pieces of furniture, each in a colour of its own."""
    high = [solid for solid in solids if solid.name.startswith(("wall", "door"))]
    pieces: dict[str, list[Solid]] = {}
    for solid in solids:
        if solid not in high:
            pieces.setdefault(solid.name, []).append(solid)
    furniture = [_matter(piece, partial(_same, furniture_tint(rng))) for piece in pieces.values()]
    return _joined([_matter(high, partial(wall_tint, rng)), *furniture])


def _same(tint: Tint) -> Tint:
    return tint


def _matter(solids: Sequence[Solid], tint: Callable[[], Tint]) -> Matter:
    tints: dict[Material, Callable[[], Tint]] = {
        Material.MATT: tint,
        Material.GLASS: lambda: _GLASS,
        Material.MIRROR: lambda: _MIRROR,
    }
    surfaces = {
        material: joined(
            list(surfaces_of([solid for solid in solids if solid.material is material], tints[material]))
        )
        for material in Material
    }
    return Matter(surfaces, tuple(body for solid in solids for body in _bodies(solid)))


def _bodies(solid: Solid) -> Iterable[Convex]:
    for outline in convex_parts(solid):
        corners = np.concatenate(
            [np.column_stack((outline, np.full(len(outline), z))) for z in (solid.low_m, solid.height_m)]
        )
        yield Convex(solid.name, corners, _is_rectangle(outline))


def _is_rectangle(corners: Floats) -> bool:
    if len(corners) != 4:
        return False
    a, b, c, d = corners
    is_parallelogram = np.abs(a + c - b - d).max() < 1e-9
    return bool(is_parallelogram and abs(np.dot(b - a, d - a)) < 1e-9)


def _shortened(solids: Sequence[Solid], overhangs: Sequence[Solid]) -> list[Solid]:
    """Legs end below the plate that they carry: two faces at one place would flicker in the camera's eye."""
    plates = {plate.name: plate for plate in overhangs}
    return [
        replace(solid, height_m=plates[solid.name].low_m)
        if solid.name in plates and solid.low_m == 0.0 and solid.height_m == plates[solid.name].height_m
        else solid
        for solid in solids
    ]


def _edges(plan: WorldPlan) -> list[Solid]:
    """The world's edge is solid: four walls about its bounds, as high as the highest thing or higher."""
    x0, y0, x1, y1 = plan.bounds
    height = max(MAP_WALL_M, *(solid.height_m for solid in plan.solids), 0.0)
    t = _EDGE_THICKNESS_M
    boxes = (
        (x0 - t, y0 - t, x1 + t, y0),
        (x0 - t, y1, x1 + t, y1 + t),
        (x0 - t, y0, x0, y1),
        (x1, y0, x1 + t, y1),
    )
    return [Solid("the edge of the world", box_corners(*box), height) for box in boxes]


def _floor(bounds: tuple[float, float, float, float]) -> Surface:
    x0, y0, x1, y1 = bounds
    return slab(np.array([(x0, y0, 0.0), (x1, y0, 0.0), (x1, y1, 0.0), (x0, y1, 0.0)]), FLOOR)


def _ramp_matter(ramp: Ramp) -> Matter:
    corners = ramp.corners
    quads = [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (2, 3, 7, 6)]
    if ramp.level_m > 0.0:
        quads.append((4, 5, 6, 7))
    faces = [slab(corners[list(quad)], SILL) for quad in quads]
    return Matter({Material.MATT: joined(faces)}, (Convex(ramp.name, corners, is_box=False),))


def _map_matter(world: World, rng: np.random.Generator) -> Matter:
    """Walls round the open space of a map; only what borders on it can be seen or touched."""
    grid = world.floor
    size, (x0, y0) = grid.resolution_m, grid.origin_xy
    space = open_space(grid.free, size)
    rows, cols = space.shape
    walls = sides(grid_outline(~space, size, grid.origin_xy), 0.0, MAP_WALL_M, wall_tint(rng))
    boxes = boxes_of(~space)
    low = np.column_stack((boxes[:, 1], boxes[:, 0])) * size + (x0, y0)
    high = np.column_stack((boxes[:, 3], boxes[:, 2])) * size + (x0, y0)
    outlines = np.stack(
        (low, np.column_stack((high[:, 0], low[:, 1])), high, np.column_stack((low[:, 0], high[:, 1]))),
        axis=1,
    )
    lids = caps(outlines[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 2), MAP_WALL_M, EDGE, faces_up=True)
    floor = _floor((x0, y0, x0 + cols * size, y0 + rows * size))
    outside = box_corners(x0, y0, x0 + cols * size, y0 + rows * size)
    edge = _matter(_edges(WorldPlan("", (), (*outside[0], *outside[2]), None)), lambda: EDGE)
    tall = np.array((0.0, MAP_WALL_M))
    bodies = [
        Convex("a wall", np.column_stack((np.tile(outline, (2, 1)), np.repeat(tall, 4))), is_box=True)
        for outline in outlines
    ]
    return _joined([Matter({Material.MATT: joined([walls, lids, floor])}, tuple(bodies)), edge])


def _joined(parts: Sequence[Matter]) -> Matter:
    surfaces = {
        material: joined([part.surfaces[material] for part in parts if material in part.surfaces])
        for material in Material
    }
    return Matter(surfaces, tuple(body for part in parts for body in part.bodies))
