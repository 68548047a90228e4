"""Safe expressions: they compare and reckon, and can do nothing else.

A subset of Python's expressions, read with Python's own parser and evaluated here: nothing is called,
imported or assigned, nothing can loop, and neither text nor numbers can grow beyond what was written.
"""

from __future__ import annotations

import ast
import dataclasses
import enum
import operator
import re
from collections.abc import Callable, Mapping, Sequence, Set
from typing import Any, Protocol

import numpy as np

from explore_bt.debug.sight import NAMES, known_keys
from explore_bt.errors import DebugError
from explore_bt.mission.words import did_you_mean, show
from explore_bt.runtime import Robot

__all__ = ["Expression", "ExpressionError", "Seen"]

LONGEST = 300
DEEPEST = 30
MOST_SEARCHED = 10_000
_ALLOWED = "numbers, 'text', $entry, names, + - * / // %, comparisons, in, and, or, not, .field, [index]"
_QUOTED_OR_ENTRY = re.compile(r"'[^']*'|\"[^\"]*\"|\$(?=[A-Za-z_])")
_LITERALS: Mapping[str, object] = {"true": True, "false": False, "none": None}

_ARITHMETIC: Mapping[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_COMPARISONS: Mapping[type[ast.cmpop], Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Is: operator.eq,
    ast.IsNot: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
}


class ExpressionError(DebugError):
    """An expression that cannot be understood, or has no value now; names the column."""


class Seen(Protocol):
    """What an expression is evaluated on: see ``Sight``."""

    def name(self, name: str) -> object:
        """The value of a plain name."""

    def entry(self, key: str) -> object:
        """The value of a blackboard entry."""


class Expression:
    """An expression over one robot's blackboard and figures: ``$goal.pose.x > 3 and coverage < 0.5``.

    Raises:
        ExpressionError: it is too long, or holds what is not allowed.
    """

    def __init__(self, text: str) -> None:
        self.text = text.strip()
        if len(self.text) > LONGEST:
            raise ExpressionError(f"an expression of {len(self.text)} characters; at most {LONGEST}")
        self._root = self._parse()
        self._allow(self._root, 0)

    def check(self, robot: Robot) -> None:
        """Raise an ``ExpressionError`` if it names entries that the robot's tree knows nothing of."""
        keys = known_keys(robot)
        for node in ast.walk(self._root):
            if isinstance(node, ast.Name) and node.id.startswith("_") and node.id[1:] not in keys:
                raise self._fault(node, f"nothing writes ${node.id[1:]}", did_you_mean(node.id[1:], keys))

    def value(self, seen: Seen) -> object:
        """What it is worth now.

        Raises:
            ExpressionError: it has no value: a text is divided, a field is not there.
        """
        return self._eval(self._root, seen)

    def holds(self, seen: Seen) -> bool:
        """Whether it is true, or something that is neither zero, empty nor none."""
        value = self.value(seen)
        try:
            return self._true(self._root, value)
        except ExpressionError:
            raise
        except Exception as error:  # a plugin's value may raise whatever it likes
            raise self._fault(self._root, f"{type(error).__name__}: {error}") from None

    # --- reading ---------------------------------------------------------------------------------------

    def _parse(self) -> ast.expr:
        if not self.text:
            raise ExpressionError(f"an empty expression; allowed: {_ALLOWED}")
        if "\\" in self.text or "\n" in self.text:
            raise ExpressionError("an expression holds no backslash and no line break")
        if foreign := re.search(r"(?<![\w$.'\"])_\w*", self.text):
            raise ExpressionError(f"column {foreign.start() + 1}: {foreign[0]} is not known; write $entry")
        # $entry becomes _entry: as wide as before, so that columns stay what they are
        python = _QUOTED_OR_ENTRY.sub(lambda m: "_" if m[0] == "$" else m[0], self.text)
        try:
            return ast.parse(python, mode="eval").body
        except SyntaxError as error:
            end = len(self.text) + 1
            column = min(error.offset or end, end)  # no offset: more was expected
            raise ExpressionError(
                f"column {column}: not an expression ({error.msg}); allowed: {_ALLOWED}"
            ) from None
        except (ValueError, MemoryError, RecursionError):  # digits or brackets without end
            raise ExpressionError(f"not an expression; allowed: {_ALLOWED}") from None

    def _allow(self, node: ast.AST, depth: int) -> None:
        if depth > DEEPEST:
            raise self._fault(node, f"more than {DEEPEST} levels deep", "make it simpler")
        if isinstance(node, ast.Name):
            self._allow_name(node)
        elif isinstance(node, ast.Constant):
            if not isinstance(node.value, bool | int | float | str | None):
                raise self._fault(node, "is not allowed", _ALLOWED)
        elif isinstance(node, ast.Attribute):
            if node.attr.startswith("_"):
                raise self._fault(node, f".{node.attr} is not a field", "write .field")
        elif isinstance(node, ast.BinOp):
            if type(node.op) not in _ARITHMETIC:
                raise self._fault(node, f"{_sign(node.op)} is not allowed", _ALLOWED)
        elif isinstance(node, ast.UnaryOp):
            if isinstance(node.op, ast.Invert):
                raise self._fault(node, "~ is not allowed", "write not")
        elif not isinstance(node, ast.BoolOp | ast.Compare | ast.Subscript | ast.expr_context):
            if isinstance(node, ast.expr):
                raise self._fault(node, f"{_noun(node)} is not allowed", _ALLOWED)
            return
        for child in ast.iter_child_nodes(node):
            self._allow(child, depth + 1)

    def _allow_name(self, node: ast.Name) -> None:
        name = node.id
        if not name.startswith("_") and name not in NAMES and name.lower() not in _LITERALS:
            hint = did_you_mean(name, NAMES, "names")
            raise self._fault(node, f'there is no name "{name}"', f"{hint}; an entry is written ${name}")

    def _fault(self, node: ast.AST, message: str, hint: str = "") -> ExpressionError:
        before = self.text.encode()[: getattr(node, "col_offset", 0)]  # Python counts bytes
        column = len(before.decode()) + 1
        return ExpressionError(f"column {column}: {message}{f'; {hint}' if hint else ''}")

    # --- reckoning -------------------------------------------------------------------------------------

    def _eval(self, node: ast.expr, seen: Seen) -> object:
        try:
            return self._value(node, seen)
        except ExpressionError:
            raise
        except Exception as error:  # a plugin's value may raise whatever it likes
            raise self._fault(node, f"{type(error).__name__}: {error}") from None

    def _value(self, node: ast.expr, seen: Seen) -> object:
        match node:
            case ast.Constant():
                return node.value
            case ast.Name():
                return self._named(node.id, seen)
            case ast.Attribute():
                return self._field(node, self._eval(node.value, seen))
            case ast.Subscript():
                return self._item(node, self._eval(node.value, seen), self._eval(node.slice, seen))
            case ast.UnaryOp():
                return self._unary(node, self._eval(node.operand, seen))
            case ast.BinOp():
                left = self._number(node.left, self._eval(node.left, seen))
                right = self._number(node.right, self._eval(node.right, seen))
                return _ARITHMETIC[type(node.op)](left, right)
            case ast.BoolOp():
                return self._logical(node, seen)
            case ast.Compare():
                return self._compared(node, seen)
        raise self._fault(node, f"{_noun(node)} is not allowed", _ALLOWED)

    def _named(self, name: str, seen: Seen) -> object:
        if name.startswith("_"):
            return _plain(seen.entry(name[1:]))
        return _LITERALS[name.lower()] if name.lower() in _LITERALS else _plain(seen.name(name))

    def _field(self, node: ast.Attribute, value: object) -> object:
        if value is None:  # of what nobody has written yet
            return None
        if node.attr == "size" and isinstance(value, np.ndarray | Sequence | Mapping | Set):
            return int(value.size) if isinstance(value, np.ndarray) else len(value)
        fields = (
            [field.name for field in dataclasses.fields(value)] if dataclasses.is_dataclass(value) else []
        )
        if node.attr in fields:
            return _plain(getattr(value, node.attr))
        noun, hint = type(value).__name__, did_you_mean(node.attr, fields, "fields")
        raise self._fault(node, f"{noun} has no field {node.attr}", hint)

    def _item(self, node: ast.Subscript, value: object, index: object) -> object:
        if value is None:
            return None
        if isinstance(value, Mapping) and isinstance(index, str | int):
            return _plain(value.get(index))
        if isinstance(value, Sequence) and isinstance(index, int) and not isinstance(index, bool):
            return _plain(value[index]) if -len(value) <= index < len(value) else None
        raise self._fault(node, f"{_described(value)} has no [{show(index)}]")

    def _unary(self, node: ast.UnaryOp, value: object) -> object:
        if isinstance(node.op, ast.Not):
            return not self._true(node.operand, value)
        number = self._number(node.operand, value)
        return -number if isinstance(node.op, ast.USub) else number

    def _logical(self, node: ast.BoolOp, seen: Seen) -> bool:
        held = (self._true(each, self._eval(each, seen)) for each in node.values)
        return all(held) if isinstance(node.op, ast.And) else any(held)

    def _compared(self, node: ast.Compare, seen: Seen) -> bool:
        left = self._eval(node.left, seen)
        for sign, operand in zip(node.ops, node.comparators, strict=True):
            right = self._eval(operand, seen)
            if not self._compare(operand, sign, left, right):
                return False
            left = right
        return True

    def _compare(self, node: ast.expr, sign: ast.cmpop, left: object, right: object) -> bool:
        if isinstance(left, np.ndarray) or isinstance(right, np.ndarray):
            raise self._fault(node, "an array cannot be compared", "compare its .size")
        if isinstance(sign, ast.In | ast.NotIn):
            if not isinstance(right, str | Sequence | Mapping | Set) or len(right) > MOST_SEARCHED:
                raise self._fault(node, f"{_described(right)} cannot be searched")
            return (left in right) is isinstance(sign, ast.In)
        if isinstance(sign, ast.Lt | ast.LtE | ast.Gt | ast.GtE) and (left is None or right is None):
            return False  # what nobody has written yet is neither less nor more
        return bool(_COMPARISONS[type(sign)](left, right))

    def _number(self, node: ast.expr, value: object) -> int | float:
        if isinstance(value, int | float):
            return value
        raise self._fault(node, f"{_described(value)} is not a number")

    def _true(self, node: ast.expr, value: object) -> bool:
        if isinstance(value, np.ndarray):
            raise self._fault(node, "an array is neither true nor false", "compare its .size")
        return bool(value)


def _plain(value: object) -> object:
    """Enumerations and numpy's numbers as what they stand for."""
    if isinstance(value, enum.Enum):
        return _plain(value.value)
    return value.item() if isinstance(value, np.generic) else value


def _described(value: object) -> str:
    return "none" if value is None else f"{type(value).__name__} {show(value)}"


def _noun(node: ast.expr) -> str:
    nouns = {"Call": "a call", "Lambda": "a lambda", "JoinedStr": "an f-string", "IfExp": "if ... else"}
    name = type(node).__name__
    return nouns.get(name, "a comprehension" if name.endswith(("Comp", "Exp")) else f"a {name.lower()}")


def _sign(node: ast.operator) -> str:
    signs = {"Pow": "**", "LShift": "<<", "RShift": ">>", "BitOr": "|", "BitAnd": "&", "BitXor": "^"}
    return signs.get(type(node).__name__, "@")
