"""``ros2_map`` by the contract of all SLAMs: a neighbour makes map and tf, and they come over the network."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

from collections.abc import Iterator

import pytest
from explore_bt_ros2.clock import SimTimeClock
from explore_bt_ros2.connection import Connection
from explore_bt_ros2.grids import grid_message
from explore_bt_ros2.link import Link
from explore_bt_ros2.neighbour_map import Ros2Map
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.transforms import Transform, TransformBuffer, decode, encode
from explore_bt_slam import KissGtsam
from nav_msgs.msg import OccupancyGrid as GridMessage
from rclpy.qos import DurabilityPolicy, QoSProfile

from explore_bt.interfaces import RobotContext, Slam
from explore_bt.testing.slam_contract import SlamContract
from explore_bt.types import Health, Measurement, PointCloud, Pose2, Scan2D
from tests.ros2.processes import until

KEPT = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
DISCOVERY_S = 20.0


class Neighbour:
    """Somebody's SLAM: publishes what it knows after every scan, and nothing while it is lost."""

    def __init__(self, context: RobotContext, namespace: str) -> None:
        self._slam = KissGtsam(KissGtsam.Options())
        self._slam.setup(context)
        self.link = Link("neighbour", namespace)
        self._tf = self.link.publisher(self.link.tf_type, "tf", QoSProfile(depth=10))
        self._map = self.link.publisher(GridMessage, "map", KEPT)
        self.link.start()
        self._revision = -1

    def is_heard(self) -> bool:
        return all(each.get_subscription_count() for each in (self._tf, self._map))

    def hear(self, measured: Measurement) -> tuple[bool, bool]:
        """Whether it published tf, and a map."""
        self._slam.update(measured)
        estimate = self._slam.estimate()
        if not isinstance(measured, Scan2D | PointCloud) or estimate.health is not Health.OK:
            return False, False
        self._tf.publish(
            encode(
                [
                    Transform.planar(measured.stamp_s, "map", "odom", Pose2.identity()),
                    Transform.planar(measured.stamp_s, "odom", "base_link", estimate.T_map_base),
                ]
            )
        )
        grid = self._slam.grid()
        news, self._revision = grid.revision != self._revision, grid.revision
        if news:
            self._map.publish(grid_message(GridMessage(), grid))
        return True, news


class Neighboured(Ros2Map):
    """With a neighbour that hears every measurement before it does."""

    def setup(self, context: RobotContext) -> None:
        namespace = f"robot_{id(self)}"  # a test may have two
        self.neighbour = Neighbour(context, namespace)
        clock, buffer = SimTimeClock(), TransformBuffer()
        clock.tell(0.0)
        self.link = Link("explore_bt", namespace)
        super().setup(
            RobotContext(
                start=context.start,
                footprint_radius_m=context.footprint_radius_m,
                connection=Connection(self.link, clock, buffer, Ros2Options()),
            )
        )
        self.buffer, self._arrived = buffer, 0
        learn = buffer.learn
        self.link.subscribe(
            self.link.tf_type, "tf", lambda data: learn(decode(data)), QoSProfile(depth=10), raw=True
        )
        self.link.start()
        until(self.neighbour.is_heard, DISCOVERY_S, "each has found the other")

    def update(self, measurement: Measurement) -> None:
        arrived = self._arrived
        tf, news = self.neighbour.hear(measurement)
        if tf:
            heard_s = measurement.stamp_s
            until(lambda: (self.buffer.newest_s("map", "base_link") or -1.0) >= heard_s, 5.0, "tf comes")
        if news:
            until(lambda: self._arrived > arrived, 5.0, "the map comes")
        super().update(measurement)

    def _hear(self, message: object) -> None:
        super()._hear(message)
        self._arrived += 1

    def close(self) -> None:
        self.link.close()
        self.neighbour.link.close()


class TestRos2Map(SlamContract):
    """The neighbour is our own SLAM; what is put to the test is all that lies between it and the mission."""

    @pytest.fixture(autouse=True)
    def _made(self) -> Iterator[None]:
        self.made: list[Neighboured] = []
        yield
        for each in self.made:
            if hasattr(each, "neighbour"):
                each.close()

    takes_clouds = True

    def make(self) -> Slam:
        slam = Neighboured(Ros2Map.Options(tf_timeout=0.25))
        self.made.append(slam)
        return slam
