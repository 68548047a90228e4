"""What an editor shows while a mission is written: yaml-language-server with our schema, beside our check.

The server is a program of Node.js; ``YAML_LANGUAGE_SERVER`` names it. ``.ci/run`` installs the version that
``yaml_language_server/package.json`` pins.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path

import pytest

from explore_bt.mission import mission_schema
from explore_bt.plugin import Registry
from tests.mission.language_client import LanguageClient
from tests.mission.test_broken_missions import broken_missions

SERVER = os.environ.get("YAML_LANGUAGE_SERVER") or shutil.which("yaml-language-server")

UNKNOWN_TO_A_SCHEMA = {
    "what a name stands for elsewhere in the mission, in other files, or on this machine": [
        "includes: include outside",
        "includes: include absolute",
        "includes: include missing",
        "includes: include itself",
        "params: plugin param not installed",
        "params: unknown parameter",
        "params: unknown environment",
        "params: unknown robot constant",
        "trees: no tree",
        "trees: unknown tree",
        "trees: unknown subtree",
        "trees: tree cycle",
    ],
    "which entries leaves write and read": [
        "robots: option from blackboard",
        "trees: if unwritten",
        "wiring_and_control: unwritten entry",
        "wiring_and_control: type mismatch",
        "wiring_and_control: dimension mismatch read",
    ],
    "bounds of a text such as 30 m, or of a number that may also be $entry": [
        "robots: option out of bounds",
        "robots: option out of bounds with unit",
        "robots: option of a pair",
        "robots: zero limit",
        "trees: port out of bounds",
        "trees: timeout negative",
    ],
    "one value against another": [
        "params: param default out of bounds",
        "params: param with wrong unit",
        "params: param without value",
        "params: param min wrong unit",
        "params: min of a text",
        "params: choice without choices",
        "params: not a choice",
        "params: plugin param without kind",
        "params: pose of two",
        "params: pose with wrong unit",
        "robots: control no multiple",
        "wiring_and_control: parallel more than children",
    ],
    "what a mission asks beyond a schema: ports of a leaf written bare, characters in names": [
        "trees: missing port",
        "trees: name with slash",
        "yaml: bad mission name",
    ],
    "the place: it is told, but at the whole node or mapping": [
        "robots: no robots",
        "trees: two types",
    ],
    "YAML that others may use and missions may not": [
        "yaml: core tag",
        "yaml: merge key",
        "yaml: unknown alias",
        "yaml: second document",
    ],
    "where to stop: after a fault of syntax the server complains of the lines below too": [
        "yaml: tab",
        "yaml: open bracket",
        "yaml: flow ${}",
    ],
}


@pytest.mark.skipif(
    not SERVER, reason="yaml-language-server is not installed (npm install yaml-language-server)"
)
def test_an_editor_marks_the_lines_that_check_marks(catalog: Registry, good: str, tmp_path: Path) -> None:
    schema = tmp_path / "schema.json"
    schema.write_text(json.dumps(mission_schema(catalog)))
    cases = {tmp_path / f"{index}.yaml": case for index, case in enumerate(broken_missions())}
    texts = {path: good.replace(case.old, case.new, 1) for path, case in cases.items()}
    client = LanguageClient([str(SERVER)], schema)
    try:
        said = client.complaints({tmp_path / "good.yaml": good, **texts})
    finally:
        client.close()
    assert said.pop(tmp_path / "good.yaml") == []
    excused = {title for titles in UNKNOWN_TO_A_SCHEMA.values() for title in titles}
    differing = {}
    for path, case in cases.items():
        ours = {int(line) for line in re.findall(r"^m\.yaml:(\d+):", case.message, re.MULTILINE)}
        theirs = {line for line, _ in said[path]}
        if theirs != ours:
            differing[case.title] = f"ours {sorted(ours)}, theirs {said[path]}"
    assert differing.keys() == excused, {title: differing.get(title) for title in differing.keys() ^ excused}
    assert len(cases) - len(excused) > 60
