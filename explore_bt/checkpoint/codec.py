"""Frozen values as JSON and back: only what is listed here, nothing that could run code."""

from __future__ import annotations

import base64
import binascii
import dataclasses
import enum
import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import ExploreError

__all__ = ["Codec", "CodecError"]

_ARRAY_KINDS = "biuf"
_FLOATS = {"nan": math.nan, "inf": math.inf, "-inf": -math.inf}
_PLAIN = (bool, int, str, type(None))


class CodecError(ExploreError):
    """A value of a class that was not declared, or text that no codec has written."""


class Codec:
    """Writes and reads values made of plain ones, tuples and the classes it was given.

    None, booleans, whole numbers, text and finite numbers are JSON's own, a tuple is its list; all else
    is an object with one telling key: ``float``, ``list``, ``map``, ``set``, ``enum``, ``class``, ``array``.
    Numbers come back to the last bit; numpy's scalars as Python's, arrays read-only.

    Args:
        classes: dataclasses and enumerations that may occur, known by their names.
    """

    def __init__(self, classes: Iterable[type]) -> None:
        self._classes: dict[str, type] = {}
        for each in classes:
            if not (dataclasses.is_dataclass(each) or issubclass(each, enum.Enum)):
                raise TypeError(f"{each.__qualname__} is neither a dataclass nor an enumeration")
            if self._classes.setdefault(each.__name__, each) is not each:
                raise TypeError(f"two classes are called {each.__name__}: rename one of them")

    def dumps(self, value: object) -> str:
        """A value as one line of ASCII.

        Raises:
            CodecError: something in it is of no class that was declared.
        """
        return json.dumps(self.encode(value), separators=(",", ":"), allow_nan=False)

    def loads(self, text: str | bytes) -> Any:
        """The value of such a line.

        Raises:
            CodecError: no codec of this version has written it.
        """
        try:
            return self.decode(json.loads(text))
        except (ValueError, RecursionError) as fault:  # UnicodeDecodeError and JSONDecodeError among them
            raise CodecError(f"not readable as JSON: {fault}") from None

    def encode(self, value: object) -> object:
        """A value as ``json`` takes it."""
        if isinstance(value, enum.Enum):
            return {"enum": self._name(type(value)), "name": value.name}
        if isinstance(value, np.generic):
            return self.encode(value.item())
        if isinstance(value, float):
            return value if math.isfinite(value) else {"float": str(value)}
        if type(value) in _PLAIN:
            return value
        if type(value) is tuple:
            return [self.encode(item) for item in value]
        if isinstance(value, np.ndarray):
            return _array_text(value)
        return self._encode_compound(value)

    def decode(self, data: Any) -> Any:
        """The value that ``encode`` was given."""
        if isinstance(data, float) or type(data) in _PLAIN:
            return data
        if isinstance(data, list):
            return tuple(self.decode(item) for item in data)
        if not isinstance(data, dict) or not data:
            raise CodecError(f"{data!r} stands for no value")
        kind = next(iter(data))
        reader = getattr(self, f"_read_{kind}", None) if kind in _KINDS else None
        if reader is None:
            raise CodecError(f'no value is told by "{kind}"')
        try:
            return reader(data)
        except (KeyError, TypeError, ValueError, AttributeError, binascii.Error) as fault:
            raise CodecError(f'a value told by "{kind}" is damaged: {fault}') from None

    def _encode_compound(self, value: object) -> object:
        if dataclasses.is_dataclass(value) and not isinstance(value, type):
            fields = {
                field.name: self.encode(getattr(value, field.name))
                for field in dataclasses.fields(value)
                if field.init
            }
            return {"class": self._name(type(value)), "fields": fields}
        if type(value) is list:
            return {"list": [self.encode(item) for item in value]}
        if isinstance(value, Mapping):
            return {"map": [[self.encode(key), self.encode(item)] for key, item in value.items()]}
        if isinstance(value, set | frozenset):
            return {"set": sorted((self.encode(item) for item in value), key=json.dumps)}
        raise CodecError(f"a {type(value).__name__} cannot be kept")

    def _name(self, cls: type) -> str:
        if self._classes.get(cls.__name__) is not cls:
            raise CodecError(f"a {cls.__name__} cannot be kept: nobody has declared that class")
        return cls.__name__

    def _class(self, name: str) -> type:
        if name not in self._classes:
            raise CodecError(f"{name} is no class that anybody has declared here")
        return self._classes[name]

    def _read_float(self, data: Mapping[str, Any]) -> float:
        return _FLOATS[data["float"]]

    def _read_list(self, data: Mapping[str, Any]) -> list[Any]:
        return [self.decode(item) for item in data["list"]]

    def _read_map(self, data: Mapping[str, Any]) -> dict[Any, Any]:
        return {self.decode(key): self.decode(item) for key, item in data["map"]}

    def _read_set(self, data: Mapping[str, Any]) -> frozenset[Any]:
        return frozenset(self.decode(item) for item in data["set"])

    def _read_enum(self, data: Mapping[str, Any]) -> Any:
        cls = self._class(data["enum"])
        if not issubclass(cls, enum.Enum):
            raise CodecError(f"{cls.__name__} is no enumeration")
        return cls[data["name"]]

    def _read_class(self, data: Mapping[str, Any]) -> Any:
        cls = self._class(data["class"])
        if not dataclasses.is_dataclass(cls):
            raise CodecError(f"{cls.__name__} is no dataclass")
        return cls(**{str(name): self.decode(item) for name, item in data["fields"].items()})

    def _read_array(self, data: Mapping[str, Any]) -> NDArray[Any]:
        dtype = np.dtype(str(data["dtype"]))
        if dtype.kind not in _ARRAY_KINDS:
            raise CodecError(f"arrays of {dtype} are not kept")
        raw = base64.b64decode(data["array"], validate=True)
        return np.frombuffer(raw, dtype=dtype).reshape([int(side) for side in data["shape"]])


_KINDS = ("float", "list", "map", "set", "enum", "class", "array")


def _array_text(array: NDArray[Any]) -> dict[str, object]:
    if array.dtype.kind not in _ARRAY_KINDS:
        raise CodecError(f"an array of {array.dtype} cannot be kept")
    dtype = array.dtype.newbyteorder("<")
    raw = np.ascontiguousarray(array, dtype=dtype).tobytes()
    return {"array": base64.b64encode(raw).decode(), "dtype": dtype.str, "shape": list(array.shape)}
