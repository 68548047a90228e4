"""A goal on its way to Nav2: by its action, or by a topic."""

from __future__ import annotations

import enum
import math
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
_ANSWER_S = 0.5
"""A server that has heard a goal answers within milliseconds."""


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

    @abstractmethod
    def send(self, pose: Any) -> None:
        """Go there (``PoseStamped``)."""

    @abstractmethod
    def insist(self) -> None:
        """Say it again, if it is likely that nobody has heard it; cheap, called in every control period."""

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
        self._pose: Any = None
        self._is_sent = False

    def send(self, pose: Any) -> None:
        """Publish it, if anyone has subscribed."""
        self._pose, self._is_sent = pose, False
        self.insist()

    def insist(self) -> None:
        """Publish it as soon as somebody listens."""
        if not self._is_sent and self._is_there:
            self._publisher.publish(self._pose)
            self._is_sent = True

    def cancel(self) -> None:
        """Cannot be done by a topic: what Nav2 goes on to command is not passed on."""

    def state(self) -> tuple[GoalState, str]:
        """Driving, while those who heard it are there."""
        self._is_sent = self._is_sent and self._is_there
        if self._is_sent:
            return GoalState.DRIVING, ""
        return GoalState.AWAY, f"nobody listens to {self._topic}"

    @property
    def _is_there(self) -> bool:
        return int(self._publisher.get_subscription_count()) > 0


class ActionGoal(Goal):
    """``NavigateToPose``, with feedback, cancel and result.

    A request or its answer can be lost: the server has just come, and one side has found the other while the
    other has not yet found it; or the server was killed, which the network notices after 20 s. So a goal
    without an answer is sent again every half a second, as an attempt with a number of its own; the newest
    that is accepted counts, and a server that heard two drops the older one, as Nav2 does.

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
        self._pose: Any = None
        self._attempt = self._first_attempt = self._taken_attempt = 0
        self._handle: Any = None
        self._asked_s = self._heard_s = -math.inf
        self._state, self._words = GoalState.AWAY, ""

    @property
    def is_taken(self) -> bool:
        """Whether the server has accepted it."""
        return self._handle is not None

    def send(self, pose: Any) -> None:
        """Send it; what became of the one before is not heard any more."""
        with self._lock:
            self._begin(pose)
            if self._is_there:
                self._state, self._words = GoalState.DRIVING, "the goal is sent to Nav2"
                self._heard_s = time.monotonic()
        self.insist()

    def insist(self) -> None:
        """Send it again if it was not answered for half a second."""
        with self._lock:
            now_s = time.monotonic()
            is_open = self._state in (GoalState.DRIVING, GoalState.AWAY) and self._handle is None
            if not (
                is_open and self._pose is not None and now_s - self._asked_s > _ANSWER_S and self._is_there
            ):
                return
            self._attempt += 1
            attempt, self._asked_s = self._attempt, now_s
            goal = self._kind.Goal(pose=self._pose, behavior_tree=self._behavior_tree)
        answer = self._client.send_goal_async(goal, lambda told: self._on_feedback(attempt, told.feedback))
        answer.add_done_callback(lambda done: self._on_answer(attempt, done.result()))

    def cancel(self) -> None:
        """Ask for the cancel; what comes of it does not matter any more."""
        with self._lock:
            handle = self._handle
            self._begin(None)
        if handle is not None:
            handle.cancel_goal_async()

    def state(self) -> tuple[GoalState, str]:
        """As the server says, while it is there."""
        with self._lock:
            is_there = self._is_there
            silent = time.monotonic() - self._heard_s > _SILENT_S
            if self._state is GoalState.DRIVING and (silent or not is_there):
                self._state, self._handle = GoalState.AWAY, None
            if self._state is GoalState.AWAY:
                return (
                    GoalState.AWAY,
                    f"Nav2's action {self._name} {'does not answer' if is_there else 'is not there'}",
                )
            return self._state, self._words

    @property
    def _is_there(self) -> bool:
        """Whether the action's server is; one that was killed seems to be for some seconds."""
        return bool(self._client.server_is_ready())

    def _begin(self, pose: Any) -> None:
        """Forget the goal before."""
        self._pose, self._handle = pose, None
        self._first_attempt = self._attempt + 1
        self._asked_s = -math.inf
        self._state, self._words = GoalState.AWAY, ""

    def _on_answer(self, attempt: int, handle: Any) -> None:
        with self._lock:
            if attempt < self._first_attempt:
                if handle.accepted:
                    handle.cancel_goal_async()  # it was replaced or cancelled while under way
                return
            if self._handle is not None and (attempt < self._taken_attempt or not handle.accepted):
                return
            if not handle.accepted:
                self._state, self._words = GoalState.FAILED, "Nav2 has rejected the goal"
                return
            self._handle, self._taken_attempt = handle, attempt
            self._state, self._words = GoalState.DRIVING, "Nav2 has taken the goal"
            self._heard_s = time.monotonic()
        handle.get_result_async().add_done_callback(lambda done: self._on_result(attempt, done.result()))

    def _on_feedback(self, attempt: int, feedback: Any) -> None:
        with self._lock:
            if attempt >= self._first_attempt and self._state is GoalState.DRIVING:
                self._heard_s = time.monotonic()
                self._words = f"Nav2: {feedback.distance_remaining:.1f} m to go"
                if feedback.number_of_recoveries:
                    self._words += f", {feedback.number_of_recoveries} recoveries"

    def _on_result(self, attempt: int, answer: Any) -> None:
        from action_msgs.msg import GoalStatus

        with self._lock:
            if attempt < self._first_attempt or attempt != self._taken_attempt:
                return
            if answer.status == GoalStatus.STATUS_SUCCEEDED:
                self._state, self._words = GoalState.DONE, ""
                return
            if attempt < self._attempt:
                return  # dropped for an attempt whose answer is still under way
            told = getattr(answer.result, "error_msg", "")
            cancelled = answer.status == GoalStatus.STATUS_CANCELED
            how = "was told by somebody else to cancel" if cancelled else "gave up"
            code = int(answer.result.error_code)
            self._state = GoalState.FAILED
            self._words = f"Nav2 {how}: error {code}{f', {told}' if told else ''}"
