"""The planar simulator."""

from explore_bt_drivers.sim2d.driver import Sim2d
from explore_bt_drivers.sim2d.options import Sim2dOptions

__all__ = ["Sim2d", "Sim2dOptions"]
