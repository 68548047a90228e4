"""Contract of bridges: simulated robots, as others would meet real ones."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping

from explore_bt.interfaces.driver import Driver
from explore_bt.interfaces.plugin import Plugin

__all__ = ["Bridge"]


class Bridge(Plugin):
    """Puts the robots of simulating drivers behind a middleware, in a process of its own.

    Life: ``serve`` once, in the main thread.
    """

    kind = "bridge"

    @abstractmethod
    def serve(self, robots: Mapping[str, Driver], speed: float, is_over: Callable[[], bool]) -> None:
        """Show what the drivers measure, pass on what they are told to do, until it is over.

        Args:
            robots: by name; set up, with simulated clocks, which are waited on here.
            speed: seconds of their clocks per second of real time.
            is_over: asked at every step.

        Raises:
            PluginError: the middleware cannot be had.
        """
