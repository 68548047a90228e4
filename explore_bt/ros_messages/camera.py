"""An RGB-D camera among ROS topics: three that belong together, and frames made of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from explore_bt.ros_messages.image import COLOURS, DEPTHS, Lens, colour, depth_m
from explore_bt.ros_messages.image_pairs import ImagePairs
from explore_bt.ros_messages.messages import stamp_of
from explore_bt.ros_messages.mountings import Places
from explore_bt.types import RgbdFrame

__all__ = ["CAMERA_INFO", "IMAGE", "CameraStream", "CameraTopics", "choose_camera"]

IMAGE = "sensor_msgs/msg/Image"
CAMERA_INFO = "sensor_msgs/msg/CameraInfo"


@dataclass(frozen=True, slots=True)
class CameraTopics:
    """Names of a camera's topics, and the frame that both images are seen from."""

    colour: str
    depth: str
    info: str
    frame: str


def choose_camera(
    images: Sequence[str],
    infos: Sequence[str],
    asked: tuple[str | None, str | None],
    first_of: Callable[[str], Any],
    notes: list[str],
) -> CameraTopics | None:
    """The one colour and registered depth stream among these topics; why there is none goes to ``notes``.

    Depth is registered where its frame and size are the colour image's. The ``CameraInfo`` is the one beside
    the colour image (``…/camera_info``), or beside the depth image.

    Args:
        images: topics of this type.
        infos: the same, ``CameraInfo``.
        asked: colour and depth topic as the options name them; None: to be found.
        first_of: a topic's first message; None where it has none.
        notes: takes a sentence.
    """
    firsts = {topic: first_of(topic) for topic in images}
    views = [topic for topic, first in firsts.items() if first and first.encoding in COLOURS]
    depths = [topic for topic, first in firsts.items() if first and first.encoding in DEPTHS]
    pairs = [
        (view, depth)
        for view in views
        for depth in depths
        if asked[0] in (None, view) and asked[1] in (None, depth) and _registered(firsts[view], firsts[depth])
    ]
    if len(pairs) != 1:
        if images:
            notes.append(f"no images are played: {_why(firsts, pairs)}")
        return None
    view, depth = pairs[0]
    beside = [f"{topic.rpartition('/')[0]}/camera_info" for topic in (view, depth)]
    info = next((topic for topic in beside if topic in infos), None)
    if info is None:
        notes.append(f"no images are played: there is no CameraInfo on {beside[0]}")
        return None
    return CameraTopics(view, depth, info, str(firsts[view].header.frame_id))


class CameraStream:
    """Makes frames of a camera's messages, in the order they come.

    Args:
        topics: of the camera.
        mountings: where things are on the robot.
        notes: takes a sentence if the camera's place on the robot is unknown: then nothing is played, because
            an optical frame looks along z and is nowhere near ``base_link``.
    """

    def __init__(self, topics: CameraTopics, mountings: Places, notes: list[str]) -> None:
        self._topics = topics
        self._pairs: ImagePairs[Any] = ImagePairs()
        self._lens: Lens | None = None
        self._size = (0, 0)
        self._place = mountings.known(topics.frame)
        if self._place is None:
            notes.append(f'no images are played: nothing tells where frame "{topics.frame}" is on the robot')

    @property
    def topics(self) -> tuple[str, ...]:
        """What is to be given to ``take``; nothing if the camera's place is unknown."""
        named = (self._topics.colour, self._topics.depth, self._topics.info)
        return named if self._place is not None else ()

    def take(self, topic: str, message: Any) -> RgbdFrame | None:
        """A message; a frame if it completes one.

        Raises:
            ValueError: in words, what is wrong with an image or the intrinsics.
        """
        if topic == self._topics.info:
            if self._lens is None:
                self._lens = Lens.of(message, rectified="rect" in self._topics.colour.rpartition("/")[2])
                self._size = (int(message.width), int(message.height))
            return None
        stamp_s = stamp_of(message)
        pixels = colour(message) if topic == self._topics.colour else depth_m(message)
        if self._lens is not None and (pixels.shape[1], pixels.shape[0]) != self._size:
            raise ValueError(
                f"it has {pixels.shape[1]} × {pixels.shape[0]} pixels; {self._topics.info} is for "
                f"{self._size[0]} × {self._size[1]}"
            )
        pair = self._pairs.take(int(topic == self._topics.depth), stamp_s, (stamp_s, pixels))
        if pair is None or self._lens is None or self._place is None:
            return None
        (stamp_s, image), (_, depth) = pair
        lens = self._lens
        return RgbdFrame(
            stamp_s,
            lens.straighten(image, True),
            lens.straighten(depth, False),
            lens.fx,
            lens.fy,
            lens.cx,
            lens.cy,
            self._place,
            self._topics.frame,
        )


def _registered(view: Any, depth: Any) -> bool:
    same_frame = str(view.header.frame_id).lstrip("/") == str(depth.header.frame_id).lstrip("/")
    return same_frame and (view.width, view.height) == (depth.width, depth.height)


def _why(firsts: dict[str, Any], pairs: list[tuple[str, str]]) -> str:
    if pairs:
        found = ", ".join(" with ".join(pair) for pair in pairs)
        return f"several cameras, {found}; the options colour_topic and depth_topic say which"
    found = ", ".join(
        f"{topic} ({first.encoding}, {first.width} × {first.height}, frame {first.header.frame_id})"
        for topic, first in firsts.items()
        if first
    )
    return (
        f"there is no colour image ({', '.join(COLOURS)}) with a depth image ({', '.join(DEPTHS)}) of its "
        f"frame and size; found {found or 'empty topics'}"
    )
