"""What the leaves draw in one tick, put together."""

from __future__ import annotations

from explore_bt.types import Drawing

__all__ = ["Sketch"]


class Sketch:
    """Layers drawn at one time lie over one another; the first of a later time begins anew."""

    def __init__(self) -> None:
        self.drawing = Drawing()
        self._at_s: float | None = None

    def add(self, drawing: Drawing, now_s: float) -> None:
        """Add to what was drawn at this time."""
        self.drawing = drawing.over(self.drawing) if now_s == self._at_s else drawing
        self._at_s = now_s
