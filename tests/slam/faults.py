"""Bad data for planar and 3D lidars alike, and what is asked of a SLAM that gets it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from explore_bt_slam import KissGtsam

from explore_bt.types import Health, Measurement, PointCloud, Scan2D

__all__ = ["Fault", "backwards", "check", "dropout", "faulty"]

Fault = Callable[[Any, np.random.Generator], list[Any]]
"""Takes a scan or a cloud and a random generator, gives what comes in its place."""


def dropout(scan: Any, rng: np.random.Generator) -> list[Any]:
    """Two seconds without a scan."""
    return [] if 4.0 < scan.stamp_s <= 6.0 else [scan]


def backwards(scan: Any, rng: np.random.Generator) -> list[Any]:
    """Every tenth scan claims to be half a second old."""
    is_late = round(10.0 * scan.stamp_s) % 10 == 0
    return [dataclasses.replace(scan, stamp_s=scan.stamp_s - 0.5) if is_late else scan]


def faulty(measured: Iterable[Measurement], fault: Fault) -> Iterator[Measurement]:
    """The measurements with every scan and cloud spoilt."""
    rng = np.random.default_rng(7)
    for each in measured:
        yield from fault(each, rng) if isinstance(each, Scan2D | PointCloud) else [each]


def check(slam: KissGtsam, robot: Any, measured: Iterable[Measurement]) -> None:
    """At every scan the pose is right to 10 cm or health is not ok; in the end it is right."""
    for measurement in measured:
        slam.update(measurement)
        if isinstance(measurement, Scan2D | PointCloud) and measurement.stamp_s == robot.time_s:
            estimate = slam.estimate()
            off_m = estimate.T_map_base.distance_to(robot.pose)
            assert off_m < 0.10 or estimate.health is not Health.OK, measurement.stamp_s
    assert slam.estimate().T_map_base.distance_to(robot.pose) < 0.10
