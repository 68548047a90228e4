"""Shows a run to Groot2 and other clients of its protocol."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping

from explore_bt.debug import DebugSession
from explore_bt.errors import UserError
from explore_bt.groot.ends import Ends
from explore_bt.groot.hooks import Hooks
from explore_bt.groot.server import SILENT_CLIENT_S, GrootServer
from explore_bt.groot.tree_watch import TreeWatch
from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import Mission
from explore_bt.mission.btcpp import live_attributes, live_tree_xml, uid_of
from explore_bt.types import Result

__all__ = ["GrootSink"]


class GrootSink(Sink):
    """One server a robot: the first at ``port`` and the one after it, each other robot two further on.

    Args:
        mission: what runs; the ports of its leaves are shown.
        session: hooks are carried out by it.
        host: loopback, unless somebody asked for more: the protocol knows no token.
        port: of the first robot.
        silent_client_s: after so long without a request hooks hold nobody any more.
    """

    name = "groot"

    def __init__(
        self,
        mission: Mission,
        session: DebugSession,
        host: str = "127.0.0.1",
        port: int = 1667,
        silent_client_s: float = SILENT_CLIENT_S,
    ) -> None:
        super().__init__(PluginOptions())
        self._specs = {robot.name: robot.tree for robot in mission.robots}
        self._session = session
        self._host = host
        self._port = port
        self._silent_client_s = silent_client_s
        self._trees: dict[str, TreeWatch] = {}
        self._servers: list[GrootServer] = []
        self._ends: dict[str, Ends] = {}

    @property
    def ports(self) -> Mapping[str, int]:
        """Robot -> port of its requests."""
        return {robot: self._port + 2 * index for index, robot in enumerate(self._specs)}

    def bind(self) -> None:
        """Take the ports, before a run begins that could not have them.

        Raises:
            UserError: somebody else has one.
        """
        try:
            for robot, port in self.ports.items():
                self._ends[robot] = Ends(self._host, port)
        except UserError:
            self.close(None)
            raise

    def open(self, run: RunInfo) -> None:
        """Begin to answer."""
        if not self._ends:
            self.bind()
        for robot, nodes in run.trees.items():
            tree = TreeWatch(nodes)
            xml = live_tree_xml(nodes, live_attributes(self._specs[robot]))
            subtrees = [node for node in nodes if node.type == "subtree"]
            known = [nodes[0].name, *(each.name for each in subtrees), *(each.path for each in subtrees)]
            hooks = Hooks(self._session, robot, {uid_of(node): node.path for node in nodes})
            identity = hashlib.sha256(
                f"{run.mission_sha256} {run.seed} {run.folder} {robot}".encode()
            ).digest()
            server = GrootServer(
                self._ends[robot],
                tree,
                xml,
                tuple(known),
                hooks,
                self._session,
                robot,
                identity[:16],
                self._silent_client_s,
            )
            server.start()
            self._trees[robot] = tree
            self._servers.append(server)

    def on_tick(self, tick: TickSnapshot) -> None:
        """Take the tick in."""
        for robot in tick.robots:
            self._trees[robot.robot].on_tick(tick.stamp_s, robot)

    def close(self, result: Result | None) -> None:  # noqa: ARG002  # nothing more to show
        """Answer nobody any more."""
        for server in self._servers:
            server.close()
        for ends in self._ends.values():
            ends.close()
