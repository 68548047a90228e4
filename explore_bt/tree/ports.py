"""Ports: the declared inputs and outputs of a leaf.

Declared once on the class, they are what the mission loader checks, what the JSON schema and the
reference page are made from, and how a leaf reads and writes its robot's blackboard::

    class FindNextHeading(Leaf):
        stride: Input[float] = Input(Length, default=1.5, ge=0.1, doc="distance to the next waypoint")
        visited: Input[tuple[Waypoint, ...]] = Input(tuple, default=Key("visited"), doc="...")
        goal: Output[Waypoint] = Output(Waypoint, default=Key("goal"), doc="...")

        def update(self) -> Status:
            self.goal = choose(self.stride, self.visited)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Generic, Self, TypeVar, cast, overload

from pydantic import Field, TypeAdapter

if TYPE_CHECKING:
    from explore_bt.tree.leaf import Leaf

__all__ = ["REQUIRED", "Input", "Key", "Output", "PortUnsetError"]

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Key:
    """A blackboard entry: ``$name`` in YAML."""

    name: str


class _Required:
    def __repr__(self) -> str:
        return "required"


REQUIRED = _Required()
"""Default of an input that every mission must give."""


class PortUnsetError(Exception):
    """An input was read whose blackboard entry nobody has written yet."""


class Input(Generic[T]):
    """An input: a constant from the mission, or a blackboard entry.

    Args:
        type_: a type from ``explore_bt.units``, a plain Python type, or a ``Literal``: what a constant
            in YAML is validated against. A class that YAML cannot write (``Waypoint``) makes the port
            readable from the blackboard only.
        default: the value (SI), a ``Key``, or ``REQUIRED``.
        initial: what a blackboard input reads before anything was written; ``REQUIRED`` makes that an error.
        ge, le: bounds of a number, SI.
        doc: one phrase for the reference page.
    """

    def __init__(
        self,
        type_: Any,  # a type form; there is no type for those yet
        *,
        default: object = REQUIRED,
        initial: object = REQUIRED,
        ge: float | None = None,
        le: float | None = None,
        doc: str,
    ) -> None:
        self.type = type_
        self.default = default
        self.initial = initial
        self.ge, self.le = ge, le
        self.doc = doc
        self.name = ""

    def __set_name__(self, owner: type[Leaf], name: str) -> None:
        self.name = name

    @property
    def takes_constants(self) -> bool:
        """Whether a mission can write the value itself, not only name a blackboard entry."""
        return not isinstance(self.type, type) or self.type in (bool, int, float, str)

    @property
    def adapter(self) -> TypeAdapter[T]:
        """Validates a constant from YAML, bounds included; only where ``takes_constants``."""
        if self.ge is None and self.le is None:
            return TypeAdapter(self.type)
        bounded: Any = Annotated[self.type, Field(ge=self.ge, le=self.le)]
        return TypeAdapter(bounded)

    @overload
    def __get__(self, instance: None, owner: type[Leaf]) -> Self: ...
    @overload
    def __get__(self, instance: Leaf, owner: type[Leaf]) -> T: ...
    def __get__(self, instance: Leaf | None, owner: type[Leaf]) -> Self | T:
        if instance is None:
            return self
        bound = instance.bindings[self.name]
        if not isinstance(bound, Key):
            return cast(T, bound)
        value = instance.blackboard.get(bound.name, self.initial)
        if value is REQUIRED:
            raise PortUnsetError(
                f"{instance.name}: port {self.name} reads ${bound.name}, which nothing has written yet"
            )
        return cast(T, value)


class Output(Generic[T]):
    """An output: the blackboard entry that the leaf writes by plain assignment.

    Args:
        type_: the Python class of the values, compared with the inputs that read the same entry.
        default: the entry it writes unless the mission names another.
        doc: one phrase for the reference page.
    """

    def __init__(self, type_: Any, *, default: Key, doc: str) -> None:
        self.type = type_
        self.default = default
        self.doc = doc
        self.name = ""

    def __set_name__(self, owner: type[Leaf], name: str) -> None:
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type[Leaf]) -> Self: ...
    @overload
    def __get__(self, instance: Leaf, owner: type[Leaf]) -> T: ...
    def __get__(self, instance: Leaf | None, owner: type[Leaf]) -> Self | T:
        if instance is None:
            return self
        return cast(T, instance.blackboard[self._key(instance)])

    def __set__(self, instance: Leaf, value: T) -> None:
        instance.blackboard.write(self._key(instance), value)

    def _key(self, instance: Leaf) -> str:
        bound = instance.bindings[self.name]
        assert isinstance(bound, Key)  # the loader and Leaf.__init__ let nothing else through
        return bound.name
