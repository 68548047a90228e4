"""JSON Schema of mission files, made from the installed plugins and leaves, for editors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter

from explore_bt.mission.bounds import dimension_of
from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.files import FORMAT
from explore_bt.mission.limits import LimitsModel, TickModel
from explore_bt.mission.nodes import CONTROL_NODES, MODIFIERS
from explore_bt.mission.params import PARAM_TYPES, PLUGIN_KINDS
from explore_bt.mission.robots import PLUGINS, TEAM_PLUGINS, UNKNOWN_START
from explore_bt.mission.words import quantity
from explore_bt.tree import REQUIRED, Input, Key, Leaf, Output
from explore_bt.units import Duration, PoseTriple

__all__ = ["mission_schema"]

Schema = dict[str, Any]
_CONSTANT: Schema = {"type": "string", "pattern": r"^\$(params|env|robot)\.\S+$"}
_ENTRY: Schema = {"type": "string", "pattern": r"^\$[A-Za-z_][A-Za-z0-9_]*$"}
_NODE: Schema = {"$ref": "#/$defs/node"}
_NODES: Schema = {"type": "array", "minItems": 1, "items": _NODE}


def mission_schema(catalog: PluginCatalog) -> Schema:
    """JSON Schema 2020-12 of a mission, for yaml-language-server and others."""
    robot = {
        "start": _or_constant(
            {
                "anyOf": [
                    TypeAdapter(PoseTriple).json_schema(),
                    {"const": UNKNOWN_START, "description": "found out by meeting places of team mates"},
                    {"type": "null"},
                ]
            }
        ),
        "map": {"type": ["string", "null"], "description": "folder slam/ of an earlier run, to go on in"},
        **{kind: _plugins(catalog, kind) for kind in PLUGINS},
        "tree": {"anyOf": [{"type": "string"}, _NODE], "description": "a name in trees, or a node"},
        "doc": {"type": "string"},
    }
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "explore-bt mission",
        **_mapping(
            {
                "format": {"const": FORMAT},
                "name": {"type": "string", "description": "the mission's name; the file's by default"},
                "doc": {"type": "string"},
                "params": {"type": "object", "additionalProperties": {"$ref": "#/$defs/param"}},
                "include": {"type": "array", "items": {"type": "string"}},
                **{kind: _plugins(catalog, kind) for kind in TEAM_PLUGINS},
                "plugins": {"type": "array", "items": {"type": "string", "pattern": "^[a-z]+/.+$"}},
                "robots": {
                    "type": "object",
                    "minProperties": 1,
                    "additionalProperties": {**_mapping(robot), "required": list(PLUGINS)},
                },
                "tick": _section(TickModel),
                "limits": _section(LimitsModel),
                "tree": {"anyOf": [{"type": "string"}, _NODE], "description": "a name in trees, or a node"},
                "trees": {"type": "object", "additionalProperties": _NODE},
            }
        ),
        "required": ["format"],
        "$defs": {"param": _param(), "node": _node(catalog)},
    }


def _mapping(properties: Mapping[str, Schema]) -> Schema:
    return {"type": "object", "properties": dict(properties), "additionalProperties": False}


def _or_constant(schema: Schema) -> Schema:
    """``schema``, or ``$params.x`` and its like in its place."""
    kept: Schema = {key: schema[key] for key in ("description", "default") if key in schema}
    inner = {key: value for key, value in schema.items() if key not in kept}
    return {"anyOf": [inner, _CONSTANT], **kept}


def _section(model: type[LimitsModel] | type[TickModel]) -> Schema:
    return _mapping(_options(model.model_json_schema())[0])


def _options(schema: Schema) -> tuple[dict[str, Schema], list[str]]:
    """Properties of a model's schema, each open to constants; and which are required."""
    inlined = _inline(schema, schema.get("$defs", {}))
    properties = {name: _or_constant(each) for name, each in inlined.get("properties", {}).items()}
    return properties, list(inlined.get("required", ()))


def _inline(schema: Any, definitions: Mapping[str, Any], depth: int = 0) -> Any:
    """References written out (options do not recurse; past eight levels anything goes)."""
    if isinstance(schema, list):
        return [_inline(each, definitions, depth) for each in schema]
    if not isinstance(schema, dict):
        return schema
    if "$ref" in schema:
        name = str(schema["$ref"]).rsplit("/", 1)[-1]
        rest = {key: value for key, value in schema.items() if key != "$ref"}
        return {**_inline(definitions.get(name, {}), definitions, depth + 1), **rest} if depth < 8 else rest
    return {key: _inline(each, definitions, depth) for key, each in schema.items() if key != "$defs"}


def _plugins(catalog: PluginCatalog, kind: str) -> Schema:
    names = list(catalog.names(kind))
    shapes: list[Schema] = [*([{"enum": names}] if names else []), _CONSTANT]  # an empty enum is no schema
    for name in names:
        cls: Any = catalog.get(kind, name)
        properties, required = _options(cls.Options.model_json_schema())
        shape = _mapping({"use": {"const": name}, **properties})
        shapes.append({**shape, "required": ["use", *required], "description": _first_line(cls)})
    shapes.append({"type": "object", "properties": {"use": _CONSTANT}, "required": ["use"]})
    return {"description": f"the {kind} to use, with its options", "anyOf": shapes}


def _first_line(cls: type) -> str:
    lines = (cls.__doc__ or "").strip().splitlines()
    return lines[0] if lines else ""


def _param() -> Schema:
    return {
        **_mapping(
            {
                "type": {"enum": list(PARAM_TYPES)},
                "default": {"description": "null: not given; without it every run has to say --set"},
                "min": {"type": ["number", "string"]},
                "max": {"type": ["number", "string"]},
                "choices": {"type": "array", "minItems": 1},
                "kind": {"enum": list(PLUGIN_KINDS)},
                "doc": {"type": "string"},
            }
        ),
        "required": ["type"],
    }


def _node(catalog: PluginCatalog) -> Schema:
    names = catalog.names("behaviour")
    leaves = {name: _leaf(catalog.get("behaviour", name)) for name in names}
    types = {**_control(), **leaves}
    return {
        "anyOf": [
            {"enum": list(names), "description": "a leaf without ports"},
            {
                **_mapping({**_modifiers(), **types}),
                "oneOf": [{"required": [key]} for key in types],
            },
        ]
    }


def _control() -> dict[str, Schema]:
    count: Schema = {"type": "integer", "minimum": 1}
    parallel: dict[str, Schema] = {
        "success": {"anyOf": [{"const": "all"}, count, _CONSTANT], "default": "all"},
        "failure": {"anyOf": [count, _CONSTANT], "default": 1},
        "children": _NODES,
    }
    repeat: dict[str, Schema] = {"times": {"anyOf": [{"const": "forever"}, count, _CONSTANT]}, "child": _NODE}
    special: dict[str, Schema] = {
        "parallel": {"anyOf": [_NODES, {**_mapping(parallel), "required": ["children"]}]},
        "repeat": {**_mapping(repeat), "required": ["times", "child"]},
        "subtree": {"type": "string"},
        **dict.fromkeys(("invert", "force_success", "force_failure"), _NODE),
    }
    return {key: {**special.get(key, _NODES), "description": doc} for key, doc in CONTROL_NODES.items()}


def _modifiers() -> dict[str, Schema]:
    condition: Schema = {"type": "string", "pattern": r"^(not )?\$[A-Za-z_][A-Za-z0-9_]*$"}
    shapes: dict[str, Schema] = {
        "name": {"type": "string"},
        "doc": {"type": "string"},
        "timeout": {"anyOf": [TypeAdapter(Duration).json_schema(), _CONSTANT]},
        "retry": {"anyOf": [{"type": "integer", "minimum": 1}, _CONSTANT]},
        "on_failure": _NODE,
        "if": {"anyOf": [condition, _NODE]},
    }
    return {key: {**shapes[key], "description": doc} for key, doc in MODIFIERS.items()}


def _leaf(cls: type) -> Schema:
    assert issubclass(cls, Leaf)  # the catalog's contract for this kind
    declared: dict[str, Input[Any] | Output[Any]] = {**cls.inputs, **cls.outputs}
    ports = {name: _port(port) for name, port in declared.items()}
    required = [name for name, port in cls.inputs.items() if port.default is REQUIRED]
    shape = _mapping(ports) | ({"required": required} if required else {})
    types = shape if required else {**shape, "type": ["object", "null"]}
    return {**types, "description": _first_line(cls)}


def _port(port: Input[Any] | Output[Any]) -> Schema:
    described = f"{port.doc} (default {_default(port)})" if port.default is not REQUIRED else port.doc
    if isinstance(port, Output) or not port.takes_constants:
        return {**_ENTRY, "description": described}
    constant = port.adapter.json_schema()
    inlined = _inline(constant, constant.get("$defs", {}))
    return {"anyOf": [inlined, _ENTRY, _CONSTANT], "description": described}


def _default(port: Input[Any] | Output[Any]) -> str:
    if isinstance(port.default, Key):
        return f"${port.default.name}"
    return quantity(port.default, dimension_of(port.type))
