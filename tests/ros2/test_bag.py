"""A bag of what a robot on ROS 2 said becomes a map."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

from pathlib import Path

from explore_bt_ros2.link import Link
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore
from sensor_msgs.msg import Imu, LaserScan
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.maps import read_map
from tests.ros2.processes import until
from tests.ros2.worlds import robot_in

MISSIONS = Path(__file__).parents[2] / "missions"
SENSOR = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT)
KEPT = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def test_what_a_robot_said_is_mapped_from_its_bag(tmp_path):
    heard: list[tuple[str, bytes]] = []
    link = Link("recorder")
    topics = {
        "scan": (LaserScan, "sensor_msgs/msg/LaserScan", SENSOR),
        "imu": (Imu, "sensor_msgs/msg/Imu", SENSOR),
        "odom": (Odometry, "nav_msgs/msg/Odometry", SENSOR),
        "/tf_static": (link.tf_type, "tf2_msgs/msg/TFMessage", KEPT),
    }
    for topic, (kind, _, qos) in topics.items():
        link.subscribe(kind, topic, lambda data, topic=topic: heard.append((topic, data)), qos, raw=True)
    link.start()
    try:
        with robot_in(MISSIONS / "01_apartment.yaml", "--speed", "2"):
            until(lambda: sum(topic == "scan" for topic, _ in heard) >= 20, 15.0, "twenty scans")
    finally:
        link.close()

    store = get_typestore(Stores.ROS2_JAZZY)
    with Writer(tmp_path / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as bag:
        opened = {
            topic: bag.add_connection("/" + topic.lstrip("/"), name, typestore=store)
            for topic, (_, name, _) in topics.items()
        }
        for number, (topic, data) in enumerate(heard):
            bag.write(opened[topic], number * 1_000_000, data)
    ran = CliRunner().invoke(app, ["slam", str(tmp_path / "bag"), "--out", str(tmp_path / "out")])
    assert ran.exit_code == 0, ran.output
    assert "base_link" not in ran.output  # tf_static told where the lidar sits
    assert read_map(tmp_path / "out" / "map.yaml").free.sum() > 1000
