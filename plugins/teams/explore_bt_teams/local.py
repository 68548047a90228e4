"""Team ``local``: robots of one process hear one another at once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, Letter, PluginOptions, RobotContext, Team
from explore_bt_teams.options import TeamOptions

__all__ = ["LocalTeam"]


class _Board:
    """What everybody has said, in the order of the saying."""

    def __init__(self) -> None:
        self.members: set[str] = set()
        self.said: dict[tuple[str, str], tuple[int, Letter]] = {}
        self.count = 0

    def pin(self, letter: Letter) -> None:
        """Replace what was said on that topic."""
        self.count += 1
        self.said.pop((letter.sender, letter.topic), None)  # to the end
        self.said[letter.sender, letter.topic] = (self.count, letter)


class LocalTeam(Team):
    """A board that all robots of the mission read; the same bytes go over it as over a network."""

    name = "local"
    api_version = API_VERSION
    shares_clock: ClassVar[bool] = True
    Options: ClassVar[type[PluginOptions]] = TeamOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = TeamOptions.model_validate(options.model_dump())
        self._board = _Board()
        self._robot = ""
        self._read = 0

    def setup(self, context: RobotContext) -> None:
        """Join the mission's board.

        Raises:
            PluginError: somebody of that name has joined.
        """
        board = context.commons.get(("team local", self._settings.fleet), _Board)
        if context.robot in board.members:
            raise PluginError(f"team local: there is a robot {context.robot} in the team; names are unique")
        board.members.add(context.robot)
        self._board, self._robot, self._read = board, context.robot, 0

    @property
    def budget_bytes_per_s(self) -> float:
        """As the options say."""
        return self._settings.bandwidth

    def say(self, topic: str, payload: bytes) -> None:
        """Heard by everybody's next ``hear``."""
        if self._robot:
            self._board.pin(Letter(self._robot, topic, payload))

    def hear(self) -> Sequence[Letter]:
        """What others have said since, oldest first."""
        fresh = []
        for count, letter in reversed(self._board.said.values()):
            if count <= self._read:
                break
            if letter.sender != self._robot:
                fresh.append(letter)
        self._read = self._board.count
        return fresh[::-1]

    def close(self) -> None:
        """What was said stays."""
        self._board.members.discard(self._robot)
        self._robot = ""
