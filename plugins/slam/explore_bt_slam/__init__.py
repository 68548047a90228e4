"""SLAM back ends: ``kiss_gtsam`` (lidar and gyro) and ``ground_truth`` (simulators and tests)."""

from explore_bt import hookimpl
from explore_bt_slam.ground_truth import GroundTruthSlam
from explore_bt_slam.kiss_gtsam import KissGtsam

__all__ = ["GroundTruthSlam", "KissGtsam"]


@hookimpl
def explore_bt_register() -> list[type]:
    """The plugins of this family."""
    return [KissGtsam, GroundTruthSlam]
