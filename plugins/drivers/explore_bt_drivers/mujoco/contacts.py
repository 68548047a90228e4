"""What the body touches: the physics' own contacts, told apart and counted."""

from __future__ import annotations

import re

import mujoco
import numpy as np

from explore_bt_drivers.mujoco.body import Joints
from explore_bt_drivers.mujoco.figures import STEP_M

__all__ = ["Contacts"]

_LEVEL = 0.6
"""Where the z of a contact's normal is larger, a wheel rolls on what it touches."""
_MOVING_MPS = 0.05
_PERSON = re.compile(r"person (\d+)")
_THINGS = -1


class Contacts:
    """Touches of the body with anything but what its wheels roll on.

    Wheels, chassis, mast and lidar count alike, at any height: a table's leg, its top, a wall. A touch lasts
    until the two are 5 mm apart. Touching things counts as one touch, touching people as one each; of people
    only touches count in which the robot was on its way.

    Attributes:
        of_things: how many touches there were of things.
        met: and of people, the robot being on its way faster than 0.05 m/s.
        where: (x, y, z) of the first point of the newest touch of a thing, metres; None before any.
    """

    def __init__(self, model: mujoco.MjModel) -> None:
        self.of_things = self.met = 0
        self.where: tuple[float, float, float] | None = None
        self._over_at_rest = 0
        base = model.body(Joints.BASE).id
        root = model.body_rootid[model.geom_bodyid]
        self._is_robot = np.asarray(root == base)
        self._is_wheel = np.isin(model.geom_bodyid, [model.body(name).id for name in Joints.WHEELS])
        self._floor = model.geom("floor").id
        tops = model.geom_pos[:, 2] + model.geom_aabb[:, 2] + model.geom_aabb[:, 5]
        self._is_low = (model.geom_bodyid == 0) & (tops <= STEP_M)  # sills and low ramps, upright as drawn
        names = [model.body(int(body)).name for body in model.geom_bodyid]
        people = [_PERSON.fullmatch(name) for name in names]
        self._owner = np.array([int(found[1]) if found else _THINGS for found in people])
        self._touched: dict[int, bool] = {}
        """Who is touched now, and whether the robot has moved in it."""

    @property
    def at_rest(self) -> int:
        """Touches of people in which the robot has not moved, those that go on included."""
        return self._over_at_rest + sum(
            not moved for owner, moved in self._touched.items() if owner != _THINGS
        )

    def follow(self, data: mujoco.MjData, speed_mps: float) -> None:
        """Look at the contacts of the newest physical step.

        Args:
            data: of the simulation.
            speed_mps: that the robot is driving at, of its own will.
        """
        near = self._near(data)
        for owner, (distance, place) in near.items():
            if owner not in self._touched and distance < 0.0:
                self._touched[owner] = False
                if owner == _THINGS:
                    self.of_things += 1
                    self.where = place
            if owner != _THINGS and self._touched.get(owner) is False and abs(speed_mps) > _MOVING_MPS:
                self._touched[owner] = True
                self.met += 1
        for owner in [owner for owner in self._touched if owner not in near]:
            self._over_at_rest += owner != _THINGS and not self._touched[owner]
            del self._touched[owner]

    def _near(self, data: mujoco.MjData) -> dict[int, tuple[float, tuple[float, float, float]]]:
        """Whom the body is within 5 mm of, how far (below 0: touched), and where."""
        geoms = data.contact.geom
        if ((geoms == self._floor) | self._is_wheel[geoms]).all():
            return {}  # two wheels on the floor: nearly always
        own = self._is_robot[geoms]
        others = np.where(own[:, 0], geoms[:, 1], geoms[:, 0])
        selves = np.where(own[:, 0], geoms[:, 0], geoms[:, 1])
        steep = np.abs(data.contact.frame[:, 2]) > _LEVEL
        rolls = self._is_wheel[selves] & (steep | self._is_low[others])
        counts = (own.sum(axis=1) == 1) & ~rolls & (others != self._floor)
        near: dict[int, tuple[float, tuple[float, float, float]]] = {}
        for k in np.flatnonzero(counts):
            owner, distance = int(self._owner[others[k]]), float(data.contact.dist[k])
            if owner not in near or distance < near[owner][0]:
                x, y, z = data.contact.pos[k].tolist()
                near[owner] = (distance, (x, y, z))
        return near
