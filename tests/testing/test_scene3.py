from __future__ import annotations

import numpy as np
from matplotlib.path import Path as Polygon

from explore_bt.testing.scene3 import Prism, Scene3

PRISMS = [
    Prism(np.array([(1.0, -1.0), (1.6, -1.0), (1.6, 0.5), (1.0, 0.5)]), 0.0, 0.8),
    Prism(np.array([(-2.0, -0.5), (-1.0, -0.8), (-1.2, 0.6)]), 0.6, 0.9),
    Prism(np.array([(-0.5, 1.0), (0.8, 1.2), (0.2, 2.0), (-0.4, 1.7)]), 0.0, 2.0),
]


def test_ranges_are_those_of_a_walk_along_the_ray() -> None:
    rng = np.random.default_rng(4)
    directions = rng.normal(size=(150, 3)) * [1.0, 1.0, 0.4]
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    origins = np.array([0.0, 0.0, 0.5]) + rng.uniform(-0.1, 0.1, (150, 3))
    ranges = Scene3(PRISMS).cast(origins, directions, 4.0)
    outlines = [Polygon(prism.corners) for prism in PRISMS]
    steps = np.arange(0.0, 4.0, 0.002)
    for origin, direction, found in zip(origins, directions, ranges, strict=True):
        walk = origin + steps[:, None] * direction
        solid = walk[:, 2] <= 0.0
        for prism, outline in zip(PRISMS, outlines, strict=True):
            inside = outline.contains_points(walk[:, :2])
            solid |= inside & (walk[:, 2] >= prism.low_m) & (walk[:, 2] <= prism.high_m)
        if solid.any():
            assert abs(found - steps[np.argmax(solid)]) < 0.02 or _grazes(solid)
        else:
            assert np.isinf(found) or found > 3.99 or _grazes(solid)


def _grazes(solid: np.ndarray) -> bool:
    """Whether the walk is in matter for so short a while that its steps may miss it."""
    return int(solid.sum()) < 10
