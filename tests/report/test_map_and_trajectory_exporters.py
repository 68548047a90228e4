from __future__ import annotations

import math

import numpy as np
import pytest

from explore_bt.interfaces import RobotProduct
from explore_bt.maps import read_map
from explore_bt.report import EXPORTERS, MapServerExporter, TumExporter
from explore_bt.types import Trajectory


@pytest.fixture
def product(flat_drive):
    rng = np.random.default_rng(2)
    poses = np.column_stack((rng.normal(0, 50, (40, 2)), rng.uniform(-math.pi, math.pi, 40)))
    estimate = Trajectory(np.arange(40) * 0.1, poses)
    return RobotProduct("robot", flat_drive.ticks[-1].robots[0].grid, estimate, estimate, flat_drive.result)


def test_the_exported_map_reads_back_as_it_was(product, tmp_path):
    files = MapServerExporter(MapServerExporter.Options()).export(product, tmp_path)
    assert sorted(path.name for path in files) == ["map.pgm", "map.yaml"]
    np.testing.assert_array_equal(read_map(tmp_path / "map.yaml").cells, product.grid.cells)


def test_a_tum_line_is_stamp_position_and_unit_quaternion(product, tmp_path):
    files = TumExporter(TumExporter.Options()).export(product, tmp_path)
    assert [path.name for path in files] == ["trajectory.tum", "truth.tum"]
    table = np.loadtxt(tmp_path / "trajectory.tum")
    np.testing.assert_allclose(table[:, 0], product.trajectory.stamps_s, atol=1e-6)
    np.testing.assert_allclose(table[:, 1:3], product.trajectory.poses[:, :2], atol=1e-6)
    np.testing.assert_array_equal(table[:, 3:6], 0.0)
    np.testing.assert_allclose(np.hypot(table[:, 6], table[:, 7]), 1.0, atol=1e-8)
    np.testing.assert_allclose(
        2 * np.arctan2(table[:, 6], table[:, 7]), product.trajectory.poses[:, 2], atol=1e-8
    )


def test_without_a_truth_there_is_no_truth_file(product, tmp_path):
    blind = RobotProduct("robot", product.grid, product.trajectory, None, product.result)
    files = TumExporter(TumExporter.Options()).export(blind, tmp_path)
    assert [path.name for path in files] == ["trajectory.tum"]


def test_a_robot_that_never_moved_leaves_an_empty_trajectory(product, tmp_path):
    nothing = Trajectory(np.empty(0), np.empty((0, 3)))
    TumExporter(TumExporter.Options()).export(
        RobotProduct("robot", product.grid, nothing, None, product.result), tmp_path
    )
    assert (tmp_path / "trajectory.tum").read_text() == ""


def test_exporters_name_themselves():
    assert {(exporter.kind, exporter.name) for exporter in EXPORTERS} == {
        ("exporter", "g2o"),
        ("exporter", "map_server"),
        ("exporter", "octomap"),
        ("exporter", "pcd"),
        ("exporter", "ply"),
        ("exporter", "tum"),
    }
