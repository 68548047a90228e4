"""What moves around the robot, as a message."""

from __future__ import annotations

from collections.abc import Iterable

from explore_bt.recording.foxglove import time_json
from explore_bt.types import MovingObstacle

__all__ = ["moving_message"]


def moving_message(time_ns: int, moving: Iterable[MovingObstacle]) -> str:
    """``explore_bt.Moving``: metres and metres a second to the centimetre."""
    things = ",".join(map(_thing, moving))
    return f'{{"timestamp":{time_json(time_ns)},"things":[{things}]}}'


def _thing(thing: MovingObstacle) -> str:
    (x, y), (vx, vy) = thing.xy, thing.velocity_mps
    return (
        f'{{"number":{thing.number},"x":{x:.2f},"y":{y:.2f},"vx_mps":{vx:.2f},"vy_mps":{vy:.2f},'
        f'"radius_m":{thing.radius_m:.2f},"seen_s":{thing.stamp_s:.2f}}}'
    )
