"""Time of a replay: never goes back, even where the log's stamps do."""

from __future__ import annotations

import math

__all__ = ["ReplayTime"]

_STEP_S = 0.001
_RESET_S = 2.0


class ReplayTime:
    """Turns a log's stamps, in file order, into mission time.

    Mission time is the log's time since its first measurement, except where that would go back: a log is the
    order in which things happened, its stamps are often the times at which a busy computer noticed them. A
    stamp that goes back is held at the newest one; two measurements of the same kind keep 1 ms between them.
    (In the Intel log, 631 of 13,631 scans are stamped up to 0.9 s before their predecessor; sorted by stamp
    the odometry's path zigzags.) No time is invented beyond that: uneven stamps stay uneven.

    A stamp more than 2 s before the newest is a clock that was set back: time goes on from there.
    """

    def __init__(self) -> None:
        self._zero_s = math.nan
        self._now_s = 0.0
        self._newest: dict[object, float] = {}

    def of(self, stamp_s: float, kind: object) -> float:
        """Mission time of the next measurement, seconds from 0; ``kind`` is what it must differ from."""
        if math.isnan(self._zero_s):
            self._zero_s = stamp_s
        if stamp_s - self._zero_s < self._now_s - _RESET_S:
            self._zero_s = stamp_s - self._now_s
        earliest = max(self._now_s, self._newest.get(kind, -math.inf) + _STEP_S)
        self._now_s = self._newest[kind] = max(stamp_s - self._zero_s, earliest)
        return self._now_s
