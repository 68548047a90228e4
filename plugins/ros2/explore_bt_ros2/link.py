"""One connection to ROS 2: context, node, and the thread that serves them."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Literal

import rclpy
from rclpy.context import Context
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.qos import QoSProfile, qos_policy_name_from_kind
from rclpy.signals import SignalHandlerOptions

from explore_bt.errors import PluginError
from explore_bt_ros2.transforms import tf_message_type

__all__ = ["Discovery", "Link"]

Discovery = Literal["localhost", "subnet", "system_default", "off"]
_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_IDLE_S = 0.1
_LAST_S = 2.0


class Link:
    """Everything one robot says and hears goes through one node, served by one single-threaded executor.

    Callbacks run in that thread and have to be quick. Publishing is fine from any thread.

    Args:
        name, namespace: of the node.
        domain: ROS domain; None: the environment's ``ROS_DOMAIN_ID``.
        discovery: how far nodes are looked for, where the environment does not say.

    Raises:
        PluginError: ROS 2 cannot be started like this.
    """

    def __init__(
        self, name: str, namespace: str = "", domain: int | None = None, discovery: Discovery = "localhost"
    ) -> None:
        self._context = Context()
        try:
            with _environment(_RANGE, discovery.upper()):
                rclpy.init(
                    args=[],
                    context=self._context,
                    domain_id=domain,
                    signal_handler_options=SignalHandlerOptions.NO,  # signals are the mission's
                )
                self.node = rclpy.create_node(
                    name,
                    namespace=namespace,
                    context=self._context,
                    start_parameter_services=False,
                    enable_rosout=False,
                )
        except Exception as error:  # whatever the middleware says
            self._context.try_shutdown()
            raise PluginError(f"ROS 2 cannot be started: {error}") from None
        self._tf_type: Any = None
        self._ending = threading.Event()
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._thread = threading.Thread(target=self._spin, name=f"ros2 {name}", daemon=True)
        self.mismatches: dict[str, str] = {}
        """Topic -> what the other side's QoS lacks, as the middleware reports it."""

    def start(self) -> None:
        """Begin to serve, once everything is subscribed to."""
        self._thread.start()

    def subscribe(
        self, kind: Any, topic: str, take: Callable[[Any], None], qos: QoSProfile, *, raw: bool = False
    ) -> Any:
        """Have ``take`` called with every message."""
        events = SubscriptionEventCallbacks(incompatible_qos=lambda info: self._note(topic, info, "offers"))
        return self.node.create_subscription(kind, topic, take, qos, raw=raw, event_callbacks=events)

    def publisher(self, kind: Any, topic: str, qos: QoSProfile) -> Any:
        """What can be published with."""
        events = PublisherEventCallbacks(incompatible_qos=lambda info: self._note(topic, info, "asks for"))
        return self.node.create_publisher(kind, topic, qos, event_callbacks=events)

    @property
    def tf_type(self) -> Any:
        """The message type of ``/tf``, for bytes."""
        if self._tf_type is None:
            self._tf_type = tf_message_type()
        return self._tf_type

    def full_name(self, topic: str) -> str:
        """The topic's name with the node's namespace."""
        return str(self.node.resolve_topic_name(topic))

    def close(self) -> None:
        """Leave the network; idempotent, and over within two seconds."""
        if self._ending.is_set():
            return
        self._ending.set()
        if self._thread.is_alive():
            self._executor.wake()
            self._thread.join(_LAST_S)
        self._executor.shutdown(timeout_sec=0.1)
        self.node.destroy_node()
        self._context.try_shutdown()

    def _note(self, topic: str, info: Any, does: str) -> None:
        policy = qos_policy_name_from_kind(info.last_policy_kind)
        self.mismatches[topic] = f"QoS mismatch: the other side {does} another {policy.lower()}"

    def _spin(self) -> None:
        while not self._ending.is_set():
            try:
                self._executor.spin_once(timeout_sec=_IDLE_S)
            except ExternalShutdownException:
                return
            except Exception as error:  # one bad callback must not make the robot deaf
                self.node.get_logger().error(f"a callback failed: {error!r}", throttle_duration_sec=1.0)


@contextmanager
def _environment(name: str, value: str) -> Iterator[None]:
    """Set a variable where nobody has, for as long as it takes the middleware to read it."""
    if name in os.environ:
        yield
        return
    os.environ[name] = value
    try:
        yield
    finally:
        del os.environ[name]
