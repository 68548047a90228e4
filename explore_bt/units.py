"""Quantities with units, at the edge between people and code.

Inside the code every number is SI and every angle radians. In a mission file a quantity carries its
unit (``0.30 m``, ``90 deg``, ``60 s``); a bare number is SI.

Use the annotated types as pydantic fields (plugin options) or as port types of a leaf; both then share
one parser, one set of messages and one JSON schema.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, PlainValidator, ValidationInfo, WithJsonSchema

__all__ = [
    "ACCELERATION",
    "ANGLE",
    "ANGULAR_ACCELERATION",
    "ANGULAR_JERK",
    "ANGULAR_RATE",
    "AREA",
    "DURATION",
    "FREQUENCY",
    "JERK",
    "LENGTH",
    "SHARE",
    "SPEED",
    "Acceleration",
    "Angle",
    "AngularAcceleration",
    "AngularJerk",
    "AngularRate",
    "Area",
    "Dimension",
    "Duration",
    "FileOrFolderPath",
    "FilePath",
    "Frequency",
    "Jerk",
    "Length",
    "PoseTriple",
    "Share",
    "Speed",
    "parse_quantity",
]

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = re.compile(rf"^\s*({_NUMBER})\s*([^\d\s].*?)?\s*$")


@dataclass(frozen=True, slots=True)
class Dimension:
    """A physical dimension, the units people may write, and examples of how to write it."""

    name: str
    si: str
    factors: tuple[tuple[str, float], ...]
    example: str

    def factor(self, unit: str) -> float | None:
        """SI value of one ``unit``, or None where the unit is not of this dimension."""
        return dict(self.factors).get(unit)


_DEG = math.pi / 180.0

LENGTH = Dimension(
    "length", "m", (("m", 1.0), ("cm", 0.01), ("mm", 0.001), ("km", 1000.0)), "0.30 m or 30 cm"
)
AREA = Dimension("area", "m²", (("m²", 1.0), ("m2", 1.0), ("cm²", 1e-4), ("cm2", 1e-4)), "0.5 m2")
ANGLE = Dimension("angle", "rad", (("rad", 1.0), ("deg", _DEG), ("°", _DEG)), "90 deg or 1.57 rad")
DURATION = Dimension(
    "duration", "s", (("s", 1.0), ("ms", 0.001), ("min", 60.0), ("h", 3600.0)), "60 s or 2 min"
)
SPEED = Dimension("speed", "m/s", (("m/s", 1.0), ("cm/s", 0.01), ("km/h", 1 / 3.6)), "0.5 m/s")
ACCELERATION = Dimension("acceleration", "m/s²", (("m/s²", 1.0), ("m/s2", 1.0), ("m/s^2", 1.0)), "0.5 m/s2")
JERK = Dimension("jerk", "m/s³", (("m/s³", 1.0), ("m/s3", 1.0), ("m/s^3", 1.0)), "2 m/s3")
ANGULAR_RATE = Dimension(
    "angular rate", "rad/s", (("rad/s", 1.0), ("deg/s", _DEG), ("°/s", _DEG)), "60 deg/s"
)
ANGULAR_ACCELERATION = Dimension(
    "angular acceleration",
    "rad/s²",
    (
        ("rad/s²", 1.0),
        ("rad/s2", 1.0),
        ("rad/s^2", 1.0),
        ("deg/s²", _DEG),
        ("deg/s2", _DEG),
        ("deg/s^2", _DEG),
    ),
    "2 rad/s2",
)
ANGULAR_JERK = Dimension(
    "angular jerk",
    "rad/s³",
    (
        ("rad/s³", 1.0),
        ("rad/s3", 1.0),
        ("rad/s^3", 1.0),
        ("deg/s³", _DEG),
        ("deg/s3", _DEG),
        ("deg/s^3", _DEG),
    ),
    "8 rad/s3",
)
SHARE = Dimension("share", "parts of 1", (("%", 0.01),), "20 % or 0.2")
FREQUENCY = Dimension("frequency", "Hz", (("Hz", 1.0), ("kHz", 1000.0)), "10 Hz")


def parse_quantity(value: object, dimension: Dimension) -> float:
    """The SI value of what a person wrote.

    Args:
        value: a bare number (SI), or text such as ``"30 cm"``.
        dimension: what it has to be.

    Returns:
        The value in SI units, finite.

    Raises:
        ValueError: with one sentence ("``30 s`` is not a length; write 0.30 m or 30 cm").
    """
    refusal = f"{value} is not {_article(dimension.name)} {dimension.name}; write {dimension.example}"
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(refusal)
    if isinstance(value, int | float):
        number, factor = float(value), 1.0
    else:
        match = _QUANTITY.match(value)
        found = dimension.factor(match[2]) if match and match[2] else 1.0 if match else None
        if match is None or found is None:
            raise ValueError(refusal)
        number, factor = float(match[1]), found
    if not math.isfinite(number * factor):
        raise ValueError(refusal)
    return number * factor


def _article(noun: str) -> str:
    return "an" if noun[0] in "aeiou" else "a"


def _quantity(dimension: Dimension) -> tuple[Any, ...]:
    pattern = rf"^\s*{_NUMBER}\s*({'|'.join(re.escape(unit) for unit, _ in dimension.factors)})?\s*$"
    schema = {
        "anyOf": [{"type": "number"}, {"type": "string", "pattern": pattern}],
        "description": f"{dimension.name}, bare numbers in {dimension.si}; for example {dimension.example}",
        "x-dimension": dimension.name,
    }
    return (
        BeforeValidator(lambda value: parse_quantity(value, dimension)),
        WithJsonSchema(schema),
        dimension,
    )


Length = Annotated[float, *_quantity(LENGTH)]
Area = Annotated[float, *_quantity(AREA)]
Angle = Annotated[float, *_quantity(ANGLE)]
Duration = Annotated[float, *_quantity(DURATION)]
Speed = Annotated[float, *_quantity(SPEED)]
Acceleration = Annotated[float, *_quantity(ACCELERATION)]
Jerk = Annotated[float, *_quantity(JERK)]
AngularRate = Annotated[float, *_quantity(ANGULAR_RATE)]
AngularAcceleration = Annotated[float, *_quantity(ANGULAR_ACCELERATION)]
AngularJerk = Annotated[float, *_quantity(ANGULAR_JERK)]
Frequency = Annotated[float, *_quantity(FREQUENCY)]
Share = Annotated[float, *_quantity(SHARE)]


def _parse_pose(value: object) -> tuple[float, float, float]:
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError(f"{value} is not a pose; write [x, y, heading], for example [1.0 m, 2.0 m, 90 deg]")
    x, y, heading = value
    return (parse_quantity(x, LENGTH), parse_quantity(y, LENGTH), parse_quantity(heading, ANGLE))


PoseTriple = Annotated[
    tuple[float, float, float],
    BeforeValidator(_parse_pose),
    WithJsonSchema(
        {
            "type": "array",
            "minItems": 3,
            "maxItems": 3,
            "items": {"anyOf": [{"type": "number"}, {"type": "string"}]},
            "description": "x, y (m) and heading (rad), for example [1.0 m, 2.0 m, 90 deg]",
        }
    ),
]
"""A pose as people write it: ``[x, y, heading]``, metres and radians after validation."""


def _resolve_file(value: object, info: ValidationInfo) -> Path:
    path, must_exist = _resolve_path(value, info)
    if must_exist and not path.is_file():
        raise ValueError(f"there is no file {path}")
    return path


def _resolve_file_or_folder(value: object, info: ValidationInfo) -> Path:
    path, must_exist = _resolve_path(value, info)
    if must_exist and not path.exists():
        raise ValueError(f"there is no file or folder {path}")
    return path


def _resolve_path(value: object, info: ValidationInfo) -> tuple[Path, bool]:
    if not isinstance(value, str | Path) or not str(value):
        raise ValueError(f"{value} is not a file name")
    context = info.context or {}
    base = context.get("base_dir")
    path = Path(value).expanduser()
    path = path if path.is_absolute() or base is None else Path(base) / path
    return path, bool(context.get("must_exist"))


FilePath = Annotated[
    Path,
    PlainValidator(_resolve_file),
    WithJsonSchema({"type": "string", "description": "a file, relative to the mission's folder"}),
]
"""A file; a relative one is looked up in the folder given as ``base_dir`` in the validation context,
and has to be there where that context says ``must_exist``."""

FileOrFolderPath = Annotated[
    Path,
    PlainValidator(_resolve_file_or_folder),
    WithJsonSchema({"type": "string", "description": "a file or folder, relative to the mission's folder"}),
]
"""The same, and a folder will do: some formats are folders."""
