"""``sensor_msgs/PointCloud2`` with the time of each point, as the makers of lidars write it."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from explore_bt.types import PointCloud

__all__ = ["point_cloud"]

_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
_TIMES = ("t", "time", "timestamp", "time_stamp", "offset_time")
_SLOWEST_SWEEP_S = 5.0


def point_cloud(message: Any, stamp_s: float, T_base_sensor: NDArray[np.float64]) -> PointCloud:
    """The cloud, stamped with its last point.

    A field ``t``, ``time``, ``timestamp`` or ``offset_time`` holds the points' times: integers are
    nanoseconds, floats seconds, both since the header's stamp or since the clock's epoch. Without one all
    points are taken at the header's stamp.

    Raises:
        ValueError: the data do not hold the points that the header tells of.
    """
    table = _table(message)
    missing = [name for name in "xyz" if name not in (table.dtype.names or ())]
    if missing:
        raise ValueError(f"no field {', '.join(missing)}; expected x, y and z in metres")
    points = np.column_stack([table[name].astype(np.float32) for name in "xyz"])
    times_s = _times_s(table)
    last_s = float(times_s.max(initial=0.0))
    if last_s > 1e6:  # since the epoch
        stamp_s, times_s = last_s, times_s - last_s
    else:
        stamp_s, times_s = stamp_s + last_s, times_s - last_s
    return PointCloud(stamp_s, points, times_s, T_base_sensor, message.header.frame_id)


def _table(message: Any) -> NDArray[Any]:
    order = ">" if message.is_bigendian else "<"
    fields = [field for field in message.fields if field.count <= 1 and field.datatype in _TYPES]
    step, count = int(message.point_step), int(message.width) * int(message.height)
    data = np.asarray(message.data, dtype=np.uint8)
    if any(field.offset + np.dtype(_TYPES[field.datatype]).itemsize > step for field in fields):
        raise ValueError(f"a field lies beyond the point_step of {step} bytes")
    width = int(message.width) * step
    if step <= 0 or int(message.row_step) < width or len(data) < int(message.row_step) * int(message.height):
        raise ValueError(
            f"{len(data)} bytes of data for {count} points of {step} bytes in rows of {message.row_step}"
        )
    rows = data[: int(message.row_step) * int(message.height)].reshape(int(message.height), -1)[:, :width]
    layout = np.dtype(
        {
            "names": [field.name for field in fields],
            "formats": [order + _TYPES[field.datatype] for field in fields],
            "offsets": [field.offset for field in fields],
            "itemsize": step,
        }
    )
    return np.ascontiguousarray(rows).reshape(-1).view(layout)


def _times_s(table: NDArray[Any]) -> NDArray[np.float64]:
    name = next((name for name in _TIMES if name in (table.dtype.names or ())), None)
    if name is None:
        return np.zeros(len(table))
    times = table[name].astype(np.float64) * (1e-9 if table[name].dtype.kind in "iu" else 1.0)
    if len(times) and not (np.isfinite(times).all() and np.ptp(times) <= _SLOWEST_SWEEP_S):
        raise ValueError(f"the points' times (field {name}) are not those of a sweep of at most 5 s")
    return np.asarray(times)
