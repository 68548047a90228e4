"""What a field or port asks of its value: dimension and bounds, read from its type."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, get_args

from explore_bt.mission.words import quantity
from explore_bt.tree import Input
from explore_bt.units import Dimension

__all__ = ["Asked", "asked_by_field", "asked_by_port", "dimension_of"]


@dataclass(frozen=True, slots=True)
class Asked:
    """What a number has to be; None where nothing is asked."""

    dimension: Dimension | None = None
    ge: float | None = None
    le: float | None = None
    gt: float | None = None
    lt: float | None = None

    @property
    def noun(self) -> str:
        """``length``, or ``number``, with its bounds."""
        noun = self.dimension.name if self.dimension else "number"
        article = "an" if noun[0] in "aeiou" else "a"
        return " ".join(filter(None, (article, noun, self.range)))

    @property
    def range(self) -> str:
        """``between 0 m and 5 m``, ``of at least 1``, ``above 0``; empty without bounds."""
        if self.ge is not None and self.le is not None:
            return f"between {self._shown(self.ge)} and {self._shown(self.le)}"
        parts = []
        if self.gt is not None:
            parts.append(f"above {self._shown(self.gt)}")
        if self.ge is not None:
            parts.append(f"of at least {self._shown(self.ge)}")
        if self.lt is not None:
            parts.append(f"below {self._shown(self.lt)}")
        if self.le is not None:
            parts.append(f"of at most {self._shown(self.le)}")
        return " and ".join(parts)

    def _shown(self, bound: float) -> str:
        return quantity(bound, self.dimension)


def dimension_of(type_: Any) -> Dimension | None:
    """The physical dimension of an annotated type, also inside a union."""
    metadata = getattr(type_, "__metadata__", ())
    found = next((each for each in metadata if isinstance(each, Dimension)), None)
    return found or next(filter(None, map(dimension_of, get_args(type_))), None)


def asked_by_port(port: Input[Any]) -> Asked:
    """What a leaf's input asks."""
    return Asked(dimension_of(port.type), port.ge, port.le)


def asked_by_field(annotation: Any, metadata: list[Any]) -> Asked:
    """What a field of a plugin's options asks."""
    inside = [each for part in get_args(annotation) for each in getattr(part, "__metadata__", ())]
    inside += [each for item in inside for each in getattr(item, "metadata", ())]
    every = [*metadata, *inside]
    dimension = next((each for each in every if isinstance(each, Dimension)), None) or dimension_of(
        annotation
    )
    bounds = {
        name: next((getattr(each, name) for each in every if getattr(each, name, None) is not None), None)
        for name in ("ge", "le", "gt", "lt")
    }
    return Asked(dimension, **bounds)
