"""JSON Schemas of the topics: Foxglove's well-known ones, and our own.

Foxglove knows the first group by name; the members listed here are those of its published schemas.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

__all__ = ["is_known", "schema_text"]

_Schema = Mapping[str, Any]


def _object(**properties: _Schema) -> dict[str, Any]:
    return {"type": "object", "properties": properties}


def _array(items: _Schema) -> dict[str, Any]:
    return {"type": "array", "items": items}


_NUMBER: _Schema = {"type": "number"}
_MAYBE: _Schema = {"type": ["number", "null"]}
_INTEGER: _Schema = {"type": "integer"}
_TEXT: _Schema = {"type": "string"}
_FLAG: _Schema = {"type": "boolean"}
_ANY: _Schema = {"type": "object"}
_TIME = {"title": "time", **_object(sec=_INTEGER, nsec=_INTEGER)}
_POSE = _object(
    position=_object(x=_NUMBER, y=_NUMBER, z=_NUMBER),
    orientation=_object(x=_NUMBER, y=_NUMBER, z=_NUMBER, w=_NUMBER),
)
_BYTES: _Schema = {"type": "string", "contentEncoding": "base64"}
_SERIES: _Schema = {"anyOf": [_BYTES, _array(_NUMBER)]}
_LIDAR = _object(
    frame=_TEXT,
    mounting=_array(_NUMBER),
    range_min=_MAYBE,
    range_max=_MAYBE,
    angles=_SERIES,
    times=_SERIES,
)
_CLOUD = _object(
    stamp=_NUMBER,
    frame=_TEXT,
    mounting=_array(_NUMBER),
    range_max=_MAYBE,
    point_step_m=_NUMBER,
    points=_BYTES,
    times=_BYTES,
)
_VERDICT: _Schema = {"type": "string", "enum": ["taken", "rejected", "open"]}
_LAYERS = _object(
    sectors=_array(
        _object(
            x=_NUMBER,
            y=_NUMBER,
            from_rad=_NUMBER,
            to_rad=_NUMBER,
            range_m=_NUMBER,
            state=_VERDICT,
            reason=_TEXT,
        )
    ),
    half_planes=_array(_object(x=_NUMBER, y=_NUMBER, normal_x=_NUMBER, normal_y=_NUMBER)),
    frontiers=_array(_object(x=_NUMBER, y=_NUMBER, size_m=_NUMBER, state=_VERDICT, reason=_TEXT)),
    views=_array(
        _object(x=_NUMBER, y=_NUMBER, yaw_rad=_NUMBER, gain_m2=_NUMBER, state=_VERDICT, reason=_TEXT)
    ),
)
_THING = _object(
    number=_INTEGER,
    x=_NUMBER,
    y=_NUMBER,
    vx_mps=_NUMBER,
    vy_mps=_NUMBER,
    radius_m=_NUMBER,
    seen_s=_NUMBER,
)
_TALLY = _object(
    id=_INTEGER,
    ticks=_INTEGER,
    successes=_INTEGER,
    failures=_INTEGER,
    cut_off=_INTEGER,
    running_s=_NUMBER,
    longest_s=_NUMBER,
)
_MATE = _object(
    name=_TEXT,
    T_ours_theirs={"anyOf": [_object(x=_NUMBER, y=_NUMBER, yaw=_NUMBER), {"type": "null"}]},
    not_merged=_TEXT,
)
_NODE_STATE = _object(id=_INTEGER, status=_TEXT, message=_TEXT)
_NODE = _object(
    id=_INTEGER,
    path=_TEXT,
    name=_TEXT,
    type=_TEXT,
    parent={"type": ["integer", "null"]},
    place=_TEXT,
    ports=_array(_object(name=_TEXT, bound=_TEXT, is_output=_FLAG)),
    is_mocked=_FLAG,
)

_SCHEMAS: Mapping[str, _Schema] = {
    "foxglove.PoseInFrame": _object(timestamp=_TIME, frame_id=_TEXT, pose=_POSE),
    "foxglove.PosesInFrame": _object(timestamp=_TIME, frame_id=_TEXT, poses=_array(_POSE)),
    "foxglove.LaserScan": _object(
        timestamp=_TIME,
        frame_id=_TEXT,
        pose=_POSE,
        start_angle=_NUMBER,
        end_angle=_NUMBER,
        ranges=_array(_NUMBER),
        intensities=_array(_NUMBER),
        range_min=_NUMBER,
        range_max=_NUMBER,
        sweep_s=_NUMBER,
    ),
    "foxglove.Grid": _object(
        timestamp=_TIME,
        frame_id=_TEXT,
        pose=_POSE,
        column_count=_INTEGER,
        cell_size=_object(x=_NUMBER, y=_NUMBER),
        row_stride=_INTEGER,
        cell_stride=_INTEGER,
        fields=_array(_object(name=_TEXT, offset=_INTEGER, type=_INTEGER)),
        data=_BYTES,
    ),
    "foxglove.Log": _object(
        timestamp=_TIME, level=_INTEGER, message=_TEXT, name=_TEXT, file=_TEXT, line=_INTEGER
    ),
    "explore_bt.Run": _object(
        mission=_TEXT,
        mission_text=_TEXT,
        mission_sha256=_TEXT,
        seed=_INTEGER,
        version=_TEXT,
        footprint_radius_m=_ANY,
        sources={"type": "object", "additionalProperties": _TEXT},
        trees={"type": "object", "additionalProperties": _array(_NODE)},
    ),
    "explore_bt.Tree": _object(timestamp=_TIME, tick=_INTEGER, key_frame=_FLAG, nodes=_array(_NODE_STATE)),
    "explore_bt.NodeTallies": _object(timestamp=_TIME, nodes=_array(_TALLY)),
    "explore_bt.Blackboard": _object(timestamp=_TIME, key_frame=_FLAG, set=_ANY, removed=_array(_TEXT)),
    "explore_bt.Gate": _object(timestamp=_TIME, braking=_FLAG, reason=_TEXT, held_by=_TEXT),
    "explore_bt.Moving": _object(timestamp=_TIME, things=_array(_THING)),
    "explore_bt.Drawing": _object(timestamp=_TIME, layers=_LAYERS, left_out=_ANY),
    "explore_bt.State": _object(
        timestamp=_TIME,
        speed_mps=_NUMBER,
        turn_rate_rps=_NUMBER,
        health=_TEXT,
        health_reason=_TEXT,
        held_by=_TEXT,
        moving=_INTEGER,
        charge=_MAYBE,
        left=_ANY,
        distance_m=_NUMBER,
        coverage=_MAYBE,
        contacts=_MAYBE,
        touched_by_people=_MAYBE,
        clearance_m=_MAYBE,
        min_clearance_m=_MAYBE,
        mean_clearance_m=_MAYBE,
        ate_rmse_m=_MAYBE,
        distance_to_home_m=_NUMBER,
    ),
    "explore_bt.Team": _object(
        timestamp=_TIME, doing=_TEXT, claims=_array(_array(_NUMBER)), mates=_array(_MATE)
    ),
    "explore_bt.Measurements": _object(
        timestamp=_TIME,
        order=_TEXT,
        imu_stamps=_BYTES,
        imu=_BYTES,
        odometry=_BYTES,
        lidars=_array(_LIDAR),
        scan_lidars=_array(_INTEGER),
        scan_stamps=_BYTES,
        range_step_m=_NUMBER,
        ranges=_BYTES,
        clouds=_array(_CLOUD),
    ),
    "explore_bt.Result": _ANY,
}


def is_known(name: str) -> bool:
    """Whether there is a schema of that name."""
    return name in _SCHEMAS


def schema_text(name: str) -> bytes:
    """The JSON Schema of that name."""
    return json.dumps({"title": name, **_SCHEMAS[name]}, separators=(",", ":")).encode()
