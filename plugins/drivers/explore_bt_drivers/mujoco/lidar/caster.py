"""Rays against surfaces: what every way of casting them has in common."""

from __future__ import annotations

import importlib.util
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.surface import Surface, joined
from explore_bt_drivers.world import Material

__all__ = ["Caster", "Floats", "best_caster", "sorted_surfaces"]

Floats = NDArray[np.float64]

_MOST_MIRRORS = 8
_OFF_MIRROR_M = 1e-4
"""A reflected ray begins so far in front of the mirror, that it does not meet it again by rounding."""


class Caster(ABC):
    """Surfaces that stand still; glass is left out of them."""

    @abstractmethod
    def first_hits(self, origins: Floats, directions: Floats) -> tuple[Floats, NDArray[np.bool_], Floats]:
        """Where rays end that are not reflected.

        Args:
            origins: (N, 3) float64, metres, ``map`` frame; those of one column follow each other.
            directions: (N, 3) float64 unit vectors.

        Returns:
            (N,) distances, +inf where nothing is met; (N,) whether a mirror was met; (N, 3) unit normals of
            mirrors that were met, of either sign.
        """

    def legs(
        self, origins: Floats, directions: Floats, limit_m: float
    ) -> Sequence[tuple[NDArray[np.int64], Floats, Floats, Floats]]:
        """The straight parts of beams, by way of mirrors.

        Returns:
            For each reflection, the direct way first: numbers of the beams that still go on (K,), where each
            begins and its direction (K, 3), and its length (K,); +inf where it leaves the scene.
        """
        beams = np.arange(len(origins))
        gone = np.zeros(len(origins))
        legs = []
        for _ in range(_MOST_MIRRORS):
            lengths, is_mirror, normals = self.first_hits(origins, directions)
            legs.append((beams, origins, directions, lengths))
            gone = gone + lengths
            on = is_mirror & (gone < limit_m)
            if not on.any():
                return legs
            beams, gone = beams[on], gone[on]
            origins = origins[on] + (lengths[on, None] - _OFF_MIRROR_M) * directions[on]
            directions, normals = directions[on], normals[on]
            directions = directions - 2.0 * (directions * normals).sum(axis=1, keepdims=True) * normals
        # what is still between mirrors is lost: its last leg has no end
        beams_before, before, along, lengths = legs[-1]
        legs[-1] = (beams_before, before, along, np.where(is_mirror, np.inf, lengths))
        return legs


def sorted_surfaces(parts: Sequence[Mapping[Material, Surface]]) -> tuple[Surface, Surface]:
    """All that is matt, and all that is a mirror."""
    matt, mirror = (
        joined([part[material] for part in parts if material in part])
        for material in (Material.MATT, Material.MIRROR)
    )
    return matt, mirror


def best_caster(parts: Sequence[Mapping[Material, Surface]]) -> Caster:
    """By Embree if it is installed, which is some times faster; else by MuJoCo."""
    if importlib.util.find_spec("embreex") is None:
        from explore_bt_drivers.mujoco.lidar.multi_ray import MultiRayCaster

        return MultiRayCaster(parts)
    from explore_bt_drivers.mujoco.lidar.embree import EmbreeCaster

    return EmbreeCaster(parts)
