"""What the leaves draw in one tick, put together."""

from __future__ import annotations

from explore_bt.types import Drawing

__all__ = ["Sketch"]


class Sketch:
    """Layers drawn in one tick lie over one another; the first of a later tick begins anew."""

    def __init__(self) -> None:
        self.drawing = Drawing()
        self._is_of_this_tick = False

    def begin_tick(self) -> None:
        """From now on what is drawn is new; till something is, the old drawing stands."""
        self._is_of_this_tick = False

    def add(self, drawing: Drawing) -> None:
        """Add to what was drawn in this tick."""
        self.drawing = drawing.over(self.drawing) if self._is_of_this_tick else drawing
        self._is_of_this_tick = True
