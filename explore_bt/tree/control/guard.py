"""Conditions before a node, recovery after it."""

from __future__ import annotations

from collections.abc import Mapping, Sized

from py_trees.behaviour import Behaviour
from py_trees.common import Status

from explore_bt.tree.control.base import ControlNode
from explore_bt.tree.control.fallback import Fallback
from explore_bt.tree.control.outcome import ForceFailure
from explore_bt.tree.control.sequence import Sequence

__all__ = ["EntryCondition", "Guard", "OnFailure", "holds"]


def holds(value: object) -> bool:
    """Whether an entry counts as true: not None, not False, not zero, not empty."""
    if value is None or isinstance(value, bool | int | float):
        return bool(value)
    return len(value) > 0 if isinstance(value, Sized) else True


class EntryCondition(Behaviour):
    """Succeeds if a blackboard entry holds (see ``holds``); an entry nobody has written does not."""

    def __init__(self, name: str, blackboard: Mapping[str, object], key: str, negated: bool = False) -> None:
        super().__init__(name=name)
        self._blackboard = blackboard
        self._key = key
        self._negated = negated

    def update(self) -> Status:
        """Look at the entry."""
        held = holds(self._blackboard.get(self._key))
        self.feedback_message = f"${self._key} {'holds' if held else 'does not hold'}"
        return Status.SUCCESS if held != self._negated else Status.FAILURE


class Guard(Sequence):
    """The modifier ``if``: fails at once where the condition fails.

    The condition is asked when a round of the child begins, not again while the child runs (for that,
    use a ``reactive_sequence``).
    """

    def __init__(self, name: str, condition: Behaviour, child: Behaviour) -> None:
        ControlNode.__init__(self, name, [condition, child])


class OnFailure(Fallback):
    """The modifier ``on_failure``: after the child has failed the handler runs; the whole still fails.

    A handler that is to mend the failure belongs into a ``fallback`` or ``retry`` around the node.
    """

    def __init__(self, name: str, child: Behaviour, handler: ForceFailure) -> None:
        ControlNode.__init__(self, name, [child, handler])
