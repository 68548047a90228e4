"""A team within one process: a board that all robots of a mission read."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import hookimpl
from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Letter, PluginOptions, RobotContext, Team


class Board:
    """What everybody said last, in the order of the saying."""

    def __init__(self) -> None:
        self.members: set[str] = set()
        self.letters: dict[tuple[str, str], tuple[int, Letter]] = {}
        self.count = 0


class MyPlugin(Team):
    """Replace the board by your radio: keep the newest of every topic, also for those who come late."""

    name = "my_plugin"
    api_version = API_VERSION
    shares_clock = True

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._board = Board()
        self._robot = ""
        self._heard = 0

    def setup(self, context: RobotContext) -> None:
        """Join."""
        board = context.commons.get("my_plugin", Board)
        if context.robot in board.members:
            raise PluginError(f"team my_plugin: there is a robot {context.robot} in the team already")
        board.members.add(context.robot)
        self._board, self._robot, self._heard = board, context.robot, 0

    @property
    def budget_bytes_per_s(self) -> float:
        """What your link can carry for each robot."""
        return 20_000.0

    def say(self, topic: str, payload: bytes) -> None:
        """Never blocks."""
        if not self._robot:
            return
        self._board.count += 1
        self._board.letters.pop((self._robot, topic), None)
        self._board.letters[self._robot, topic] = (self._board.count, Letter(self._robot, topic, payload))

    def hear(self) -> Sequence[Letter]:
        """Never blocks; nothing twice."""
        news = [
            letter
            for count, letter in self._board.letters.values()
            if count > self._heard and letter.sender != self._robot
        ]
        self._heard = self._board.count
        return news

    def close(self) -> None:
        """Leave; what was said stays."""
        self._board.members.discard(self._robot)
        self._robot = ""


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]
