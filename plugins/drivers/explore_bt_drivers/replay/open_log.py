"""From a path to the reader of its format."""

from __future__ import annotations

from pathlib import Path

from explore_bt.errors import LogError
from explore_bt_drivers.replay.carmen_log import CarmenLog
from explore_bt_drivers.replay.log import MeasurementLog
from explore_bt_drivers.replay.options import ReplayOptions
from explore_bt_drivers.replay.recording_log import RecordingLog

__all__ = ["open_log"]

_MCAP = b"\x89MCAP0\r\n"
_BAG1 = b"#ROSBAG"
_SQLITE = b"SQLite format 3"


def open_log(options: ReplayOptions) -> MeasurementLog:
    """The reader for ``options.log``, known by its first bytes; nothing else is read yet.

    Raises:
        LogError: no such file, or part of a bag instead of the bag.
    """
    path = options.log
    begin = b"" if path.is_dir() else _first_bytes(path)
    if begin.startswith(_MCAP):
        if (path.parent / "metadata.yaml").is_file():
            raise LogError(f"{path}: part of a ROS 2 bag; give its folder, {path.parent}")
        return RecordingLog(path, options.robot, options.range_max)
    if begin.startswith(_SQLITE):
        raise LogError(
            f"{path}: a database; if it is part of a ROS 2 bag, give the bag's folder, {path.parent}"
        )
    if path.is_dir() or begin.startswith(_BAG1):
        # imported here: rosbags is an extra
        from explore_bt_drivers.replay.bag_log import BagLog

        images = (options.colour_topic, options.depth_topic)
        return BagLog(path, options.scan_topic, options.range_max, images)
    return CarmenLog(path, options.field_of_view, options.range_max, options.odom_lines)


def _first_bytes(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            return file.read(16)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise LogError(
            f"{path}: cannot be read ({reason}); give a log file or a ROS 2 bag's folder"
        ) from None
