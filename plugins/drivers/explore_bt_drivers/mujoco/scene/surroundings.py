"""What moves in a scene of its own: people, doors, furniture that is put elsewhere."""

from __future__ import annotations

from collections import deque

import mujoco
import numpy as np
from numba import njit
from numpy.typing import NDArray

from explore_bt_drivers.mujoco.scene.build import PARKED_M, Scene
from explore_bt_drivers.mujoco.track import STEP_S
from explore_bt_drivers.people.ways import Ways, disc_at
from explore_bt_drivers.world import Scenery, Solid, World

__all__ = ["Stands", "Surroundings"]

_MEMORY_S = 3.0
_FORESEEN_S = 1.0

Stands = tuple[int, ...]
"""For each thing of the world the number of the stand that it is in."""


class Surroundings:
    """Keeps the mocap bodies of a model where people and things are, and remembers where things were.

    A door does not close on the robot and nothing is put onto it: such a change waits until the footprint
    is clear of it. People heed nobody: who walks into the robot pushes it.
    """

    def __init__(self, scene: Scene, model: mujoco.MjModel, footprint_m: float) -> None:
        """Find the bodies in the compiled model.

        Args:
            scene: of which ``model`` was compiled.
            model: with the robot in it.
            footprint_m: radius of what things keep clear of.
        """
        self.scene = scene
        self._scenery = Scenery(scene.world, STEP_S)
        self._footprint_m = footprint_m
        self._due_step = -1
        self._known_s = -1.0
        self._people = _mocaps(model, [scene.person_name(k) for k in range(len(scene.crowd))])
        self._stands = [
            _mocaps(model, [scene.stand_name(thing, stand) for stand in range(len(stands))])
            for thing, stands in enumerate(scene.stands)
        ]
        self._history: deque[tuple[float, Stands]] = deque([(-np.inf, self._scenery.stands)])

    @property
    def ways(self) -> Ways:
        """Of the people, from some seconds ago to beyond the newest step."""
        return self.scene.crowd.ways

    @property
    def world(self) -> World:
        """As it stands now."""
        return self._scenery.world

    def overhangs(self, below_m: float) -> list[Solid]:
        """What hangs lower than that, as it stands now."""
        plan = self.scene.world.plan
        if plan is None:
            return []
        movable = {solid for thing in plan.things for stand in thing.stands for solid in stand.overhangs}
        hanging = [solid for solid in plan.overhangs if solid not in movable]
        for thing, now in zip(plan.things, self._scenery.stands, strict=True):
            hanging += thing.stands[now].overhangs
        return [solid for solid in hanging if solid.low_m < below_m]

    def settle(self, data: mujoco.MjData, step: int, x: float, y: float) -> None:
        """Put everything where it is at a physical step; the robot is at x, y, metres."""
        time_s = step * STEP_S
        if step >= self._due_step:
            self._settle_things(data, step, x, y)
        if len(self._people):
            if time_s >= self._known_s:
                self._known_s = time_s + _FORESEEN_S
                self.scene.crowd.foresee(self._known_s)
            _place(self.ways, self._people, time_s, data.mocap_pos)

    def place(self, data: mujoco.MjData, time_s: float) -> None:
        """Put everything where it was at one of the last seconds, into other data of the same model."""
        self._stand(data, self.stands_at(time_s))
        if len(self._people):
            _place(self.ways, self._people, time_s, data.mocap_pos)

    def stands_at(self, time_s: float) -> Stands:
        """Where things stood at a time of the last seconds."""
        return next(stands for begin_s, stands in reversed(self._history) if begin_s <= time_s)

    def changes_between(self, begin_s: float, end_s: float) -> list[float]:
        """When things were moved after one time and before another, seconds."""
        return [at_s for at_s, _ in self._history if begin_s < at_s < end_s]

    def _settle_things(self, data: mujoco.MjData, step: int, x: float, y: float) -> None:
        self._scenery.settle(step, [(x, y, self._footprint_m)])
        stands = self._scenery.stands
        if stands != self._history[-1][1]:
            self._history.append((step * STEP_S, stands))
        while len(self._history) > 1 and self._history[1][0] < step * STEP_S - _MEMORY_S:
            self._history.popleft()
        self._stand(data, stands)
        self._due_step = self._scenery.next_step(step)

    def _stand(self, data: mujoco.MjData, stands: Stands) -> None:
        for bodies, now in zip(self._stands, stands, strict=True):
            data.mocap_pos[bodies, 2] = PARKED_M
            data.mocap_pos[bodies[now], 2] = 0.0


def _mocaps(model: mujoco.MjModel, names: list[str]) -> NDArray[np.int64]:
    return np.array([model.body(name).mocapid[0] for name in names], dtype=np.int64)


@njit(cache=True)
def _place(ways, bodies, time, positions):  # type: ignore[no-untyped-def]  # kernel
    for person in range(bodies.shape[0]):
        x, y, _, _ = disc_at(ways, person, time)
        positions[bodies[person], 0] = x
        positions[bodies[person], 1] = y
