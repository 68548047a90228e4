"""The robot's body: what it is made of, and how it gets into a scene."""

from __future__ import annotations

import math

import mujoco

from explore_bt.types import Pose2
from explore_bt_drivers.mujoco.figures import TRACK_M, WHEEL_RADIUS_M
from explore_bt_drivers.mujoco.scene.groups import GeomGroup

__all__ = ["TORQUE_NM", "Joints", "add_robot"]

TORQUE_NM = 9.0
"""The most that a motor gives: onto a sill of 2 cm takes 6.3 of each."""

_WHEEL_WIDTH_M, _WHEEL_KG = 0.025, 1.25
_CHASSIS_KG, _MAST_KG, _LIDAR_KG, _CAMERA_KG = 16.2, 2.1, 0.85, 0.35
_GAP_M = 0.005
"""Contacts are noted from this distance on, and push from 0 on."""
_COLOURS = {
    "dark": [0.12, 0.13, 0.15, 1.0],
    "body": [0.85, 0.86, 0.88, 1.0],
    "accent": [0.95, 0.45, 0.1, 1.0],
}


class Joints:
    """Names in the model."""

    BASE = "base_link"
    IMU = "imu"
    WHEELS = ("left wheel", "right wheel")


def add_robot(spec: mujoco.MjSpec, start: Pose2) -> None:
    """Put the robot into a scene, upright, ``base_link`` on the plane of the floor at ``start``.

    ``base_link`` is fixed to the body, under the middle of the axle by the radius of the wheels.
    """
    half = 0.5 * start.yaw_rad
    base = spec.worldbody.add_body(
        name=Joints.BASE, pos=[start.x, start.y, 0.0], quat=[math.cos(half), 0.0, 0.0, math.sin(half)]
    )
    base.add_freejoint(name=Joints.BASE)
    base.add_site(name=Joints.IMU, pos=[0.0, 0.0, WHEEL_RADIUS_M], group=GeomGroup.ROBOT)
    _add_box(base, "chassis", (0.0, 0.0, 0.185), (0.11, 0.2, 0.095), _CHASSIS_KG, "body")
    _add_box(base, "mast", (0.0, 0.0, 0.37), (0.03, 0.05, 0.09), _MAST_KG, "dark")
    _add_box(base, "camera", (0.03, 0.0, 0.4), (0.02, 0.05, 0.015), _CAMERA_KG, "accent")
    base.add_geom(
        name="lidar",
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        pos=[0.0, 0.0, 0.5],
        size=[0.052, 0.036, 0.0],
        mass=_LIDAR_KG,
        rgba=_COLOURS["dark"],
        **_SHELL,
    )
    for name, side in zip(Joints.WHEELS, (1.0, -1.0), strict=True):
        _add_wheel(spec, base, name, 0.5 * side * TRACK_M)
    for kind, name in ((mujoco.mjtSensor.mjSENS_ACCELEROMETER, "accelerometer"),):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=Joints.IMU)


_SHELL = {"group": GeomGroup.ROBOT, "gap": _GAP_M}


def _add_box(
    base: mujoco.MjsBody,
    name: str,
    at: tuple[float, float, float],
    half: tuple[float, float, float],
    mass_kg: float,
    colour: str,
) -> None:
    base.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_BOX,
        pos=list(at),
        size=list(half),
        mass=mass_kg,
        rgba=_COLOURS[colour],
        **_SHELL,
    )


def _add_wheel(spec: mujoco.MjSpec, base: mujoco.MjsBody, name: str, y: float) -> None:
    wheel = base.add_body(name=name, pos=[0.0, y, WHEEL_RADIUS_M])
    wheel.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 1.0, 0.0], damping=0.01)
    wheel.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_CYLINDER,
        size=[WHEEL_RADIUS_M, 0.5 * _WHEEL_WIDTH_M, 0.0],
        quat=[math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0],
        mass=_WHEEL_KG,
        friction=[1.0, 0.005, 0.0001],
        rgba=_COLOURS["dark"],
        **_SHELL,
    )
    spec.add_actuator(
        name=name,
        target=name,
        trntype=mujoco.mjtTrn.mjTRN_JOINT,
        ctrlrange=[-TORQUE_NM, TORQUE_NM],
        ctrllimited=mujoco.mjtLimited.mjLIMITED_TRUE,
    )
