"""The state of a pipeline at one moment, ready to be written while the pipeline goes on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.mapper import KeptSweep
from explore_bt_slam.segments import write_segments
from explore_bt_slam.storage import Arrays, pack_keyframes, pack_sweeps, write_arrays

__all__ = ["FrozenState"]


@dataclass(frozen=True, slots=True, eq=False)
class FrozenState:
    """Keyframes and sweeps as they are, which never change; copies of all else.

    Attributes:
        arrays: everything but the two lists.
    """

    keyframes: Sequence[Keyframe]
    sweeps: Sequence[KeptSweep]
    arrays: Arrays

    def write(self, folder: Path, plugin: str, resolution_m: float) -> None:
        """One file, ``slam.npz``, as small as can be."""
        lists = {**pack_keyframes(self.keyframes), **pack_sweeps(self.sweeps)}
        write_arrays(folder, plugin, resolution_m, {**lists, **self.arrays})

    def write_quickly(self, folder: Path, plugin: str, resolution_m: float, before: Path | None) -> None:
        """The lists in files of their own; those that are full already are linked from ``before``."""
        write_arrays(folder, plugin, resolution_m, self.arrays, packed=False)
        write_segments(folder, before, "keyframes", self.keyframes, pack_keyframes)
        write_segments(folder, before, "sweeps", self.sweeps, pack_sweeps)
