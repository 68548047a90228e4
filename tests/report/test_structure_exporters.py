from __future__ import annotations

import dataclasses
import struct
from pathlib import Path

import numpy as np
import pytest

from explore_bt.errors import PluginError
from explore_bt.interfaces import RobotProduct
from explore_bt.report import G2oExporter, OctomapExporter, PcdExporter, PlyExporter
from explore_bt.types import MapStructure, PoseGraph2, Trajectory, Voxels

EXPORTERS = (PlyExporter, PcdExporter, OctomapExporter, G2oExporter)


def voxels() -> Voxels:
    """Noise, a wall, and a solid block of 8³ that an octree makes one leaf of."""
    rng = np.random.default_rng(7)
    noise = rng.integers(-60, 60, (300, 3))
    wall = np.stack(np.meshgrid(np.arange(100, 120), [5], np.arange(0, 30)), axis=-1).reshape(-1, 3)
    block = np.stack(np.meshgrid(*[np.arange(64, 72)] * 3), axis=-1).reshape(-1, 3)
    keys = np.unique(np.concatenate((noise, wall, block)), axis=0).astype(np.int32)
    log_odds = rng.choice([-1.2, 0.9, 3.5], len(keys)).astype(np.float32)
    log_odds[(keys >= 64).all(axis=1)] = 3.5
    return Voxels(keys, log_odds, 0.05)


def graph() -> PoseGraph2:
    rng = np.random.default_rng(8)
    roots = rng.normal(size=(4, 3, 3))
    information = roots @ roots.transpose(0, 2, 1)
    ends = np.array([(0, 1), (1, 2), (2, 3), (0, 3)])
    return PoseGraph2(rng.normal(size=(4, 3)), ends, rng.normal(size=(4, 3)), information)


@pytest.fixture
def product(flat_drive):
    nothing = Trajectory(np.empty(0), np.empty((0, 3)))
    grid = flat_drive.ticks[-1].robots[0].grid
    return RobotProduct("robot", grid, nothing, None, flat_drive.result, MapStructure(voxels(), graph()))


@pytest.mark.parametrize("exporter", EXPORTERS)
def test_a_map_without_such_a_structure_leaves_no_such_file(exporter, product, tmp_path):
    flat = dataclasses.replace(product, structure=MapStructure())
    assert exporter(exporter.Options()).export(flat, tmp_path) == []
    assert not list(tmp_path.iterdir())


def test_a_ply_holds_the_centres_of_the_occupied_voxels(product, tmp_path):
    (path,) = PlyExporter(PlyExporter.Options()).export(product, tmp_path)
    header, _, body = path.read_bytes().partition(b"end_header\n")
    lines = header.decode().splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    points = np.frombuffer(body, "<f4").reshape(-1, 3)
    assert f"element vertex {len(points)}" in lines
    assert_centres(points)


def test_a_pcd_holds_the_same(product, tmp_path):
    (path,) = PcdExporter(PcdExporter.Options()).export(product, tmp_path)
    header, _, body = path.read_bytes().partition(b"DATA binary\n")
    fields = dict(line.split(" ", 1) for line in header.decode().splitlines() if not line.startswith("#"))
    points = np.frombuffer(body, "<f4").reshape(-1, 3)
    assert fields["POINTS"] == fields["WIDTH"] == str(len(points))
    assert (fields["FIELDS"], fields["SIZE"], fields["TYPE"]) == ("x y z", "4 4 4", "F F F")
    assert_centres(points)


def assert_centres(points: np.ndarray) -> None:
    given = voxels()
    found = np.unique(np.floor(points / 0.05).astype(int), axis=0)
    assert np.array_equal(found, given.keys[given.log_odds > 0.0])
    assert len(found) == len(points)


def test_an_octomap_reads_back_voxel_by_voxel(product, tmp_path):
    (path,) = OctomapExporter(OctomapExporter.Options()).export(product, tmp_path)
    tree = OctomapReader(path)
    given = voxels()
    assert tree.resolution_m == 0.05
    assert tree.voxels == {
        tuple(key): value > 0.0 for key, value in zip(given.keys.tolist(), given.log_odds, strict=True)
    }
    assert tree.size == tree.nodes
    assert tree.largest_leaf == 8


def test_an_empty_octomap_is_one(tmp_path, product):
    nothing = Voxels(np.zeros((0, 3), np.int32), np.zeros(0, np.float32), 0.1)
    empty = dataclasses.replace(product, structure=MapStructure(nothing))
    (path,) = OctomapExporter(OctomapExporter.Options()).export(empty, tmp_path)
    assert path.read_bytes().endswith(b"size 0\nres 0.1\ndata\n")


def test_a_map_too_wide_for_the_format_is_refused(tmp_path, product):
    wide = Voxels(np.array([[40_000, 0, 0]], np.int32), np.ones(1, np.float32), 0.05)
    with pytest.raises(PluginError, match="65536"):
        OctomapExporter(OctomapExporter.Options()).export(
            dataclasses.replace(product, structure=MapStructure(wide)), tmp_path
        )


class OctomapReader:
    """A recursive reader, written from the description of the format and of its child order."""

    def __init__(self, path: Path) -> None:
        text, _, self._data = path.read_bytes().partition(b"data\n")
        lines = text.decode().splitlines()
        assert lines[0] == "# Octomap OcTree binary file"
        header = dict(line.split(" ", 1) for line in lines[1:])
        assert header["id"] == "OcTree"
        self.size, self.resolution_m = int(header["size"]), float(header["res"])
        self.voxels: dict[tuple[int, int, int], bool] = {}
        self.nodes, self.largest_leaf, self._at = 1, 0, 0
        self._read((-32768, -32768, -32768), 65536)
        assert self._at == len(self._data)

    def _read(self, corner: tuple[int, int, int], side: int) -> None:
        low, high = struct.unpack_from("BB", self._data, self._at)
        self._at += 2
        half, inner = side // 2, []
        for child in range(8):
            byte, place = (low, child) if child < 4 else (high, child - 4)
            first, second = byte >> (2 * place) & 1, byte >> (2 * place + 1) & 1
            offset = (child & 1, child >> 1 & 1, child >> 2 & 1)
            at = tuple(c + half * o for c, o in zip(corner, offset, strict=True))
            if first and second:
                inner.append(at)
            elif first or second:
                self._leaf(at, half, bool(second))
            self.nodes += first or second
        for at in inner:
            self._read(at, half)

    def _leaf(self, corner: tuple[int, ...], side: int, occupied: bool) -> None:
        self.largest_leaf = max(self.largest_leaf, side)
        for index in np.ndindex(side, side, side):
            x, y, z = (int(c + i) for c, i in zip(corner, index, strict=True))
            self.voxels[x, y, z] = occupied


def test_a_g2o_file_has_the_graph_in_it(product, tmp_path):
    (path,) = G2oExporter(G2oExporter.Options()).export(product, tmp_path)
    given = graph()
    rows = [line.split() for line in path.read_text().splitlines()]
    vertices = np.array([[float(v) for v in row[1:]] for row in rows if row[0] == "VERTEX_SE2"])
    edges = np.array([[float(v) for v in row[1:]] for row in rows if row[0] == "EDGE_SE2"])
    assert np.array_equal(vertices[:, 0], np.arange(4))
    np.testing.assert_allclose(vertices[:, 1:], given.poses, rtol=1e-8)
    assert np.array_equal(edges[:, :2], given.ends)
    np.testing.assert_allclose(edges[:, 2:5], given.relatives, rtol=1e-8)
    upper = given.information[:, [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]]
    np.testing.assert_allclose(edges[:, 5:], upper, rtol=1e-8)
