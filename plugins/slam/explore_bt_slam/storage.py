"""Arrays in one file, whole or not there at all; keyframes, edges and sweeps as arrays."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import UserError
from explore_bt.files import write_whole
from explore_bt.types import Pose2
from explore_bt_slam.keyframes import Keyframe
from explore_bt_slam.mapper import KeptSweep
from explore_bt_slam.pose_graph import Edge
from explore_bt_slam.segments import read_segments
from explore_bt_slam.surfels import normals_of
from explore_bt_slam.sweep import Sweep

__all__ = [
    "SEGMENTED",
    "Arrays",
    "pack_edges",
    "pack_keyframes",
    "pack_sweeps",
    "read_arrays",
    "unpack_edges",
    "unpack_keyframes",
    "unpack_sweeps",
    "write_arrays",
]

Arrays = dict[str, NDArray[Any]]

SEGMENTED = ("keyframes", "sweeps")
_FILE_NAME = "slam.npz"
_FORMAT = "explore-bt-slam/1"


def write_arrays(
    folder: Path, plugin: str, resolution_m: float, arrays: Mapping[str, NDArray[Any]], *, packed: bool = True
) -> None:
    """Write ``slam.npz`` into ``folder``, which is made if need be; ``packed`` takes longer and less room."""
    meta = json.dumps({"format": _FORMAT, "plugin": plugin, "resolution_m": resolution_m})
    buffer = io.BytesIO()
    everything: dict[str, Any] = {"meta": np.array(meta), **arrays}
    (np.savez_compressed if packed else np.savez)(buffer, **everything)
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / _FILE_NAME, buffer.getvalue())


def read_arrays(folder: Path, plugin: str, resolution_m: float) -> Arrays:
    """The arrays that ``write_arrays`` wrote, and those that ``write_segments`` wrote beside them.

    Raises:
        UserError: no such file, a damaged one, another plugin's, or another resolution.
    """
    path = folder / _FILE_NAME
    if not path.is_file():
        raise UserError(f"{folder} holds no saved map ({_FILE_NAME} is missing); save a run there first")
    try:
        with np.load(io.BytesIO(path.read_bytes()), allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        for name in SEGMENTED:
            arrays |= read_segments(folder, name)
        meta = json.loads(str(arrays.pop("meta")))
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as fault:
        raise UserError(f"{path} is damaged ({fault}); save the map again") from fault
    wanted = {"format": _FORMAT, "plugin": plugin, "resolution_m": resolution_m}
    for key, value in wanted.items():
        if meta.get(key) != value:
            raise UserError(f"{path} has {key} {meta.get(key)}, expected {value}; load it with what saved it")
    return arrays


def pack_keyframes(keyframes: Sequence[Keyframe]) -> Arrays:
    """Stamps, ways and points; normals are made again from the points."""
    return {
        "keyframe_stamps": np.array([keyframe.stamp_s for keyframe in keyframes]),
        "keyframe_driven": np.array([keyframe.driven_m for keyframe in keyframes]),
        "keyframe_counts": np.array([keyframe.points.shape[0] for keyframe in keyframes], dtype=np.int64),
        "keyframe_points": _joined([keyframe.points for keyframe in keyframes], np.float32),
    }


def unpack_keyframes(arrays: Arrays) -> list[Keyframe]:
    """Inverse of ``pack_keyframes``."""
    clouds = _parted(arrays["keyframe_points"].astype(np.float64), arrays["keyframe_counts"])
    return [
        Keyframe(float(stamp_s), points, normals_of(points), float(driven_m))
        for stamp_s, driven_m, points in zip(
            arrays["keyframe_stamps"], arrays["keyframe_driven"], clouds, strict=True
        )
    ]


def pack_edges(edges: Sequence[Edge]) -> Arrays:
    """The graph's constraints."""
    return {
        "edge_ends": np.array([(edge.a, edge.b) for edge in edges], dtype=np.int64).reshape(-1, 2),
        "edge_relatives": _triples([edge.relative for edge in edges]),
        "edge_covariances": np.array([edge.covariance for edge in edges]).reshape(-1, 3, 3),
        "edge_closures": np.array([edge.is_closure for edge in edges], dtype=np.bool_),
    }


def unpack_edges(arrays: Arrays) -> list[Edge]:
    """Inverse of ``pack_edges``."""
    rows = zip(
        arrays["edge_ends"].tolist(),
        arrays["edge_relatives"].tolist(),
        arrays["edge_covariances"],
        arrays["edge_closures"].tolist(),
        strict=True,
    )
    return [
        Edge(a, b, Pose2(x, y, yaw), covariance, is_closure)
        for (a, b), (x, y, yaw), covariance, is_closure in rows
    ]


def pack_sweeps(kept: Sequence[KeptSweep]) -> Arrays:
    """The sweeps that the map is redrawn from."""
    return {
        "sweep_keyframes": np.array([each.keyframe for each in kept], dtype=np.int64),
        "sweep_relatives": _triples([each.relative for each in kept]),
        "sweep_stamps": np.array([each.sweep.stamp_s for each in kept]),
        "sweep_counts": np.array([each.sweep.hit.shape[0] for each in kept], dtype=np.int64),
        "sweep_origins": _joined([each.sweep.origins for each in kept], np.float32),
        "sweep_ends": _joined([each.sweep.ends for each in kept], np.float32),
        "sweep_hits": np.concatenate([np.zeros(0, np.bool_), *(each.sweep.hit for each in kept)]),
    }


def unpack_sweeps(arrays: Arrays) -> list[KeptSweep]:
    """Inverse of ``pack_sweeps``."""
    counts = arrays["sweep_counts"]
    rows = zip(
        arrays["sweep_keyframes"].tolist(),
        arrays["sweep_relatives"].tolist(),
        arrays["sweep_stamps"].tolist(),
        _parted(arrays["sweep_origins"], counts),
        _parted(arrays["sweep_ends"], counts),
        _parted(arrays["sweep_hits"], counts),
        strict=True,
    )
    return [
        KeptSweep(keyframe, Pose2(x, y, yaw), Sweep(stamp_s, origins, ends, hit))
        for keyframe, (x, y, yaw), stamp_s, origins, ends, hit in rows
    ]


def _triples(poses: Sequence[Pose2]) -> NDArray[np.float64]:
    return np.array([(pose.x, pose.y, pose.yaw_rad) for pose in poses], dtype=np.float64).reshape(-1, 3)


def _joined(parts: Sequence[NDArray[Any]], dtype: type) -> NDArray[Any]:
    return np.concatenate([np.zeros((0, 2)), *parts]).astype(dtype)


def _parted(array: NDArray[Any], counts: NDArray[np.int64]) -> list[NDArray[Any]]:
    return (
        [np.ascontiguousarray(part) for part in np.split(array, np.cumsum(counts)[:-1])]
        if counts.size
        else []
    )
