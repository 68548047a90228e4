"""Commands as set-points of a body's two axes, for simulated bodies."""

from explore_bt_drivers.orders.axis import Ramp, driven
from explore_bt_drivers.orders.orders import Order, Orders

__all__ = ["Order", "Orders", "Ramp", "driven"]
