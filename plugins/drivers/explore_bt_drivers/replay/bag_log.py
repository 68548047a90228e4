"""ROS 1 and ROS 2 bags, read with the ``rosbags`` library; no ROS is needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from explore_bt.errors import LogError
from explore_bt.ros_messages import (
    CAMERA_INFO,
    IMAGE,
    MESSAGES,
    TRANSFORMS,
    CameraStream,
    Mountings,
    choose_camera,
)
from explore_bt.types import Measurement, RgbdFrame
from explore_bt_drivers.replay.log import MeasurementLog

__all__ = ["BagLog"]

_MOVING_MESSAGES = 500
_LIDARS = ("sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2")


class BagLog(MeasurementLog):
    """A ROS 1 bag (a file) or a ROS 2 bag (a folder): LaserScan, PointCloud2, Imu, Odometry, Image, tf.

    Of each kind one topic is played, of images colour and registered depth with their ``CameraInfo``. Where a
    sensor sits is taken from ``tf_static``, or from ``tf`` where the first 500 messages there agree; a sensor
    whose frame nothing ties to the robot's base is taken to sit in ``base_link``, and ``notes`` says so.

    Args:
        path: file or folder.
        scan_topic: the lidar's topic; None: the only LaserScan topic, else the only PointCloud2 topic.
        range_max_m: from there on a range means "no return"; None: each scan's own ``range_max``.
        image_topics: colour and depth; None: the only ones that fit.
    """

    def __init__(
        self,
        path: Path,
        scan_topic: str | None = None,
        range_max_m: float | None = None,
        image_topics: tuple[str | None, str | None] = (None, None),
    ) -> None:
        super().__init__(path)
        self._scan_topic = scan_topic
        self._range_max_m = range_max_m
        self._image_topics = image_topics
        self._read_messages, self._messages = 0, 0

    @property
    def progress(self) -> float:
        """Share of the messages."""
        return self._read_messages / self._messages if self._messages else 0.0

    def _read(self) -> Iterator[Measurement]:
        with ExitStack() as open_until_end:
            bag = self._opened(open_until_end)
            self._messages = sum(connection.msgcount for connection in bag.connections)
            played = self._choose_topics(bag.connections)
            mountings = self._learnt_mountings(bag)
            camera = self._camera(bag, mountings)
            seen = camera.topics if camera else ()
            for connection, _, data in self._raw(bag, ()):
                self._read_messages += 1
                if camera and connection.topic in seen:
                    frame = self._frame(camera, connection, self._message(bag, connection, data))
                    if frame is not None:
                        yield frame
                elif connection.topic in played:
                    message = self._message(bag, connection, data)
                    yield self._measurement(connection, message, mountings)
                else:
                    self.passed_over[connection.topic] += 1

    def _opened(self, stack: ExitStack) -> Any:
        try:
            from rosbags.highlevel import AnyReader
            from rosbags.typesys import Stores, get_typestore
        except ImportError:
            raise LogError(
                f'{self.path}: reading ROS bags needs the library rosbags; pip install "explore-bt[bags]"'
            ) from None
        if self.path.is_dir() and not (self.path / "metadata.yaml").is_file():
            raise LogError(f"{self.path}: a folder without metadata.yaml; expected a ROS 2 bag")
        try:
            return stack.enter_context(
                AnyReader([self.path], default_typestore=get_typestore(Stores.ROS2_HUMBLE))
            )
        except Exception as fault:  # whatever the library meets in a damaged file
            raise LogError(
                f"{self.path}: cannot be opened as a ROS bag ({_words(fault)}); a bag that is cut off or was "
                "never closed needs rosbag reindex or ros2 bag reindex"
            ) from None

    def _choose_topics(self, connections: Sequence[Any]) -> set[str]:
        topics = {kind: _topics(connections, kind) for kind in MESSAGES}
        lidars = [topic for kind in _LIDARS for topic in topics[kind]]
        if self._scan_topic is not None:
            if self._scan_topic not in lidars:
                known = ", ".join(lidars) or "none"
                raise LogError(f'{self.path}: no lidar topic "{self._scan_topic}"; lidar topics are {known}')
            chosen = {self._scan_topic}
        else:
            candidates = next((topics[kind] for kind in _LIDARS if topics[kind]), [])
            if not candidates:
                found = ", ".join(sorted({each.topic for each in connections})) or "nothing"
                raise LogError(f"{self.path}: no LaserScan or PointCloud2 in it; topics are {found}")
            chosen = {self._only(candidates, "scan_topic says which")}
        for kind in MESSAGES:
            if kind not in _LIDARS and topics[kind]:
                chosen.add(topics[kind][0])
                self.notes += [f"{topic} is not played: {topics[kind][0]} is" for topic in topics[kind][1:]]
        return chosen

    def _camera(self, bag: Any, mountings: Mountings) -> CameraStream | None:
        images, infos = (_topics(bag.connections, kind) for kind in (IMAGE, CAMERA_INFO))
        for topic in filter(None, self._image_topics):
            if topic not in images:
                known = ", ".join(images) or "none"
                raise LogError(f'{self.path}: no image topic "{topic}"; image topics are {known}')

        def first_of(topic: str) -> Any:
            connections = [each for each in bag.connections if each.topic == topic and each.msgcount]
            found = next(self._raw(bag, connections), None) if connections else None
            return None if found is None else self._message(bag, found[0], found[2])

        chosen = choose_camera(images, infos, self._image_topics, first_of, self.notes)
        if chosen is None and any(self._image_topics):
            raise LogError(f"{self.path}: {self.notes[-1]}")
        return CameraStream(chosen, mountings, self.notes) if chosen else None

    def _only(self, topics: Sequence[str], hint: str) -> str:
        if len(topics) > 1:
            raise LogError(f"{self.path}: several lidars, {', '.join(topics)}; the option {hint}")
        return topics[0]

    def _raw(self, bag: Any, connections: Sequence[Any]) -> Iterator[tuple[Any, int, bytes]]:
        """Messages of these connections, of all where none are named."""
        messages = bag.messages(connections) if connections else bag.messages()
        index = 0
        while True:
            try:
                found = next(messages, None)
            except Exception as fault:  # whatever the library meets in a damaged file
                raise LogError(
                    f"{self.path}: damaged after message {index} of {self._messages} ({_words(fault)})"
                ) from None
            if found is None:
                return
            index += 1
            yield found

    def _message(self, bag: Any, connection: Any, data: bytes) -> Any:
        try:
            return bag.deserialize(data, connection.msgtype)
        except Exception as fault:  # the same
            raise self._fault(connection, _words(fault)) from None

    def _learnt_mountings(self, bag: Any) -> Mountings:
        mountings = Mountings(self.notes)
        transforms = _of_type(bag.connections, TRANSFORMS)
        static = [each for each in transforms if each.topic.endswith("tf_static")]
        moving = [each for each in transforms if each not in static]
        for connections, learn in ((static, mountings.learn), (moving, mountings.watch)):
            found = self._raw(bag, connections) if connections else iter(())
            for connection, _, data in islice(found, None if learn == mountings.learn else _MOVING_MESSAGES):
                message = self._message(bag, connection, data)
                try:
                    learn(message)
                except ValueError as fault:
                    raise LogError(f"{self.path}: a message on {connection.topic}: {fault}") from None
        return mountings

    def _measurement(self, connection: Any, message: Any, mountings: Mountings) -> Measurement:
        with self._told(connection):
            return MESSAGES[connection.msgtype](message, mountings, self._range_max_m)

    def _frame(self, camera: CameraStream, connection: Any, message: Any) -> RgbdFrame | None:
        with self._told(connection):
            return camera.take(connection.topic, message)

    @contextmanager
    def _told(self, connection: Any) -> Iterator[None]:
        """What does not fit in a message, as an error that names it."""
        try:
            with np.errstate(all="ignore"):  # what overflows in a damaged message is infinite afterwards
                yield
        except ValueError as fault:
            raise self._fault(connection, str(fault)) from None

    def _fault(self, connection: Any, words: str) -> LogError:
        place = f"message {self._read_messages} of {self._messages}, on {connection.topic}"
        return LogError(f"{self.path}: {place} ({connection.msgtype}): {words}")


def _of_type(connections: Sequence[Any], kind: str) -> list[Any]:
    return [each for each in connections if each.msgtype == kind]


def _topics(connections: Sequence[Any], kind: str) -> list[str]:
    return sorted({each.topic for each in _of_type(connections, kind)})


def _words(fault: Exception) -> str:
    return f"{type(fault).__name__}: {fault}"
