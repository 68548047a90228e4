"""YAML with its places: every fault of a world or map file at once, with file, line and column."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from pathlib import Path

import yaml

from explore_bt.errors import WorldError
from explore_bt.units import ANGLE, DURATION, LENGTH, Dimension, parse_quantity

__all__ = ["MarkedFile"]

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class MarkedFile:
    """A YAML file being read: gives plain values of its nodes and collects what is wrong with them.

    Every reading method reports a fault and returns None (or leaves the item out) instead of raising, so
    that one look at the file finds all faults; ``raise_faults`` ends the reading.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._faults: list[tuple[int, int, str]] = []

    def root(self, noun: str) -> yaml.MappingNode:
        """The file's top mapping.

        Raises:
            WorldError: the file is missing, unreadable, not YAML, or not a mapping.
        """
        try:
            node = yaml.compose(self.path.read_text(encoding="utf-8"), Loader=_Loader)
        except FileNotFoundError:
            raise WorldError(f"{self.path}: there is no such file; give the path of {noun}") from None
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise WorldError(f"{self.path}: cannot be read ({reason}); give the path of {noun}") from None
        except UnicodeDecodeError as error:
            fault = f"is no text (byte {error.start} is not UTF-8)"
            raise WorldError(f"{self.path}: {fault}; give the YAML file of {noun}") from None
        except yaml.MarkedYAMLError as error:
            mark = error.problem_mark or error.context_mark
            place = f"{self.path}:{mark.line + 1}:{mark.column + 1}" if mark else str(self.path)
            raise WorldError(f"{place}  is not YAML: {error.problem}; check the line above too") from None
        except yaml.YAMLError as error:
            raise WorldError(f"{self.path}: is not YAML: {error}") from None
        if not isinstance(node, yaml.MappingNode):
            found = "is empty" if node is None else f"holds a {_kind(node)}"
            raise WorldError(f"{self.path}:1:1  {found}; expected {noun}, a mapping of keys and values")
        return node

    def fault(self, node: yaml.Node, text: str) -> None:
        """Report a fault at a node's place."""
        self._faults.append((node.start_mark.line + 1, node.start_mark.column + 1, text))

    @property
    def fault_count(self) -> int:
        """How many faults were found so far."""
        return len(self._faults)

    def raise_faults(self) -> None:
        """End the reading.

        Raises:
            WorldError: with one line per fault, in the file's order.
        """
        if self._faults:
            lines = [f"{self.path}:{line}:{column}  {text}" for line, column, text in sorted(self._faults)]
            raise WorldError("\n".join(lines))

    def fields(
        self,
        node: yaml.Node,
        noun: str,
        *,
        required: Iterable[str] = (),
        optional: Iterable[str] = (),
        strict: bool = True,
    ) -> dict[str, yaml.Node]:
        """The values of a mapping by key; unknown (if strict), doubled and missing keys are faults."""
        required, known = tuple(required), (*required, *optional)
        if not isinstance(node, yaml.MappingNode):
            self.fault(node, f"{noun} is a {_kind(node)}; expected a mapping such as {{{_example(known)}}}")
            return {}
        found: dict[str, yaml.Node] = {}
        strangers: list[str] = []
        for key_node, value in node.value:
            key = str(key_node.value) if isinstance(key_node, yaml.ScalarNode) else _kind(key_node)
            if key in found:
                self.fault(key_node, f"{noun} has {key} twice; keep one of them")
            elif key in known:
                found[key] = value
            else:
                strangers.append(key)
                if strict:
                    self.fault(key_node, f"{noun} has no key {key!r}{_hint(key, known)}")
        for key in required:
            if key not in found:
                close = difflib.get_close_matches(key, strangers, 1, 0.7)
                typo = f"; {close[0]!r} may be a slip of the pen" if close and not strict else ""
                self.fault(node, f"{noun} lacks {key!r}{typo}; add a line '{key}: ...'")
        return found

    def items(self, node: yaml.Node | None, noun: str) -> Sequence[yaml.Node]:
        """The members of a list; an absent list is empty."""
        if node is None or (isinstance(node, yaml.ScalarNode) and node.tag.endswith(":null")):
            return ()
        if not isinstance(node, yaml.SequenceNode):
            self.fault(node, f"{noun} is a {_kind(node)}; expected a list")
            return ()
        return list(node.value)

    def text(self, node: yaml.Node | None, noun: str) -> str | None:
        """A word or sentence."""
        if node is None:
            return None
        if not isinstance(node, yaml.ScalarNode) or not node.value:
            self.fault(node, f"{noun} is a {_kind(node)}; expected a text")
            return None
        return str(node.value)

    def flag(self, node: yaml.Node | None, noun: str) -> bool:
        """True or false; absent is false."""
        if node is None:
            return False
        if isinstance(node, yaml.ScalarNode) and node.value in ("true", "false"):
            return bool(node.value == "true")
        self.fault(node, f"{noun} is neither true nor false")
        return False

    def quantity(
        self,
        node: yaml.Node | None,
        dimension: Dimension,
        noun: str,
        *,
        low: float | None = None,
        high: float | None = None,
    ) -> float | None:
        """A number with or without unit, SI, within closed bounds."""
        if node is None:
            return None
        if not isinstance(node, yaml.ScalarNode):
            self.fault(node, f"{noun} is a {_kind(node)}; write {dimension.example}")
            return None
        try:
            value = parse_quantity(str(node.value), dimension)
        except ValueError as error:
            self.fault(node, f"{noun}: {error}")
            return None
        if (low is not None and value < low) or (high is not None and value > high):
            bounds = f"at least {low:g}" if high is None else f"{low:g} to {high:g}"
            self.fault(node, f"{noun} is {value:g} {dimension.si}; expected {bounds} {dimension.si}")
            return None
        return value

    def lengths(self, node: yaml.Node | None, names: str) -> tuple[float, ...] | None:
        """A list of lengths, one for each word of ``names`` (``"x y radius"``), metres."""
        return self._numbers(node, names, [LENGTH] * len(names.split()))

    def durations(self, node: yaml.Node | None, names: str) -> tuple[float, ...] | None:
        """A list of durations, one for each word of ``names`` (``"begin end"``), seconds."""
        return self._numbers(node, names, [DURATION] * len(names.split()))

    def pose(self, node: yaml.Node | None, angle_name: str = "heading") -> tuple[float, float, float] | None:
        """``[x, y, heading]`` in metres and radians; the last may have another name."""
        values = self._numbers(node, f"x y {angle_name}", [LENGTH, LENGTH, ANGLE])
        return None if values is None else (values[0], values[1], values[2])

    def _numbers(
        self, node: yaml.Node | None, names: str, dimensions: Sequence[Dimension]
    ) -> tuple[float, ...] | None:
        if node is None:
            return None
        words = names.split()
        if not isinstance(node, yaml.SequenceNode) or len(node.value) != len(words):
            found = f"{len(node.value)} values" if isinstance(node, yaml.SequenceNode) else f"a {_kind(node)}"
            self.fault(node, f"found {found}; expected [{', '.join(words)}]")
            return None
        values = [
            self.quantity(item, dimension, word)
            for item, dimension, word in zip(node.value, dimensions, words, strict=True)
        ]
        whole = tuple(value for value in values if value is not None)
        return whole if len(whole) == len(words) else None


def _kind(node: yaml.Node) -> str:
    if isinstance(node, yaml.MappingNode):
        return "mapping"
    if isinstance(node, yaml.SequenceNode):
        return "list"
    return f"value {node.value!r}" if node.value else "key without a value"


def _example(known: Sequence[str]) -> str:
    return ", ".join(f"{key}: ..." for key in known[:3])


def _hint(key: str, known: Sequence[str]) -> str:
    close = difflib.get_close_matches(key, known, 1)
    return f"; did you mean {close[0]!r}?" if close else f"; it knows {', '.join(known)}"
