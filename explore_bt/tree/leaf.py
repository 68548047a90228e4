"""Base of every leaf: a py_trees behaviour with declared ports and its robot at hand."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar, TypeVar, cast

import py_trees
from py_trees.common import Status

from explore_bt.interfaces import RobotServices
from explore_bt.tree.blackboard import Blackboard
from explore_bt.tree.ports import REQUIRED, Input, Key, Output

__all__ = ["Leaf", "Status"]

T = TypeVar("T")


class Leaf(py_trees.behaviour.Behaviour):
    """An action or a condition.

    Lifecycle, all in the tick thread: ``initialise()`` when a new round begins (the first tick after
    the leaf was not running), ``update()`` on every tick (quick, never blocking) returns the status,
    ``terminate(new_status)`` when the round ends or is cut off (``INVALID``).
    Say why with ``self.say("...")``: it is shown, recorded and reported.

    Attributes:
        kind: always ``behaviour``.
        type_key: the leaf's key in mission files.
        inputs, outputs: the declared ports by name.
        keeps: names of attributes that outlive the process: a resumed run finds them as they were. What is
            only about the running round need not be among them: a resumed leaf begins its round anew.
        values: classes (frozen dataclasses, enumerations) that its outputs hold, beside those of
            ``explore_bt.types``: a checkpoint keeps nothing of a class that nobody has declared.
    """

    kind: ClassVar[str] = "behaviour"
    api_version: ClassVar[int] = 1
    type_key: ClassVar[str]
    inputs: ClassVar[Mapping[str, Input[object]]] = {}
    outputs: ClassVar[Mapping[str, Output[object]]] = {}
    keeps: ClassVar[tuple[str, ...]] = ()
    values: ClassVar[tuple[type, ...]] = ()

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        members = {name: member for base in reversed(cls.__mro__) for name, member in vars(base).items()}
        cls.inputs = {name: port for name, port in members.items() if isinstance(port, Input)}
        cls.outputs = {name: port for name, port in members.items() if isinstance(port, Output)}

    def __init__(
        self,
        name: str,
        robot: RobotServices,
        blackboard: Blackboard,
        bindings: Mapping[str, object] | None = None,
    ) -> None:
        """Bind the ports; values are as validated by the loader, a ``Key`` stands for ``$entry``."""
        super().__init__(name=name)
        self.robot = robot
        self.blackboard = blackboard
        self.bind(bindings or {})

    def bind(self, bindings: Mapping[str, object]) -> None:
        """Bind the ports anew, between ticks; those that are not named get their defaults."""
        ports: dict[str, Input[Any] | Output[Any]] = {**self.inputs, **self.outputs}
        self.bindings = {port: declared.default for port, declared in ports.items()} | dict(bindings)
        unknown = self.bindings.keys() - ports.keys()
        missing = [port for port, bound in self.bindings.items() if bound is REQUIRED]
        unwritable = [port for port in self.outputs if not isinstance(self.bindings[port], Key)]
        if unknown or missing or unwritable:
            raise TypeError(f"{self.type_key}: unknown {unknown}, missing {missing}, not a key {unwritable}")

    def memory(self) -> Mapping[str, object]:
        """What it keeps, as far as it was ever set."""
        return {name: getattr(self, name) for name in self.keeps if hasattr(self, name)}

    def restore(self, memory: Mapping[str, object]) -> None:
        """Have it again."""
        for name in self.keeps:
            if name in memory:
                setattr(self, name, memory[name])

    def say(self, message: str) -> None:
        """Give the reason for what the leaf is about, one phrase with numbers and units."""
        self.feedback_message = message

    def recall(self, port: str, default: T) -> T:
        """The value an output port wrote last, or ``default`` before the first time."""
        bound = self.bindings[port]
        assert isinstance(bound, Key)  # an output is always bound to an entry
        return cast(T, self.blackboard.get(bound.name, default))
