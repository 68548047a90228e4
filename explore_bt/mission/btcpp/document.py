"""XML text as elements that know their places.

Read with expat and nothing else: no document type is accepted, so there are no entities to expand, and
nothing is ever fetched.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from explore_bt.mission.faults import Faults
from explore_bt.mission.source import Place, Source

__all__ = ["XmlElement", "parse_xml"]

_DEEPEST = 200
_MOST_ELEMENTS = 20_000
_ATTRIBUTE = re.compile(r"""([^\s=<>/"']+)\s*=\s*("[^"]*"|'[^']*')""")


@dataclass(eq=False)
class XmlElement:
    """An element.

    Attributes:
        attribute_places: where each attribute stands.
    """

    tag: str
    attributes: Mapping[str, str]
    attribute_places: Mapping[str, Place]
    place: Place
    children: list[XmlElement] = field(default_factory=list)

    def get(self, name: str, default: str = "") -> str:
        """The text of an attribute."""
        return self.attributes.get(name, default)

    def place_of(self, name: str) -> Place:
        """Where an attribute stands; the element itself where it has none of that name."""
        return self.attribute_places.get(name, self.place)

    def walk(self) -> Iterator[XmlElement]:
        """This element and all below it."""
        yield self
        for child in self.children:
            yield from child.walk()


def parse_xml(source: Source, faults: Faults) -> XmlElement | None:
    """The root element; None if the text is no XML, or XML that is refused (the faults then say why)."""
    try:
        return _Reader(source, faults).root()
    except _Refused:
        return None
    except expat.ExpatError as error:
        place = source.place(min(error.lineno, len(source.lines)), error.offset + 1)
        faults.add(
            place, f"not XML: {expat.errors.messages[error.code]}", "check tags and quotes here and above"
        )
        return None


class _Refused(Exception):
    """The fault is noted; the rest of the document makes no sense."""


class _Reader:
    def __init__(self, source: Source, faults: Faults) -> None:
        self._source = source
        self._faults = faults
        self._open: list[XmlElement] = []
        self._root: XmlElement | None = None
        self._count = 0
        self._parser = expat.ParserCreate("utf-8")
        self._parser.StartElementHandler = self._start
        self._parser.EndElementHandler = self._end
        self._parser.CharacterDataHandler = self._text
        self._parser.StartDoctypeDeclHandler = self._doctype

    def root(self) -> XmlElement | None:
        self._parser.Parse(self._source.text.encode(), True)
        return self._root

    def _place(self) -> Place:
        return self._source.place(self._parser.CurrentLineNumber, self._parser.CurrentColumnNumber + 1)

    def _doctype(self, *_: object) -> None:
        self._faults.add(self._place(), "a document type is refused", "take <!DOCTYPE ...> out")
        raise _Refused

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        place = self._place()
        place = self._source.place(place.line, place.column, len(tag) + 1)
        self._count += 1
        if self._count > _MOST_ELEMENTS or len(self._open) > _DEEPEST:
            self._faults.add(
                place, f"more than {_MOST_ELEMENTS} elements, or over {_DEEPEST} deep", "split the tree"
            )
            raise _Refused
        element = XmlElement(tag, attributes, self._attribute_places(place, attributes), place)
        if self._open:
            self._open[-1].children.append(element)
        else:
            self._root = element
        self._open.append(element)

    def _end(self, _: str) -> None:
        self._open.pop()

    def _text(self, text: str) -> None:
        described = self._open and self._open[-1].tag in (
            "input_port",
            "output_port",
            "inout_port",
            "description",
        )
        if text.strip() and not described:
            self._faults.add(
                self._place(), f'the text "{text.strip()[:40]}" stands between the tags', "take it out"
            )

    def _attribute_places(self, start: Place, attributes: Mapping[str, str]) -> dict[str, Place]:
        """Found again in the text, for expat tells only where the tag begins."""
        if not attributes:
            return {}
        places: dict[str, Place] = {}
        text, line, column = self._source.lines[start.line - 1][start.column - 1 :], start.line, start.column
        for _ in range(len(self._source.lines) - start.line + 1):
            for match in _ATTRIBUTE.finditer(text):
                width = match.end() - match.start()
                places.setdefault(match[1], self._source.place(line, column + match.start(), width))
            if attributes.keys() <= places.keys() or line == len(self._source.lines):
                break
            line, column = line + 1, 1
            text = self._source.lines[line - 1]
        return {name: places[name] for name in attributes if name in places}
