"""A goal on its way to Nav2: by its action, or by a topic."""

from __future__ import annotations

import enum
import threading
import time
from abc import ABC, abstractmethod
from typing import Any

from geometry_msgs.msg import PoseStamped
from rclpy.qos import QoSProfile

from explore_bt_ros2.link import Link

__all__ = ["ActionGoal", "Goal", "GoalState", "TopicGoal"]

_SILENT_S = 2.0
"""Nav2 gives feedback many times a second; the network notices a killed node much later."""


class GoalState(enum.Enum):
    """How a goal is getting on; ``AWAY``: nobody is there who knows of it."""

    DRIVING = enum.auto()
    DONE = enum.auto()
    FAILED = enum.auto()
    AWAY = enum.auto()


class Goal(ABC):
    """The newest goal; a new one replaces it."""

    knows_arrival = True
    """Whether the other side says when it is there."""

    @property
    def is_taken(self) -> bool:
        """Whether the other side has said that it goes there."""
        return True

    @property
    @abstractmethod
    def is_there(self) -> bool:
        """Whether somebody listens."""

    @abstractmethod
    def send(self, pose: Any) -> None:
        """Go there (``PoseStamped``)."""

    @abstractmethod
    def cancel(self) -> None:
        """Go nowhere."""

    @abstractmethod
    def state(self) -> tuple[GoalState, str]:
        """How it is getting on, and what there is to say."""


class TopicGoal(Goal):
    """``/goal_pose``, as RViz sends it: nothing comes back."""

    knows_arrival = False

    def __init__(self, link: Link, topic: str) -> None:
        self._topic = link.full_name(topic)
        self._publisher = link.publisher(PoseStamped, topic, QoSProfile(depth=1))

    @property
    def is_there(self) -> bool:
        """Whether anyone has subscribed."""
        return int(self._publisher.get_subscription_count()) > 0

    def send(self, pose: Any) -> None:
        """Publish it."""
        self._sent = self.is_there
        self._publisher.publish(pose)

    def cancel(self) -> None:
        """Cannot be done by a topic: what Nav2 goes on to command is not passed on."""

    def state(self) -> tuple[GoalState, str]:
        """Driving, if somebody heard it."""
        if self._sent and self.is_there:
            return GoalState.DRIVING, ""
        return GoalState.AWAY, f"nobody listens to {self._topic}"


class ActionGoal(Goal):
    """``NavigateToPose``, with feedback, cancel and result.

    Callbacks come in the ROS thread; those of a goal that has been replaced are not heard.
    """

    def __init__(self, link: Link, action: str, behavior_tree: str) -> None:
        from nav2_msgs.action import NavigateToPose
        from rclpy.action import ActionClient

        self._kind = NavigateToPose
        self._behavior_tree = behavior_tree
        self._name = link.full_name(action)
        self._client = ActionClient(link.node, NavigateToPose, action)
        self._lock = threading.Lock()
        self._number = 0
        self._handle: Any = None
        self._heard_s = 0.0
        self._state, self._words = GoalState.AWAY, ""

    @property
    def is_taken(self) -> bool:
        """Whether the server has accepted it."""
        return self._handle is not None

    @property
    def is_there(self) -> bool:
        """Whether the action's server is; one that was killed seems to be for some seconds."""
        return bool(self._client.server_is_ready())

    def send(self, pose: Any) -> None:
        """Send it; what became of the one before is not heard any more."""
        with self._lock:
            self._number += 1
            number, self._handle = self._number, None
            if not self.is_there:
                self._state, self._words = GoalState.AWAY, ""
                return
            self._state, self._words = GoalState.DRIVING, "the goal is sent to Nav2"
            self._heard_s = time.monotonic()
        goal = self._kind.Goal()
        goal.pose, goal.behavior_tree = pose, self._behavior_tree
        answer = self._client.send_goal_async(goal, lambda told: self._on_feedback(number, told.feedback))
        answer.add_done_callback(lambda done: self._on_answer(number, done.result()))

    def cancel(self) -> None:
        """Ask for the cancel; what comes of it does not matter any more."""
        with self._lock:
            handle, self._handle = self._handle, None
            self._number += 1
            self._state, self._words = GoalState.AWAY, ""
        if handle is not None:
            handle.cancel_goal_async()

    def state(self) -> tuple[GoalState, str]:
        """As the server says, while it is there."""
        with self._lock:
            silent = time.monotonic() - self._heard_s > _SILENT_S
            if self._state is GoalState.DRIVING and (silent or not self.is_there):
                self._state, self._handle = GoalState.AWAY, None
            if self._state is GoalState.AWAY:
                return GoalState.AWAY, f"Nav2's action {self._name} is not there"
            return self._state, self._words

    def _on_answer(self, number: int, handle: Any) -> None:
        with self._lock:
            if number != self._number:
                if handle.accepted:
                    handle.cancel_goal_async()  # it was replaced or cancelled while under way
                return
            if not handle.accepted:
                self._state, self._words = GoalState.FAILED, "Nav2 has rejected the goal"
                return
            self._handle, self._words = handle, "Nav2 has taken the goal"
            self._heard_s = time.monotonic()
        handle.get_result_async().add_done_callback(lambda done: self._on_result(number, done.result()))

    def _on_feedback(self, number: int, feedback: Any) -> None:
        with self._lock:
            if number == self._number and self._state is GoalState.DRIVING:
                self._heard_s = time.monotonic()
                self._words = f"Nav2: {feedback.distance_remaining:.1f} m to go"
                if feedback.number_of_recoveries:
                    self._words += f", {feedback.number_of_recoveries} recoveries"

    def _on_result(self, number: int, answer: Any) -> None:
        from action_msgs.msg import GoalStatus

        with self._lock:
            if number != self._number:
                return
            if answer.status == GoalStatus.STATUS_SUCCEEDED:
                self._state, self._words = GoalState.DONE, ""
                return
            told = getattr(answer.result, "error_msg", "")
            cancelled = answer.status == GoalStatus.STATUS_CANCELED
            how = "was told by somebody else to cancel" if cancelled else "gave up"
            code = int(answer.result.error_code)
            self._state = GoalState.FAILED
            self._words = f"Nav2 {how}: error {code}{f', {told}' if told else ''}"
