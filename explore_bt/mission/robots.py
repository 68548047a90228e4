"""The section ``robots``: each robot's plugins with their options, its start, its tree."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

from pydantic import TypeAdapter

from explore_bt.errors import PluginError
from explore_bt.interfaces import Allocator, Controller, Driver, Planner, Slam, Team
from explore_bt.mission.bounds import Asked
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.checking import check_model, check_value
from explore_bt.mission.document import Entries, Entry, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.model import PluginChoice, RobotSpec, TeamSpec
from explore_bt.mission.nodes import NodeSpec
from explore_bt.mission.reading import check_keys, expect_entries, written
from explore_bt.mission.references import BROKEN, Scope, resolve
from explore_bt.mission.source import Place
from explore_bt.mission.words import did_you_mean
from explore_bt.types import Pose2
from explore_bt.units import FilePath, PoseTriple

__all__ = [
    "PLUGINS",
    "ROBOT_KEYS",
    "TEAM_PLUGINS",
    "UNKNOWN_START",
    "read_robot",
    "read_team",
    "unknown_plugin",
]

PLUGINS = ("driver", "slam", "planner", "controller")
TEAM_PLUGINS = ("team", "allocator")
ROBOT_KEYS = ("start", "map", *PLUGINS, "tree", "doc")
UNKNOWN_START = "unknown"
_ROBOT_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


def unknown_plugin(catalog: PluginCatalog, kind: str, name: str, place: Place, faults: Faults) -> None:
    """Note that a plugin is not installed, with what is."""
    hint = did_you_mean(name, catalog.names(kind), "installed")
    faults.add(place, f'no {kind} is called "{name}"', f"{hint}  (see explore-bt plugins)")


def read_robot(
    entry: Entry,
    scope: Scope,
    catalog: PluginCatalog,
    read_tree: Callable[[Value | None, Place], NodeSpec | None],
    faults: Faults,
) -> RobotSpec | None:
    """One robot; None if it is incomplete (the faults are noted)."""
    if not _ROBOT_NAME.fullmatch(entry.key):
        faults.add(entry.place, f'"{entry.key}" is no name for a robot', "letters, digits, _ and -")
    example = "{driver: sim2d, slam: kiss_gtsam, planner: skeleton, controller: pursuit}"
    entries = expect_entries(entry.value, f"robots.{entry.key}", example, faults) or Entries((), entry.place)
    check_keys(entries, ROBOT_KEYS, f"robot {entry.key}", faults)
    start, knows_start = _start(entries.get("start"), scope, faults)
    saved_map = _saved_map(entries.get("map"), scope, faults)
    tree = read_tree(entries.get("tree"), entry.place)
    resolved = Entries(
        tuple(Entry(e.key, e.place, resolve(e.value, scope, faults)) for e in entries if e.key in PLUGINS),
        entries.place,
    )
    choices = [_choose(kind, resolved.by_key.get(kind), entry, catalog, faults) for kind in PLUGINS]
    driver, slam, planner, controller = choices
    if driver is None or slam is None or planner is None or controller is None or tree is None:
        return None
    return RobotSpec(
        entry.key,
        start,
        saved_map,
        cast(PluginChoice[Driver], driver),
        cast(PluginChoice[Slam], slam),
        cast(PluginChoice[Planner], planner),
        cast(PluginChoice[Controller], controller),
        tree,
        knows_start,
    )


_USUAL = {"team": "local", "allocator": "auction"}


def read_team(
    root: Entries, several: bool, scope: Scope, catalog: PluginCatalog, faults: Faults
) -> TeamSpec | None:
    """The keys ``team`` and ``allocator`` of a mission; with several robots they may be left out."""
    is_asked_for = any(root.get(kind) is not None for kind in TEAM_PLUGINS)
    if not is_asked_for and not (several and all(_USUAL[kind] in catalog.names(kind) for kind in _USUAL)):
        return None
    choices = []
    for kind in TEAM_PLUGINS:
        entry = root.by_key.get(kind)
        if entry is None:
            usual = Scalar(_USUAL[kind], _USUAL[kind], True, root.place)
            entry = Entry(kind, root.place, usual)
        resolved = Entry(kind, entry.place, resolve(entry.value, scope, faults))
        choices.append(_choose(kind, resolved, entry, catalog, faults))
    team, allocator = choices
    if team is None or allocator is None:
        return None
    return TeamSpec(cast(PluginChoice[Team], team), cast(PluginChoice[Allocator], allocator))


def _given(value: Value | None, scope: Scope, faults: Faults) -> Value | None:
    """What stands there; None for nothing and for ``null``."""
    found = None if value is None else resolve(value, scope, faults)
    return None if isinstance(found, Scalar) and found.data is None else found


def _start(value: Value | None, scope: Scope, faults: Faults) -> tuple[Pose2 | None, bool]:
    """The pose if one is given, and whether it is known: ``unknown`` if nobody is to know it."""
    found = _given(value, scope, faults)
    if found is None:
        return None, True
    if isinstance(found, Scalar) and isinstance(found.data, str):
        if found.data == UNKNOWN_START:
            return None, False
        faults.add(found.place, f"start: {written(found)} is no pose", "write [1 m, 2 m, 0 deg], or unknown")
        return None, True
    adapter: TypeAdapter[tuple[float, float, float]] = TypeAdapter(PoseTriple)
    pose = check_value(lambda text: adapter.validate_json(text, strict=True), found, "start", Asked(), faults)
    return Pose2(*pose) if isinstance(pose, tuple) else None, True


def _saved_map(value: Value | None, scope: Scope, faults: Faults) -> Path | None:
    found = _given(value, scope, faults)
    if found is None:
        return None
    adapter: TypeAdapter[Path] = TypeAdapter(FilePath)
    context = {"base_dir": found.place.source.folder}
    folder = check_value(
        lambda text: adapter.validate_json(text, context=context), found, "map", Asked(), faults
    )
    if not isinstance(folder, Path):
        return None
    if not folder.is_dir():
        faults.add(
            found.place, f"map: there is no folder {folder}", "give the folder slam/ of an earlier run"
        )
    return folder


def _choose(
    kind: str, entry: Entry | None, robot: Entry, catalog: PluginCatalog, faults: Faults
) -> PluginChoice[Any] | None:
    """The plugin of one kind, with its options checked."""
    if entry is None:
        faults.add(robot.place, f"robot {robot.key} has no {kind}", f"write {kind}: {{use: NAME}}")
        return None
    value = entry.value
    use = value.get("use") if isinstance(value, Entries) else value
    if use is None:
        names = ", ".join(catalog.names(kind))
        faults.add(entry.place, f"{kind}: use is missing", f"write {kind}: {{use: NAME}}; installed: {names}")
        return None
    if not isinstance(use, Scalar) or not isinstance(use.data, str):
        if not (isinstance(use, Scalar) and use.data is BROKEN):
            faults.add(
                use.place, f"{kind}: {written(use)} is not the name of a plugin", f"write {kind}: NAME"
            )
        return None
    given = tuple(each for each in value if each.key != "use") if isinstance(value, Entries) else ()
    return _with_options(kind, use.data, use.place, Entries(given, value.place), catalog, faults)


def _with_options(
    kind: str, name: str, place: Place, given: Entries, catalog: PluginCatalog, faults: Faults
) -> PluginChoice[Any] | None:
    if name not in catalog.names(kind):
        unknown_plugin(catalog, kind, name, place, faults)
        return None
    try:
        cls = catalog.get(kind, name)
    except PluginError as error:
        faults.add(place, str(error))
        return None
    folder = place.source.folder
    options = check_model(cls.Options, given, name, "option", folder, faults, place)  # type: ignore[attr-defined]  # the catalog's kinds have it
    return None if options is None else PluginChoice(kind, name, cls, options)
