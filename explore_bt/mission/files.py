"""Reading a mission and the files it includes, none of them outside the mission's folder."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from explore_bt.mission.document import Entries, Entry, Scalar, Value, parse_document
from explore_bt.mission.faults import Faults
from explore_bt.mission.reading import check_keys, expect_entries, expect_items, written
from explore_bt.mission.source import Place, Source
from explore_bt.mission.words import did_you_mean

__all__ = ["FORMAT", "INCLUDE_KEYS", "MISSION_KEYS", "MissionText", "read_files", "read_mapping", "read_text"]

FORMAT = "explore-bt/1"
_HINT = f"begin with format: {FORMAT}"
MISSION_KEYS = (
    "format",
    "name",
    "doc",
    "params",
    "include",
    "plugins",
    "robots",
    "team",
    "allocator",
    "tick",
    "limits",
    "tree",
    "trees",
)
INCLUDE_KEYS = ("format", "doc", "params", "trees", "include")
_LARGEST_BYTES = 1_000_000
_MOST_FILES = 50


@dataclass
class MissionText:
    """The mission's own mapping, and the parameters and trees of all files.

    Attributes:
        is_whole: False once an included file could not be read; the fault is noted.
    """

    source: Source
    root: Entries
    params: dict[str, Entry] = field(default_factory=dict)
    trees: dict[str, Entry] = field(default_factory=dict)
    included: dict[Path, Source] = field(default_factory=dict)
    is_whole: bool = True


def read_files(
    path: Path,
    faults: Faults,
    known: tuple[str, ...] = MISSION_KEYS,
    texts: Mapping[Path, str] | None = None,
) -> MissionText | None:
    """The mission file and all it includes; None if it cannot be read as a mapping at all.

    Args:
        path: the file.
        faults: what is wrong with it is noted here.
        known: the keys it may hold; ``INCLUDE_KEYS`` for a file of trees.
        texts: real path -> text, of files that are not read but known already.
    """
    files = _Files(texts or {}, faults)
    file = _mapping_of(files, path, "the mission", _HINT, faults)
    if file is None:
        return None
    source, root = file
    mission = MissionText(source, root)
    _Collector(mission, path, files, faults).collect(root, known, (Path(os.path.realpath(path)),))
    return mission


def read_mapping(path: Path, shown: str, hint: str, faults: Faults) -> tuple[Source, Entries] | None:
    """A file that has to be a mapping; None with the fault noted if it is none.

    Args:
        path: the file.
        shown: what it is to people.
        hint: what to do if it is something else.
        faults: what is wrong with it is noted here.
    """
    return _mapping_of(_Files({}, faults), path, shown, hint, faults)


def _mapping_of(
    files: _Files, path: Path, shown: str, hint: str, faults: Faults
) -> tuple[Source, Entries] | None:
    head = Source(str(path), "", path.parent, has_lines=False)
    text = files.read(path, head.place(), shown)
    if text is None:
        return None
    source = Source(str(path), text, path.parent)
    root = _mapping(source, shown, hint, faults)
    return None if root is None else (source, root)


def _mapping(source: Source, shown: str, hint: str, faults: Faults) -> Entries | None:
    value = parse_document(source, faults)
    if value is None or isinstance(value, Entries):
        return value
    found = "empty" if isinstance(value, Scalar) and value.data is None else written(value)
    faults.add(source.place(), f"{shown.replace('the ', 'a ', 1)} is a mapping; this is {found}", hint)
    return None


def read_text(path: Path, place: Place, shown: str, faults: Faults) -> str | None:
    """A small text; None if it cannot be read (the fault is noted at ``place``)."""
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        faults.add(place, f"{shown} cannot be read: {reason.lower()}")
        return None
    if len(data) > _LARGEST_BYTES:
        faults.add(place, f"{shown} is larger than 1 MB", "missions and trees are small texts")
        return None
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        faults.add(place, f"{shown} is not UTF-8 text (byte {error.start})", "save it as UTF-8")
        return None


class _Files:
    """Texts of files: those that are known already, and those on the disk."""

    def __init__(self, texts: Mapping[Path, str], faults: Faults) -> None:
        self._texts = texts
        self._faults = faults

    def read(self, path: Path, place: Place, shown: str) -> str | None:
        """The text; None where there is none, and a fault is noted."""
        known = self._texts.get(Path(os.path.realpath(path))) if self._texts else None
        return known if known is not None else read_text(path, place, shown, self._faults)


class _Collector:
    """Walks the includes depth first and gathers parameters and trees."""

    def __init__(self, mission: MissionText, path: Path, files: _Files, faults: Faults) -> None:
        self._mission = mission
        self._files = files
        self._faults = faults
        self._folder = Path(os.path.realpath(path.parent))
        self._shown_folder = path.parent

    def collect(self, root: Entries, known: tuple[str, ...], way: tuple[Path, ...]) -> None:
        """Take what one file brings; ``way`` are the real paths of the files that led to it."""
        if known == INCLUDE_KEYS:
            self._check_included_keys(root)
        else:
            check_keys(root, known, "a mission", self._faults)
        self._check_format(root, required=known == MISSION_KEYS)
        self._gather(root, "params", "{stride: {type: length, default: 1 m}}", self._mission.params)
        self._gather(root, "trees", "{go: {sequence: [...]}}", self._mission.trees)
        for value in expect_items(root.get("include"), "include", "[trees/complete.yaml]", self._faults):
            if not self._include(value, way):
                self._mission.is_whole = False

    def _check_included_keys(self, root: Entries) -> None:
        for entry in root:
            if entry.key in MISSION_KEYS and entry.key not in INCLUDE_KEYS:
                hint = f"an included file holds only {', '.join(INCLUDE_KEYS)}"
                self._faults.add(entry.place, f'"{entry.key}" belongs into the mission itself', hint)
            elif entry.key not in INCLUDE_KEYS:
                hint = did_you_mean(entry.key, INCLUDE_KEYS)
                self._faults.add(entry.place, f'an included file has no key "{entry.key}"', hint)

    def _check_format(self, root: Entries, required: bool) -> None:
        entry = root.by_key.get("format")
        if entry is None:
            if required:
                self._faults.add(root.place, "the mission says no format", f"begin with format: {FORMAT}")
        elif not isinstance(entry.value, Scalar) or entry.value.data != FORMAT:
            message = f"format {written(entry.value)} is not known"
            self._faults.add(entry.value.place, message, f"write format: {FORMAT}")

    def _gather(self, root: Entries, section: str, example: str, into: dict[str, Entry]) -> None:
        entries = expect_entries(root.get(section), section, example, self._faults)
        for entry in entries or ():
            if entry.key in into:
                message = f"{section}.{entry.key} has two owners"
                self._faults.add(entry.place, message, f"the other stands at {into[entry.key].place}")
            else:
                into[entry.key] = entry

    def _include(self, value: Value, way: tuple[Path, ...]) -> bool:
        """Whether the file's content is there now."""
        if not isinstance(value, Scalar) or not isinstance(value.data, str) or not value.data:
            self._faults.add(value.place, f"include: {written(value)} is not a file name")
            return False
        named = value.place.source.folder / value.data
        real = self._real_path(named, value)
        if real is None:
            return False
        if real in way:
            round_trip = " -> ".join(each.name for each in (*way[way.index(real) :], real))
            self._faults.add(value.place, f"files include one another: {round_trip}", "remove one include")
            return True
        if real in self._mission.included:
            return True
        if len(self._mission.included) >= _MOST_FILES:
            self._faults.add(value.place, f"more than {_MOST_FILES} included files")
            return False
        text = self._files.read(real, value.place, value.data)
        if text is None:
            return False
        shown = os.path.join(os.path.dirname(value.place.source.name), value.data)
        source = Source(os.path.normpath(shown), text, named.parent)
        self._mission.included[real] = source
        root = _mapping(source, "the mission", _HINT, self._faults)
        if root is None:
            return False
        self.collect(root, INCLUDE_KEYS, (*way, real))
        return True

    def _real_path(self, named: Path, value: Scalar) -> Path | None:
        """Where the file really is; None (and a fault) if that is outside the mission's folder."""
        try:
            real = Path(os.path.realpath(named))
        except (OSError, ValueError):
            self._faults.add(value.place, f"include: {value.text} is not a file name")
            return None
        if Path(str(value.data)).is_absolute() or not real.is_relative_to(self._folder):
            message = f"{value.text} lies outside the mission's folder"
            self._faults.add(value.place, message, f"included files stay below {self._shown_folder}/")
            return None
        return real
