"""The schema's own structure, and a small validator of the keywords it uses over real missions."""

from __future__ import annotations

import json
import re
from typing import Any

import pytest
import yaml

from explore_bt.mission import CONTROL_NODES, MODIFIERS, mission_schema

TYPES = {
    "object": dict,
    "array": list,
    "string": str,
    "integer": int,
    "number": (int, float),
    "boolean": bool,
    "null": type(None),
}


def fits(value: Any, schema: dict[str, Any], root: dict[str, Any]) -> bool:
    """Whether ``value`` satisfies ``schema``; only the keywords that occur are known."""
    if "$ref" in schema:
        return fits(value, root["$defs"][schema["$ref"].rsplit("/", 1)[-1]], root)
    types = schema.get("type", [])
    checks = [
        not types or any(isinstance(value, TYPES[t]) for t in ([types] if isinstance(types, str) else types)),
        "const" not in schema or value == schema["const"],
        "enum" not in schema or value in schema["enum"],
        "anyOf" not in schema or any(fits(value, each, root) for each in schema["anyOf"]),
        "oneOf" not in schema or sum(fits(value, each, root) for each in schema["oneOf"]) == 1,
    ]
    if isinstance(value, str):
        checks.append(re.search(schema.get("pattern", ""), value) is not None)
    if isinstance(value, int | float) and not isinstance(value, bool):
        checks.append(schema.get("minimum", value) <= value <= schema.get("maximum", value))
    if isinstance(value, list):
        checks.append(schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)))
        checks += [fits(each, schema.get("items", {}), root) for each in value]
    if isinstance(value, dict):
        properties, more = schema.get("properties", {}), schema.get("additionalProperties", True)
        checks.append(all(key in value for key in schema.get("required", ())))
        for key, each in value.items():
            known = properties.get(key, more)
            checks.append(known if isinstance(known, bool) else fits(each, known, root))
    return all(checks)


@pytest.fixture(scope="module")
def schema(catalog) -> dict[str, Any]:
    return mission_schema(catalog)


def test_the_schema_is_plain_json_and_names_its_draft(schema) -> None:
    assert json.loads(json.dumps(schema)) == schema
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_every_reference_leads_somewhere(schema) -> None:
    references = set(re.findall(r'"\$ref": "([^"]+)"', json.dumps(schema)))
    assert references
    assert all(reference.removeprefix("#/$defs/") in schema["$defs"] for reference in references)


def test_every_type_modifier_and_port_is_described(schema) -> None:
    node = schema["$defs"]["node"]["anyOf"][1]["properties"]
    assert set(node) == {*CONTROL_NODES, *MODIFIERS, "look", "drive", "home", "reset"}
    assert all(each["description"] for each in node.values())
    stride = node["look"]["properties"]["stride"]
    assert stride["description"] == "distance to the next waypoint (default 1.5 m)"
    assert node["drive"]["required"] == ["goal"]


def test_options_of_plugins_come_with_descriptions_and_units(schema) -> None:
    robot = schema["properties"]["robots"]["additionalProperties"]
    sim = robot["properties"]["driver"]["anyOf"][2]
    assert sim["required"] == ["use", "world"]
    assert sim["properties"]["radius"]["description"] == "of the footprint"
    assert '"x-dimension": "length"' in json.dumps(sim["properties"]["radius"])


def test_the_good_mission_fits(schema, good) -> None:
    assert fits(yaml.safe_load(good), schema, schema)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("format: explore-bt/1", "format: explore-bt/2"),
        ("name: flat", "nmae: flat"),
        ("type: length", "type: lenght"),
        ("{use: sim,", "{use: smi,"),
        ("{use: sim,", "{use: sim, radios: 3,"),
        ("{use: sim, world: $params.world}", "{use: sim}"),
        ("    planner: {use: lines}\n", ""),
        ("speed: 0.5 m/s", "speed: 0.5 kg"),
        ("speed: 0.5 m/s", "sped: 0.5 m/s"),
        ("stride: $params", "strid: $params"),
        ("stride: $params.stride", "stride: 3 kg"),
        ("half_planes: all", "half_planes: some"),
        ("- look:", "- lok:"),
        ("retry: 2", "retry: 0"),
        ("retry: 2", "reset: {}"),
        ("timeout: 60 s", "timeout: 60 m"),
        ("timeout: 60 s", "timout: 60 s"),
        ("{drive: {goal: $goal}}]", "{drive: {}}]"),
        ("{drive: {goal: $goal}}]", "{drive: {goal: goal}}]"),
        ("[home,", "[hom,"),
        ("sequence: [home, {drive: {goal: $goal}}]", "sequence: []"),
    ],
)
def test_a_broken_mission_does_not_fit(schema, good, old, new) -> None:
    assert old in good
    assert not fits(yaml.safe_load(good.replace(old, new, 1)), schema, schema)
