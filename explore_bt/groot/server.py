"""Answers Groot2's requests about one robot's tree, in a thread of its own."""

from __future__ import annotations

import contextlib
import json
import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import TimeoutError as NotYet

import msgpack
import zmq

from explore_bt.debug import DebugSession, DebugState, Look
from explore_bt.errors import DebugError
from explore_bt.groot.ends import Ends
from explore_bt.groot.hooks import Hooks
from explore_bt.groot.protocol import (
    BLACKBOARD,
    DISABLE_ALL_HOOKS,
    FULL_TREE,
    GET_TRANSITIONS,
    HOOK_INSERT,
    HOOK_REMOVE,
    HOOK_UNLOCK,
    HOOKS_DUMP,
    REMOVE_ALL_HOOKS,
    STATUS,
    TOGGLE_RECORDING,
    GrootError,
    Request,
    error_reply,
    notice,
    reply,
)
from explore_bt.groot.tree_watch import TreeWatch
from explore_bt.recording import to_json

__all__ = ["SILENT_CLIENT_S", "GrootServer"]

_log = logging.getLogger(__name__)

_LOOK_UP_MS = 50
SILENT_CLIENT_S = 5.0
"""As in BehaviorTree.CPP: who has asked nothing for so long is gone, and its breakpoints hold nobody."""
_LAST_ANSWER_S = 3.0
_BREATH_S = 0.001
"""Rest after each message, so that a flood leaves the interpreter to the tick thread."""


class GrootServer:
    """One robot's tree at two neighbouring ports: requests at the first, notices of breakpoints at the next.

    Args:
        ends: bound.
        tree: what observers are shown.
        xml: the tree.
        names: by which clients may ask for the blackboard.
        hooks: what they may set.
        session: asked for the middle of a tick while the run is paused.
        robot: the robot's name.
        identity: 16 bytes that tell this run from others.
        silent_client_s: after so long without a request hooks hold nobody any more.
    """

    def __init__(
        self,
        ends: Ends,
        tree: TreeWatch,
        xml: str,
        names: tuple[str, ...],
        hooks: Hooks,
        session: DebugSession,
        robot: str,
        identity: bytes,
        silent_client_s: float,
    ) -> None:
        self._ends = ends
        self._tree = tree
        self._xml = xml.encode()
        self._names = names
        self._hooks = hooks
        self._session = session
        self._robot = robot
        self._identity = identity
        self._silent_client_s = silent_client_s
        self._states: deque[DebugState] = deque(maxlen=100)
        self._unsubscribe: Callable[[], None] = lambda: None
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None
        self._told: object = None
        self._notices = 0
        self._heard_s = 0.0
        self._is_client_gone = False
        self._answers: Mapping[bytes, Callable[[Request], bytes | None]] = {
            FULL_TREE: lambda _: self._xml,
            STATUS: self._status,
            BLACKBOARD: self._blackboard,
            HOOK_INSERT: lambda request: self._hooks.insert(request.json()),
            HOOK_UNLOCK: lambda request: self._hooks.unlock(request.json()),
            HOOK_REMOVE: lambda request: self._hooks.remove(request.json()),
            REMOVE_ALL_HOOKS: lambda _: self._hooks.remove_all(),
            DISABLE_ALL_HOOKS: lambda _: self._hooks.enable_all(False),
            HOOKS_DUMP: lambda _: json.dumps(self._hooks.dump()).encode(),
            TOGGLE_RECORDING: self._toggle_recording,
            GET_TRANSITIONS: lambda _: self._tree.take_transitions(),
        }

    def start(self) -> None:
        """Answer from now on."""
        self._unsubscribe = self._session.subscribe(self._states.append)
        self._heard_s = time.monotonic()
        self._thread = threading.Thread(target=self._serve, name=f"groot {self._robot}", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Answer nobody any more; idempotent."""
        self._ended.set()
        self._unsubscribe()
        if self._thread is not None:
            self._thread.join(_LAST_ANSWER_S)
        self._ends.close()

    def _serve(self) -> None:
        while not self._ended.is_set():
            try:
                self._tell()
                self._watch_client()
                asked = self._ends.next_request(_LOOK_UP_MS)
                if asked is not None:
                    client, frames = asked
                    self._hear()
                    self._ends.answer(client, self._answer(frames))
                time.sleep(_BREATH_S)
            except zmq.ContextTerminated:
                return
            except zmq.ZMQError as error:  # of one exchange; the next client is served all the same
                _log.warning("groot: %s", error)

    def _hear(self) -> None:
        self._heard_s = time.monotonic()
        if self._is_client_gone:
            self._is_client_gone = False
            with contextlib.suppress(GrootError):
                self._hooks.enable_all(True)

    def _watch_client(self) -> None:
        """A client that has gone must not hold the run."""
        silent_s = time.monotonic() - self._heard_s
        if self._is_client_gone or not len(self._hooks) or silent_s < self._silent_client_s:
            return
        self._is_client_gone = True
        _log.warning("groot: nobody has asked anything for %.0f s; hooks are disabled", silent_s)
        with contextlib.suppress(GrootError):
            self._hooks.enable_all(False)

    def _tell(self) -> None:
        """Tell subscribers of a breakpoint that was reached, once."""
        while self._states:
            state = self._states.popleft()
            uid = self._hooks.reached(state)
            place = None if uid is None else (state.tick, state.path, state.moment, state.stamp_s)
            if uid is not None and place != self._told:
                self._notices += 1
                self._ends.tell_all(notice(self._notices, uid))
            self._told = place

    def _answer(self, frames: list[bytes]) -> list[bytes]:
        try:
            request = Request.parse(frames)
            if request.type not in self._answers:
                raise GrootError("Request not recognized")
            return reply(request, self._identity, self._answers[request.type](request))
        except GrootError as refusal:
            return error_reply(str(refusal))
        except Exception:  # whatever a client has sent, the others are served
            _log.exception("groot: a request failed")
            return error_reply("the request failed inside explore-bt")

    def _status(self, _request: Request) -> bytes:
        if not self._session.state().paused:
            return self._tree.statuses()
        try:
            return self._tree.statuses(self._session.submit(Look(self._robot)).result(0.5).nodes)
        except (DebugError, NotYet):
            return self._tree.statuses()

    def _blackboard(self, request: Request) -> bytes:
        """Subtrees share one blackboard: it is shown under each name that is asked for."""
        asked = [name for name in request.text().split(";") if name in self._names]
        entries = {key: to_json(value) for key, value in self._tree.blackboard.items()}
        shown = dict.fromkeys(asked or self._names[:1], entries)
        return bytes(msgpack.packb(shown))

    def _toggle_recording(self, request: Request) -> bytes | None:
        command = request.text()
        if command == "start":
            self._tree.start_recording()
            return str(time.time_ns() // 1000).encode()
        if command != "stop":
            raise GrootError("start or stop was expected")
        self._tree.stop_recording()
        return None
