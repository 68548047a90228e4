"""The voxels as an OctoMap."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import PluginError
from explore_bt.files import write_whole
from explore_bt.interfaces import API_VERSION, Exporter, RobotProduct
from explore_bt.types import Voxels

__all__ = ["OctomapExporter", "octomap_bytes"]

_DEPTH = 16
_CENTRE = 1 << (_DEPTH - 1)
_FREE, _OCCUPIED, _INNER = 1, 2, 3


class OctomapExporter(Exporter):
    """Writes ``map.bt``, a binary OctoMap tree (Hornung et al. 2013), where SLAM has a 3D map."""

    name = "octomap"
    api_version = API_VERSION

    def export(self, product: RobotProduct, folder: Path) -> list[Path]:
        """Write every known voxel as occupied or free."""
        voxels = product.structure.voxels
        return [] if voxels is None else [write_whole(folder / "map.bt", octomap_bytes(voxels))]


def octomap_bytes(voxels: Voxels) -> bytes:
    """The file's content.

    After a text header each inner node stands in pre-order with 16 bits, two for each of its eight children
    (child 4 z + 2 y + x; the first in the lowest bits): 0 unknown, 1 free, 2 occupied, 3 an inner node that
    follows. Eight leaves of one kind are one leaf of the size above.

    Raises:
        PluginError: the map does not fit into the format's 2^16 voxels a side.
    """
    shifted = voxels.keys.astype(np.int64) + _CENTRE
    if shifted.size and (shifted.min() < 0 or shifted.max() >= 2 * _CENTRE):
        raise PluginError(f"the map is wider than the {2 * _CENTRE} voxels a side that an OctoMap holds")
    codes = _morton(shifted)
    order = np.argsort(codes)
    codes, kinds = codes[order], np.where(voxels.log_odds > 0.0, _OCCUPIED, _FREE)[order]
    leaves, inner_at, inner_bits = 0, [], []
    for depth in range(_DEPTH - 1, -1, -1):  # of the parents; the root is at 0
        parents, first = np.unique(codes >> 3, return_index=True)
        place = np.repeat(np.arange(len(parents)), np.diff(np.append(first, len(codes))))
        bits = np.zeros(len(parents), dtype=np.int64)
        np.bitwise_or.at(bits, place, kinds << (2 * (codes & 7)))
        leaves += int(np.count_nonzero(kinds != _INNER))
        whole = ((bits == 0x5555) | (bits == 0xAAAA)) & (depth > 0)
        leaves -= 8 * int(np.count_nonzero(whole))
        inner_at.append(
            np.column_stack((parents[~whole] << (3 * (_DEPTH - depth)), np.full((~whole).sum(), depth)))
        )
        inner_bits.append(bits[~whole])
        codes, kinds = parents, np.where(whole, bits & 3, _INNER)
    at, nodes = np.concatenate(inner_at), np.concatenate(inner_bits)
    preorder = np.lexsort((at[:, 1], at[:, 0]))
    header = (
        "# Octomap OcTree binary file\nid OcTree\n"
        f"size {leaves + len(nodes)}\nres {voxels.resolution_m:g}\ndata\n"
    )
    return header.encode() + nodes[preorder].astype("<u2").tobytes()


def _morton(keys: NDArray[np.int64]) -> NDArray[np.int64]:
    """(N,) 48-bit codes: the bits of x, y, z in turn, x lowest."""
    code = np.zeros(len(keys), dtype=np.int64)
    for bit in range(_DEPTH):
        for axis in range(3):
            code |= ((keys[:, axis] >> bit) & 1) << (3 * bit + axis)
    return code
