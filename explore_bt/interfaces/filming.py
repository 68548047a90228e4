"""Pictures of a simulated world, for people to look at."""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

__all__ = ["Filming"]


class Filming(ABC):
    """Looks at a driver's world from where a person would; called by the tick thread, while nothing moves.

    It changes nothing: a run that is filmed is the same run.
    """

    @abstractmethod
    def frame(self) -> NDArray[np.uint8]:
        """(height, width, 3) uint8 RGB, of the size that was asked for: the world as it is now."""

    @abstractmethod
    def close(self) -> None:
        """Let go of what it holds. Idempotent; the driver may be closed already."""
