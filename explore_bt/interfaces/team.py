"""Contract of team plugins: how what robots have to tell one another gets there."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import ClassVar

from explore_bt.errors import PluginError
from explore_bt.interfaces.plugin import Plugin, RobotContext

__all__ = ["Letter", "Team"]


@dataclass(frozen=True, slots=True)
class Letter:
    """What another robot says on a topic: the newest replaces what it said there before."""

    sender: str
    topic: str
    payload: bytes


class Team(Plugin):
    """Carries bytes; what they mean is the framework's, the same for every plugin.

    Every robot holds one state per topic, and everybody comes to know everybody's newest: late joiners get
    what was said before they came, what was lost in between does not matter, and after a partition the newest
    counts. So nobody has to agree on anything.

    Life: ``setup`` once, then ``say`` and ``hear`` from the control thread, ``close`` once.

    Attributes:
        shares_clock: whether all robots' mission times are one clock, as in one process.
    """

    kind = "team"
    shares_clock: ClassVar[bool] = False

    @abstractmethod
    def setup(self, context: RobotContext) -> None:
        """Join under the name ``context.robot``; may take seconds.

        Raises:
            PluginError: the network cannot be had, or the name is taken.
        """

    @property
    @abstractmethod
    def budget_bytes_per_s(self) -> float:
        """What a robot may send in the long run; the framework keeps to it."""

    @abstractmethod
    def say(self, topic: str, payload: bytes) -> None:
        """Replace what this robot says on a topic. Never blocks, never raises for want of a network."""

    def say_often(self, topic: str, payload: bytes) -> None:
        """As ``say``, of what is said anew all the time: one such word that is lost is not missed."""
        self.say(topic, payload)

    @abstractmethod
    def hear(self) -> Sequence[Letter]:
        """News since the last call: of each robot's topics at least the newest, in order. Never blocks."""

    @abstractmethod
    def close(self) -> None:
        """Leave; the others may keep what was said. Idempotent."""

    def figures(self) -> Mapping[str, float]:
        """Numbers for the report; none unless overridden."""
        return {}

    @classmethod
    def router(cls, listen: Sequence[str]) -> AbstractContextManager[None]:  # noqa: ARG003  # for those that have one
        """While inside, this process passes on what robots say that do not reach one another.

        Args:
            listen: where they come to, as the plugin writes endpoints.

        Raises:
            PluginError: its robots need nobody between them, or an endpoint cannot be had.
        """
        raise PluginError(f"team {cls.name} has no router: its robots reach one another without")
