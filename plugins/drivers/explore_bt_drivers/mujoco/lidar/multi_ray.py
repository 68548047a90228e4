"""Rays by MuJoCo: a call for every origin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.lidar.caster import Caster, Floats, sorted_surfaces
from explore_bt_drivers.mujoco.scene.surface import Surface
from explore_bt_drivers.world import Material

__all__ = ["MultiRayCaster"]

_EVERYTHING = 1e10
_MIRROR = "mirror"


class MultiRayCaster(Caster):
    """A model of its own, of surfaces only, so that rays neither wait for the robot nor meet it."""

    def __init__(self, parts: Sequence[Mapping[Material, Surface]]) -> None:
        spec = mujoco.MjSpec()
        for name, surface in zip(("matt", _MIRROR), sorted_surfaces(parts), strict=True):
            if len(surface.faces):
                mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
                mesh.uservert = surface.vertices.astype(np.float32).ravel()
                mesh.userface = surface.faces.astype(np.int32).ravel()
                spec.worldbody.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        mujoco.mj_forward(self._model, self._data)
        names = [self._model.geom(k).name for k in range(self._model.ngeom)]
        self._mirror = names.index(_MIRROR) if _MIRROR in names else -1

    def first_hits(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.bool_], Floats]:
        """Rays that follow each other from one origin go in one call."""
        count = len(origins)
        lengths, normals = np.empty(count), np.empty((count, 3))
        geoms = np.empty(count, dtype=np.int32)
        moved = np.flatnonzero((origins[1:] != origins[:-1]).any(axis=1)) + 1
        for begin, end in zip([0, *moved.tolist()], [*moved.tolist(), count], strict=True):
            mujoco.mj_multiRay(
                self._model,
                self._data,
                origins[begin],
                directions[begin:end].ravel(),
                None,
                True,
                -1,
                geoms[begin:end],
                lengths[begin:end],
                normals[begin:end].reshape(-1),
                end - begin,
                _EVERYTHING,
            )
        is_hit = geoms >= 0
        return np.where(is_hit, lengths, np.inf), is_hit & (geoms == self._mirror), normals
