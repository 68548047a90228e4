"""Contract of bridges: a simulated robot, as others would meet a real one."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable

from explore_bt.interfaces.driver import Driver
from explore_bt.interfaces.plugin import Plugin

__all__ = ["Bridge"]


class Bridge(Plugin):
    """Puts a driver's robot behind a middleware, in a process of its own.

    Life: ``serve`` once, in the main thread.
    """

    kind = "bridge"

    @abstractmethod
    def serve(self, driver: Driver, speed: float, is_over: Callable[[], bool]) -> None:
        """Show what the driver measures, pass on what it is told to do, until it is over.

        Args:
            driver: set up, with a simulated clock, which is waited on here.
            speed: seconds of its clock per second of real time.
            is_over: asked at every step.

        Raises:
            PluginError: the middleware cannot be had.
        """
