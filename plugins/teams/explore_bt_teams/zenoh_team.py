"""Team ``zenoh``: robots in processes and machines of their own, over Eclipse Zenoh."""

from __future__ import annotations

import struct
import threading
import time
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, closing
from typing import Any, ClassVar

import numpy as np
from pydantic import Field, model_validator

from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Letter, PluginOptions, RobotContext, Team
from explore_bt_teams.inbox import Inbox
from explore_bt_teams.options import TeamOptions
from explore_bt_teams.zenoh_session import imported, opened

__all__ = ["ZenohOptions", "ZenohTeam"]

_HEAD = struct.Struct("<QQ")
"""Life of the speaker (when it joined, nanoseconds), and the number of the word in that life."""
_OFTEN = 1 << 63
"""Added to the numbers of words that are said anew all the time; they are counted by themselves."""
_WHOLE = "whole"
"""Ends an answer: these were the numbers of its words, and that was all up to its own."""
_NAME_TIMEOUT_S = 1.0
_ASK_TIMEOUT_S = 5.0


class ZenohOptions(TeamOptions):
    """Where the others are; without any, they are looked for by multicast."""

    mode: str = Field("peer", pattern="peer|client", description="client: everything goes through a router")
    connect: tuple[str, ...] = Field((), description="endpoints to go to: tcp/192.168.1.1:7447")
    listen: tuple[str, ...] = Field((), description="endpoints to be reached at; tcp/127.0.0.1:0 stays here")
    multicast: bool = Field(True, description="look for peers on the local network")

    @model_validator(mode="after")
    def _loses_nothing(self) -> ZenohOptions:
        for name, endpoints in (("connect", self.connect), ("listen", self.listen)):
            if lossy := [endpoint for endpoint in endpoints if endpoint.startswith("udp/")]:
                raise ValueError(
                    f"{name}: {lossy[0]}: over UDP it may be lost who wants to hear whom, and a robot stays "
                    f"deaf; write tcp/{lossy[0].removeprefix('udp/')}"
                )
        return self


class ZenohTeam(Team):
    """Peers that find one another, or clients of a router.

    Words are put and may be dropped. Each bears its number; whoever hears a gap asks that robot for all it
    has said since, which is the newest of each topic, until nothing of an answer is missing. So do late
    joiners, and both sides of a partition that has healed. Words that are said anew all the time are asked
    for by nobody.
    """

    name = "zenoh"
    api_version = API_VERSION
    Options: ClassVar[type[PluginOptions]] = ZenohOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = ZenohOptions.model_validate(options.model_dump())
        self._zenoh: Any = None
        self._session: Any = None
        self._lock = threading.Lock()
        self._said: dict[str, tuple[int, bytes]] = {}
        self._count = self._often_count = 0
        self._publishers: dict[str, Any] = {}
        self._inbox = Inbox()
        self._robot = self._prefix = ""
        self._life = 0

    def setup(self, context: RobotContext) -> None:
        """Open the session and join.

        Raises:
            PluginError: zenoh is not installed, an endpoint cannot be had, or the name is taken.
        """
        self._zenoh = imported()
        self._robot, self._prefix = context.robot, f"explore-bt/{self._settings.fleet}"
        self._life = time.time_ns()  # of two lives of a robot the later one counts; no decision hangs on it
        settings = self._settings
        session = opened(
            context.robot,
            settings.mode,
            listen=settings.listen,
            connect=settings.connect,
            multicast=settings.multicast,
        )
        try:
            self._refuse_twin(session)
            session.declare_queryable(f"{self._prefix}/{self._robot}/**", self._answer)
            session.declare_subscriber(f"{self._prefix}/*/**", self._take)
        except BaseException:
            session.close()
            raise
        self._session = session
        for reply in session.get(f"{self._prefix}/*/**", timeout=_NAME_TIMEOUT_S, target=self._all):
            self._take_reply(reply)

    @property
    def budget_bytes_per_s(self) -> float:
        """As the options say."""
        return self._settings.bandwidth

    def say(self, topic: str, payload: bytes) -> None:
        """Put, dropped where the network does not keep up."""
        session = self._session
        if session is None:
            return
        with self._lock:
            self._count += 1
            word = self._noted(topic, self._count, payload)
        drop = self._zenoh.CongestionControl.DROP
        try:
            session.put(f"{self._prefix}/{self._robot}/{topic}", word, congestion_control=drop)
        except self._zenoh.ZError:
            self._inbox.failed += 1  # it is in ``_said``: who misses it asks

    def say_often(self, topic: str, payload: bytes) -> None:
        """Put, and not asked for if it is lost."""
        session = self._session
        if session is None:
            return
        with self._lock:
            self._often_count += 1
            word = self._noted(topic, self._often_count | _OFTEN, payload)
        try:
            if topic not in self._publishers:
                self._publishers[topic] = session.declare_publisher(
                    f"{self._prefix}/{self._robot}/{topic}",
                    congestion_control=self._zenoh.CongestionControl.DROP,
                    reliability=self._zenoh.Reliability.BEST_EFFORT,
                )
            self._publishers[topic].put(word)
        except self._zenoh.ZError:
            self._inbox.failed += 1

    def hear(self) -> Sequence[Letter]:
        """What has come; and asks for what is missing."""
        letters = self._inbox.drain()
        if self._session is not None:
            for sender, since in self._inbox.missing(time.monotonic()):
                self._ask(sender, since)
        return letters

    def close(self) -> None:
        """Leave."""
        session, self._session = self._session, None
        self._publishers.clear()
        if session is not None:
            session.close()

    def figures(self) -> Mapping[str, float]:
        """Words that came, gaps that were asked for, words that could not be put."""
        return self._inbox.figures()

    @classmethod
    def router(cls, listen: Sequence[str]) -> AbstractContextManager[None]:
        """Robots with ``mode: client`` or ``connect`` go to it."""
        return closing(opened("router", "router", listen=listen))

    # --- inside; what zenoh calls comes on its own threads ----------------------------------------------

    def _noted(self, topic: str, number: int, payload: bytes) -> bytes:
        """The word with its number, kept for those who ask."""
        word = _HEAD.pack(self._life, number) + payload
        self._said[topic] = (number, word)
        return word

    @property
    def _all(self) -> Any:
        return self._zenoh.QueryTarget.ALL

    def _refuse_twin(self, session: Any) -> None:
        for reply in session.get(
            f"{self._prefix}/{self._robot}/name", timeout=_NAME_TIMEOUT_S, target=self._all
        ):
            if reply.ok is not None:
                raise PluginError(
                    f"team zenoh: there is a robot {self._robot} in the fleet {self._settings.fleet}; names "
                    "are unique"
                )

    def _answer(self, query: Any) -> None:
        """All that was said after the number that is asked for; to the name itself, yes."""
        key = str(query.key_expr)
        own = f"{self._prefix}/{self._robot}"
        if key == f"{own}/name":
            query.reply(key, b"")
            return
        asked = query.parameters.get("since", "0")
        since = int(asked) if asked.isdecimal() else 0
        with self._lock:
            words = [(topic, *said) for topic, said in self._said.items() if said[0] > since]
            count = self._count
        for topic, _, word in words:
            query.reply(f"{own}/{topic}", word)
        numbers = np.array([number for _, number, _ in words if not number & _OFTEN], dtype="<u8")
        query.reply(f"{own}/{_WHOLE}", _HEAD.pack(self._life, count) + numbers.tobytes())

    def _take(self, sample: Any) -> None:
        sender, _, topic = str(sample.key_expr).removeprefix(f"{self._prefix}/").partition("/")
        word = sample.payload.to_bytes()
        if sender == self._robot or len(word) < _HEAD.size:
            return
        life, number = _HEAD.unpack_from(word)
        if topic == _WHOLE:
            told = np.frombuffer(word[_HEAD.size :][: (len(word) - _HEAD.size) // 8 * 8], dtype="<u8")
            self._inbox.answered(sender, life, number, told.tolist())
            return
        letter = Letter(sender, topic, word[_HEAD.size :])
        self._inbox.put(letter, life, number & ~_OFTEN, is_counted=not number & _OFTEN)

    def _take_reply(self, reply: Any) -> None:
        if reply.ok is not None:
            self._take(reply.ok)

    def _ask(self, sender: str, since: int) -> None:
        selector = f"{self._prefix}/{sender}/**?since={since}"
        try:
            drop = (
                self._zenoh.CongestionControl.DROP
            )  # it is asked again, and must not hold up the control loop
            self._session.get(
                selector,
                self._take_reply,
                timeout=_ASK_TIMEOUT_S,
                target=self._all,
                congestion_control=drop,
            )
        except self._zenoh.ZError:
            self._inbox.failed += 1
