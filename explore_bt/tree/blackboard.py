"""One robot's blackboard: what its leaves share, reached through their declared ports."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

__all__ = ["Blackboard"]


class Blackboard(Mapping[str, object]):
    """Key -> immutable value, with a revision per key so that observers can record differences only."""

    def __init__(self) -> None:
        self._values: dict[str, object] = {}
        self._revisions: dict[str, int] = {}
        self._revision = 0

    def __getitem__(self, key: str) -> object:
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def write(self, key: str, value: object) -> None:
        """Set ``key``; the revision grows even if the value is the same."""
        self._revision += 1
        self._values[key] = value
        self._revisions[key] = self._revision

    @property
    def revision(self) -> int:
        """Number of writes so far."""
        return self._revision

    def changed_since(self, revision: int) -> list[str]:
        """Keys written after ``revision``."""
        return [key for key, written in self._revisions.items() if written > revision]
