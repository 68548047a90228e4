from __future__ import annotations

from explore_bt_slam import GroundTruthSlam, KissGtsam

from explore_bt.interfaces import Slam
from explore_bt.testing.slam_contract import SlamContract


class TestKissGtsam(SlamContract):
    takes_clouds = True

    def make(self) -> Slam:
        return KissGtsam(KissGtsam.Options())


class TestKissGtsamWithOdometry(SlamContract):
    takes_clouds = True

    def make(self) -> Slam:
        return KissGtsam(KissGtsam.Options(use_odometry=True))


class TestGroundTruth(SlamContract):
    tolerance_m = 0.01

    def make(self) -> Slam:
        return GroundTruthSlam(GroundTruthSlam.Options())
