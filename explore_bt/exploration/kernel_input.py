"""Arrays in the one form the kernels are compiled for."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

__all__ = ["read_only"]

_Scalar = TypeVar("_Scalar", bound=np.generic)


def read_only(values: NDArray[_Scalar]) -> NDArray[_Scalar]:
    """The same values, contiguous and read-only; copied only where they are not contiguous.

    numba compiles a kernel anew for every memory layout and for arrays that may be written; seconds that
    nobody has while driving.
    """
    view = np.ascontiguousarray(values).view()
    view.flags.writeable = False
    return view
