"""An allocator: every place goes to the robot that is nearest to it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from explore_bt import hookimpl
from explore_bt.interfaces import API_VERSION, Allocator, Offers


class MyPlugin(Allocator):
    """Of two that are equally near, the one whose name comes first."""

    name = "my_plugin"
    api_version = API_VERSION

    def allot(self, offers: Offers) -> Sequence[int]:
        """Indices of the places to which nobody is nearer than the asker, who is robot 0."""
        by_name = np.argsort(offers.names)
        ways_m = offers.from_robots_m + offers.committed_m[:, None]
        nearest = by_name[np.argmin(ways_m[by_name], axis=0)]
        return [int(place) for place in np.flatnonzero(nearest == 0)]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """What this distribution brings."""
    return [MyPlugin]
