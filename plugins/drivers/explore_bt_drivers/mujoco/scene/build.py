"""A world as a MuJoCo model to be, without the robot."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.atlas import Atlas
from explore_bt_drivers.mujoco.scene.groups import GeomGroup
from explore_bt_drivers.mujoco.scene.matter import Convex, Matter, fixed_matter, matter_of
from explore_bt_drivers.mujoco.scene.surface import Surface, joined
from explore_bt_drivers.people import Crowd
from explore_bt_drivers.world import Material, World

__all__ = ["HEAD_M", "PARKED_M", "SHOULDERS_M", "Scene", "build_scene"]

SHOULDERS_M, HEAD_M = 1.5, 0.13
"""A person is a post up to the shoulders and a ball of this radius on it."""

PARKED_M = -50.0
"""So far below the floor is what is out of the way."""

_GEOM = mujoco.mjtGeom
_CLOTHES = ((0.20, 0.33, 0.55), (0.55, 0.20, 0.22), (0.25, 0.42, 0.30), (0.50, 0.42, 0.20))
_SKIN = (0.80, 0.62, 0.50, 1.0)
_LOOKS = {
    Material.MATT: ("matt", GeomGroup.WORLD),
    Material.GLASS: ("glass", GeomGroup.GLASS),
    Material.MIRROR: ("mirror", GeomGroup.MIRROR),
}


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What becomes a model once the robot is in it, and what its sensors have to know of it.

    Attributes:
        spec: bodies and geoms; every body that moves is a mocap body.
        world: as drawn.
        fixed: surfaces of what never moves.
        stands: for each of the world's things its surfaces in each of its stands; ``stand_name`` is its body.
        crowd: who walks there; ``person_name`` is the body.
    """

    spec: mujoco.MjSpec
    world: World
    fixed: dict[Material, Surface]
    stands: tuple[tuple[dict[Material, Surface], ...], ...]
    crowd: Crowd

    @staticmethod
    def stand_name(thing: int, stand: int) -> str:
        """Name of the body that is a thing in one of its stands."""
        return f"thing {thing} stand {stand}"

    @staticmethod
    def person_name(person: int) -> str:
        """Name of a person's body."""
        return f"person {person}"


def build_scene(world: World, crowd: Crowd, rng: np.random.Generator) -> Scene:
    """Walls, floor, furniture, people; all surfaces textured, no two alike.

    Args:
        world: as drawn; a map's walls are 2.5 m high.
        crowd: who walks there.
        rng: paints.
    """
    spec = mujoco.MjSpec()
    spec.modelname = "world"
    fixed = fixed_matter(world, rng)
    stands = [
        [matter_of((*stand.solids, *stand.overhangs), rng) for stand in thing.stands]
        for thing in world.things
    ]
    everything = [fixed, *(matter for thing in stands for matter in thing)]
    uvs = _paint(spec, [matter.surfaces[Material.MATT] for matter in everything], rng)
    _add_matter(spec, spec.worldbody, "fixed", fixed, uvs[0])
    place = 1
    for thing, matters in enumerate(stands):
        for stand, matter in enumerate(matters):
            body = spec.worldbody.add_body(name=Scene.stand_name(thing, stand), mocap=True)
            _add_matter(spec, body, body.name, matter, uvs[place])
            place += 1
    _add_people(spec, crowd)
    _light(spec, world)
    surfaces = tuple(tuple(matter.surfaces for matter in matters) for matters in stands)
    return Scene(spec, world, fixed.surfaces, surfaces, crowd)


def _paint(
    spec: mujoco.MjSpec, surfaces: Sequence[Surface], rng: np.random.Generator
) -> list[NDArray[np.float64]]:
    """Materials, and for each surface where its vertices are in the texture of the matt one."""
    atlas = Atlas(joined(surfaces), rng)
    texture = spec.add_texture(name="paint", type=mujoco.mjtTexture.mjTEXTURE_2D, nchannel=3)
    texture.height, texture.width = atlas.pixels.shape[:2]
    # handed over by attribute: add_texture(data=...) prints all of it
    texture.data = atlas.pixels.tobytes()
    matt = spec.add_material(name="matt", specular=0.0, shininess=0.0, rgba=[1.0, 1.0, 1.0, 1.0])
    matt.textures[mujoco.mjtTextureRole.mjTEXROLE_RGB] = "paint"
    spec.add_material(name="glass", rgba=[0.65, 0.85, 0.90, 0.25], specular=0.8, shininess=0.9)
    spec.add_material(name="mirror", rgba=[0.72, 0.76, 0.80, 1.0], specular=0.9, shininess=0.9)
    ends = np.cumsum([len(surface.vertices) for surface in surfaces])
    return np.split(atlas.uv, ends[:-1])


def _add_matter(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, matter: Matter, uv: NDArray[np.float64]
) -> None:
    for material, surface in matter.surfaces.items():
        if len(surface.faces):
            look, group = _LOOKS[material]
            _add_surface(spec, body, f"{name} {look}", surface, uv if material is Material.MATT else None)
            body.geoms[-1].material, body.geoms[-1].group = look, group
    for number, convex in enumerate(matter.bodies):
        _add_body(spec, body, f"{name} {number}", convex)


def _add_surface(
    spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, surface: Surface, uv: NDArray[np.float64] | None
) -> None:
    """What is seen; it collides with nothing."""
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert = surface.vertices.astype(np.float32).ravel()
    mesh.userface = surface.faces.astype(np.int32).ravel()
    if uv is not None:
        mesh.usertexcoord = uv.astype(np.float32).ravel()
        mesh.userfacetexcoord = surface.faces.astype(np.int32).ravel()
    body.add_geom(type=_GEOM.mjGEOM_MESH, meshname=name, contype=0, conaffinity=0)


def _add_body(spec: mujoco.MjSpec, body: mujoco.MjsBody, name: str, convex: Convex) -> None:
    """What is run into; nobody sees it."""
    group = int(GeomGroup.UNSEEN)
    if convex.is_box:
        a, b, d, top = (convex.corners[k] for k in (0, 1, 3, 4))
        along, across = b - a, d - a
        size = np.array([math.hypot(*along), math.hypot(*across), top[2] - a[2]]) / 2.0
        middle = (convex.corners[0] + convex.corners[6]) / 2.0
        half_turn = math.atan2(along[1], along[0]) / 2.0
        quat = [math.cos(half_turn), 0.0, 0.0, math.sin(half_turn)]
        body.add_geom(type=_GEOM.mjGEOM_BOX, pos=middle, size=size, quat=quat, group=group)
        return
    mesh = spec.add_mesh(name=name)
    mesh.uservert = convex.corners.astype(np.float32).ravel()
    body.add_geom(type=_GEOM.mjGEOM_MESH, meshname=name, group=group)


def _add_people(spec: mujoco.MjSpec, crowd: Crowd) -> None:
    for person, radius_m in enumerate(crowd.ways.radii.tolist()):
        body = spec.worldbody.add_body(name=Scene.person_name(person), mocap=True)
        colour = (*_CLOTHES[person % len(_CLOTHES)], 1.0)
        half = SHOULDERS_M / 2.0
        body.add_geom(
            type=_GEOM.mjGEOM_CYLINDER, size=[radius_m, half, 0.0], pos=[0.0, 0.0, half], rgba=colour
        )
        head = [0.0, 0.0, SHOULDERS_M + HEAD_M]
        body.add_geom(type=_GEOM.mjGEOM_SPHERE, size=[HEAD_M, 0.0, 0.0], pos=head, rgba=_SKIN)


def _light(spec: mujoco.MjSpec, world: World) -> None:
    """The floor that carries, daylight from above, and figures of the renderer."""
    spec.worldbody.add_geom(
        name="floor", type=_GEOM.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], group=int(GeomGroup.UNSEEN)
    )
    sky = spec.add_texture(name="sky", type=mujoco.mjtTexture.mjTEXTURE_SKYBOX, width=64, height=384)
    sky.builtin = mujoco.mjtBuiltin.mjBUILTIN_GRADIENT
    sky.rgb1, sky.rgb2 = [0.80, 0.86, 0.92], [0.93, 0.95, 0.97]
    light = spec.worldbody.add_light(
        type=mujoco.mjtLightType.mjLIGHT_DIRECTIONAL, dir=[0.3, 0.5, -0.8], castshadow=False
    )
    light.diffuse, light.specular, light.ambient = [0.35] * 3, [0.0] * 3, [0.0] * 3
    spec.visual.headlight.ambient = [0.55] * 3
    spec.visual.headlight.diffuse = [0.25] * 3
    spec.visual.headlight.specular = [0.0] * 3
    spec.visual.quality.offsamples = 0
    spec.visual.quality.shadowsize = 0
    # zfar and znear are shares of the extent, which would else follow from the model's size
    spec.stat.extent = 1.0
    spec.stat.center = [*world.floor.center_of(world.floor.shape[0] // 2, world.floor.shape[1] // 2), 0.0]
    spec.visual.map.znear, spec.visual.map.zfar = 0.05, 100.0
