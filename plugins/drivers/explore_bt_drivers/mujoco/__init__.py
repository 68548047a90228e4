"""The physical simulator: a balancing robot in MuJoCo; a plugin of its own, for it needs an extra."""

from __future__ import annotations

from collections.abc import Sequence

from explore_bt import hookimpl
from explore_bt.plugin import require

require("mujoco", "mujoco")

from explore_bt_drivers.mujoco.driver import Mujoco  # noqa: E402  # not without its library
from explore_bt_drivers.mujoco.options import MujocoOptions  # noqa: E402

__all__ = ["Mujoco", "MujocoOptions", "explore_bt_register"]


@hookimpl
def explore_bt_register() -> Sequence[type]:
    """The driver of this package."""
    return [Mujoco]
