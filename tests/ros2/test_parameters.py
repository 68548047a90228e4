"""Options out of Nav2's file of parameters."""

from __future__ import annotations

from tests.ros2 import ros  # isort: skip  # noqa: F401

import pytest
from explore_bt_ros2.options import Ros2Options
from explore_bt_ros2.parameters import with_parameters

from explore_bt.errors import PluginError

NAV2 = """
amcl: {ros__parameters: {use_sim_time: true, base_frame_id: base_footprint, scan_topic: front/scan}}
local_costmap: {local_costmap: {ros__parameters: {robot_radius: 0.18, global_frame: odom}}}
velocity_smoother: {ros__parameters: {max_velocity: [0.22, 0.0, 1.0], max_accel: [1.5, 0.0, 3.2]}}
"""


def read(tmp_path, text, **given):
    (tmp_path / "nav2.yaml").write_text(text)
    return with_parameters(Ros2Options(parameters=tmp_path / "nav2.yaml", **given))


def test_frames_topics_radius_limits_and_clock_are_taken_from_nav2s_nodes(tmp_path):
    options = read(tmp_path, NAV2)
    assert (options.use_sim_time, options.base_frame, options.scan_topic) == (
        True,
        "base_footprint",
        "front/scan",
    )
    assert (options.radius, options.speed, options.turn_rate) == (0.18, 0.22, 1.0)
    assert (options.acceleration, options.turn_acceleration) == (1.5, 3.2)
    assert options.map_frame == "map"  # a costmap's global_frame is something else


def test_what_the_mission_says_counts_more_than_our_node_than_others(tmp_path):
    text = NAV2 + "explore_bt: {ros__parameters: {scan_topic: scan_2, silence: 0.5}}\n"
    assert read(tmp_path, text).scan_topic == "scan_2"
    assert read(tmp_path, text).silence == 0.5
    assert read(tmp_path, text, scan_topic="scan_3").scan_topic == "scan_3"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (NAV2 + "bt: {ros__parameters: {robot_base_frame: base}}", r"amcl has base_frame 'base_footprint'"),
        ("a: {b: 1}", "there is no ros__parameters in it"),
        ("a: [", "cannot be read as a file of ros__parameters"),
        ("explore_bt: {ros__parameters: {scan_topc: a}}", "explore_bt has no parameter scan_topc"),
        ("c: {ros__parameters: {robot_radius: wide}}", "radius: .*found 'wide'"),
    ],
)
def test_a_file_at_fault_is_told_in_words(tmp_path, text, words):
    with pytest.raises(PluginError, match=words):
        read(tmp_path, text)
