"""Mission files to checked missions."""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.document import Entries, Entry, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.files import INCLUDE_KEYS, MissionText, read_files
from explore_bt.mission.limits import read_limits, read_tick
from explore_bt.mission.model import Mission, RobotSpec
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.overrides import SECTIONS, Override, as_settings, overridden, read_overrides
from explore_bt.mission.param_section import read_params
from explore_bt.mission.params import PLUGIN_KINDS, Param
from explore_bt.mission.reading import expect_entries, expect_items, expect_text, is_null, written
from explore_bt.mission.references import Scope, resolve
from explore_bt.mission.robots import read_robot, read_team, unknown_plugin
from explore_bt.mission.source import Place
from explore_bt.mission.tree_reader import TreeReader
from explore_bt.mission.wiring import check_wiring
from explore_bt.mission.words import did_you_mean

__all__ = ["load_mission", "load_tree"]

_MISSION_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]*")


def load_mission(
    path: Path,
    catalog: PluginCatalog,
    overrides: Sequence[str] | Mapping[str, str] = (),
    cwd: Path | None = None,
    environ: Mapping[str, str] | None = None,
    texts: Mapping[Path, str] | None = None,
) -> Mission:
    """Read, resolve and check a mission; no robot is needed and no plugin is set up.

    Args:
        path: the mission file.
        catalog: the installed plugins.
        overrides: ``name=value``: a parameter, or ``limits.x`` or ``tick.x``; the value is YAML.
        cwd: what relative files in overrides are relative to; the current directory by default.
        environ: what ``$env.X`` means; the process's environment by default.
        texts: real path -> text, of files that are taken as they once were and not as they are now.

    Raises:
        MissionError: with every fault of every file and override.
    """
    faults = Faults()
    settings = as_settings(overrides)
    given = read_overrides(settings, cwd or Path.cwd(), faults)
    mission = read_files(path, faults, texts=texts)
    if mission is None:
        faults.raise_if_any()
    assert mission is not None  # read_files has noted why not, and that was raised
    loaded = _Loader(mission, catalog, given, os.environ if environ is None else environ, faults).load(path)
    return replace(loaded, settings=tuple(settings), settings_folder=Path(os.path.abspath(cwd or Path.cwd())))


def load_tree(
    path: Path, names: Sequence[str], catalog: PluginCatalog, settings: Mapping[str, str] | None = None
) -> NodeSpec:
    """Read and check one tree of a file that holds only trees and parameters, for no robot in particular.

    Args:
        path: a file as missions include it.
        names: the tree that is wanted; the first of several that is there.
        catalog: the installed plugins.
        settings: parameter -> value as YAML.

    Raises:
        MissionError: with every fault of the file and the settings.
    """
    faults = Faults()
    given = read_overrides(settings or {}, Path.cwd(), faults)
    text = read_files(path, faults, INCLUDE_KEYS)
    if text is None:
        faults.raise_if_any()
    assert text is not None  # as in load_mission
    _, params = read_params(text, given, catalog, os.environ, faults)
    reader = TreeReader(text.trees, text.is_whole, catalog, faults)
    name = next((name for name in names if name in text.trees), names[0])
    root = reader.root(Scalar(name, name, True, text.source.place()), Scope(params, os.environ, "robot"))
    if root is not None and reader.complete:
        check_wiring(root, faults)
    faults.raise_if_any()
    assert root is not None  # else a fault was noted
    return root


class _Loader:
    """Goes through the sections in the order in which they depend on one another."""

    def __init__(
        self,
        text: MissionText,
        catalog: PluginCatalog,
        overrides: Sequence[Override],
        environ: Mapping[str, str],
        faults: Faults,
    ) -> None:
        self._text = text
        self._root = text.root
        self._catalog = catalog
        self._overrides = overrides
        self._environ = environ
        self._faults = faults

    def load(self, path: Path) -> Mission:
        name = self._name(path)
        doc = expect_text(self._root.get("doc"), "doc", self._faults) or ""
        declared, params = self._params()
        self._check_plugins()
        sections = {section: self._section(section, params) for section in SECTIONS}
        limits = read_limits(sections["limits"], self._text.source.folder, self._faults)
        tree_hz, control_hz = read_tick(sections["tick"], self._text.source.folder, self._faults)
        robots = self._robots(params)
        team = read_team(
            self._root, len(robots) > 1, Scope(params, self._environ), self._catalog, self._faults
        )
        self._faults.raise_if_any()
        return Mission(
            name=name,
            doc=doc,
            path=path,
            text=self._text.source.text,
            sha256=_digest(self._text, params),
            params=params,
            robots=robots,
            tree_rate_hz=tree_hz,
            control_rate_hz=control_hz,
            limits=limits,
            included=tuple(self._text.included),
            declared=declared,
            sources={each.name: each.text for each in (self._text.source, *self._text.included.values())},
            texts=_texts(path, self._text),
            team=team,
        )

    def _name(self, path: Path) -> str:
        value = self._root.get("name")
        name = expect_text(value, "name", self._faults)
        if value is not None and name is not None and not _MISSION_NAME.fullmatch(name):
            self._faults.add(value.place, f'"{name}" is no name for a mission', "letters, digits, _ . -")
        return name or path.stem

    def _params(self) -> tuple[tuple[Param, ...], dict[str, object]]:
        return read_params(self._text, self._overrides, self._catalog, self._environ, self._faults)

    def _section(self, section: str, params: Mapping[str, object]) -> Entries:
        found = expect_entries(self._root.get(section), section, "name: value", self._faults)
        entries = overridden(section, found or Entries((), self._root.place), self._overrides)
        scope = Scope(params, self._environ)
        resolved = (Entry(e.key, e.place, resolve(e.value, scope, self._faults)) for e in entries)
        return Entries(tuple(resolved), entries.place)

    def _check_plugins(self) -> None:
        for value in expect_items(self._root.get("plugins"), "plugins", "[behaviour/my_leaf]", self._faults):
            text = value.data if isinstance(value, Scalar) else None
            kind, slash, name = text.partition("/") if isinstance(text, str) else ("", "", "")
            if not slash or not name:
                message = f"plugins: {written(value)} is not of the form kind/name"
                self._faults.add(value.place, message, "for example slam/kiss_gtsam")
            elif kind not in PLUGIN_KINDS:
                hint = did_you_mean(kind, PLUGIN_KINDS, "kinds")
                self._faults.add(value.place, f'there is no plugin kind "{kind}"', hint)
            elif name not in self._catalog.names(kind):
                unknown_plugin(self._catalog, kind, name, value.place, self._faults)

    def _robots(self, params: Mapping[str, object]) -> tuple[RobotSpec, ...]:
        reader = TreeReader(self._text.trees, self._text.is_whole, self._catalog, self._faults)
        robots = []
        for entry in self._robot_entries():
            scope = Scope(params, self._environ, entry.key)

            def read_tree(own: Value | None, place: Place, scope: Scope = scope) -> NodeSpec | None:
                return self._tree(reader, own, place, scope)

            robots.append(read_robot(entry, scope, self._catalog, read_tree, self._faults))
        reader.check_unused(Scope(params, self._environ, "robot"))
        return tuple(robot for robot in robots if robot is not None)

    def _robot_entries(self) -> Entries:
        section = self._root.by_key.get("robots")
        value = section.value if section else None
        example = "robots: {robot: {...}}"
        entries = expect_entries(value, "robots", example, self._faults) or Entries((), self._root.place)
        if is_null(value) or (isinstance(value, Entries) and not value.entries):
            place = section.place if section else self._root.place
            self._faults.add(place, "the mission has no robots", f"write {example}")
        return entries

    def _tree(self, reader: TreeReader, own: Value | None, place: Place, scope: Scope) -> NodeSpec | None:
        value = own or self._root.get("tree")
        if value is None:
            hint = did_you_mean("", self._text.trees, "write tree: NAME; trees")
            self._faults.add(place, f"robot {scope.robot} has no tree", hint)
            return None
        root = reader.root(value, scope)
        if root is not None and reader.complete:
            check_wiring(root, self._faults)
        return root


def _texts(path: Path, text: MissionText) -> Mapping[Path, str]:
    included = {real: source.text for real, source in text.included.items()}
    return {Path(os.path.realpath(path)): text.source.text, **included}


def _digest(text: MissionText, params: Mapping[str, object]) -> str:
    folder = text.source.folder

    def portable(value: object) -> object:
        return Path(os.path.relpath(value, folder)).as_posix() if isinstance(value, Path) else str(value)

    digest = hashlib.sha256()
    for part in (text.source.text, *(source.text for source in text.included.values())):
        digest.update(hashlib.sha256(part.encode()).digest())
    digest.update(json.dumps(params, sort_keys=True, default=portable).encode())
    return digest.hexdigest()
