"""Pictures of a scene without a window: colour and depth in one pass."""

from __future__ import annotations

import atexit
import math
import os
import weakref
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from explore_bt.errors import UserError
from explore_bt_drivers.mujoco.scene import GeomGroup, Surroundings

__all__ = ["Screen", "View"]

Floats = NDArray[np.float64]

_SPARE_GEOMS = 100
_EVERYTHING_SEEN = (GeomGroup.WORLD, GeomGroup.GLASS, GeomGroup.MIRROR)


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """From where a picture is taken.

    Attributes:
        eye: (3,) float64, metres, ``map`` frame.
        ahead, up: (3,) float64 unit vectors, ``map`` frame, square to each other.
        field_rad: opening angle from the lower to the upper edge.
    """

    eye: Floats
    ahead: Floats
    up: Floats
    field_rad: float


class Screen:
    """A picture of so many pixels, drawn by OpenGL through EGL, or OSMesa where ``MUJOCO_GL=osmesa`` says so.

    No samples beside the pixels' middles: they would smear depth at edges. No shadows. The same scene gives
    the same pixels.
    """

    def __init__(
        self, model: mujoco.MjModel, surroundings: Surroundings, size: tuple[int, int], *, robot: bool
    ) -> None:
        """Open the picture.

        Args:
            model: compiled of the surroundings' scene.
            surroundings: people and things; a picture of any of the last seconds can be taken.
            size: width and height, pixels.
            robot: whether the robot is seen.

        Raises:
            UserError: the library that draws is missing.
        """
        self.size = size
        self._model, self._surroundings = model, surroundings
        self._data = mujoco.MjData(model)
        mujoco.mj_forward(model, self._data)
        self._scene = mujoco.MjvScene(model, model.ngeom + _SPARE_GEOMS)
        self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = 0
        self._option, self._camera = mujoco.MjvOption(), mujoco.MjvCamera()
        self._option.geomgroup[:] = 0
        for group in (*_EVERYTHING_SEEN, *((GeomGroup.ROBOT,) if robot else ())):
            self._option.geomgroup[group] = 1
        self._gl = _open_gl(size)
        self._gl.make_current()
        self._context = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_100)
        mujoco.mjr_resizeOffscreen(*size, self._context)
        mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._context.readDepthMap = mujoco.mjtDepthMap.mjDEPTH_ZEROFAR
        self._rectangle = mujoco.MjrRect(0, 0, *size)
        self._closer = weakref.finalize(self, _close, self._gl, self._context)
        # at the end of the process before the library's own farewell, which ``_gl`` has just booked: a
        # context that outlives it ends in a crash
        atexit.register(self._closer)

    def close(self) -> None:
        """Let go of the library; no picture after it. Idempotent."""
        self._closer()
        atexit.unregister(self._closer)

    def take(
        self, view: View, time_s: float, robot: Floats | None = None
    ) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        """One picture.

        Args:
            view: from where.
            time_s: when: people and things are where they were then.
            robot: (nq,) float64, the model's state, where the robot is seen.

        Returns:
            (H, W, 3) uint8 RGB, and (H, W) float32 depth along the axis in metres, +inf where nothing is.
        """
        if robot is not None:
            self._data.qpos[:] = robot
        self._surroundings.place(self._data, time_s)
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        mujoco.mjv_updateScene(
            self._model,
            self._data,
            self._option,
            None,
            self._camera,
            mujoco.mjtCatBit.mjCAT_ALL,
            self._scene,
        )
        near, far = self._aim(view)
        return self._drawn(near, far)

    def _aim(self, view: View) -> tuple[float, float]:
        extent = self._model.stat.extent
        near, far = self._model.vis.map.znear * extent, self._model.vis.map.zfar * extent
        half = near * math.tan(view.field_rad / 2.0)
        for camera in self._scene.camera:  # of the two eyes only what both see is drawn
            camera.pos[:], camera.forward[:], camera.up[:] = view.eye, view.ahead, view.up
            camera.frustum_near, camera.frustum_far = near, far
            camera.frustum_center, camera.frustum_width = 0.0, half * self.size[0] / self.size[1]
            camera.frustum_bottom, camera.frustum_top = -half, half
        return near, far

    def _drawn(self, near: float, far: float) -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
        width, height = self.size
        image = np.empty((height, width, 3), dtype=np.uint8)
        depth = np.empty((height, width), dtype=np.float32)
        self._gl.make_current()
        mujoco.mjr_render(self._rectangle, self._scene, self._context)
        mujoco.mjr_readPixels(image, depth, self._rectangle, self._context)
        # OpenGL's pictures begin at the bottom; its depth is 1 at the near plane and 0 at the far one
        share = np.flipud(depth).astype(np.float64)
        with np.errstate(divide="ignore"):
            metres = np.where(share > 0.0, near * far / (near + share * (far - near)), np.inf)
        return np.ascontiguousarray(np.flipud(image)), metres.astype(np.float32)


def _close(gl: Any, context: mujoco.MjrContext) -> None:
    gl.make_current()
    context.free()
    gl.free()


def _open_gl(size: tuple[int, int]) -> Any:
    """A context without a window.

    The backend is imported here rather than chosen by ``MUJOCO_GL`` before ``import mujoco``: a machine
    without OpenGL then has everything but pictures.
    """
    backend = os.environ.get("MUJOCO_GL") or "egl"
    try:
        if backend == "osmesa":
            from mujoco.osmesa import GLContext
        elif backend == "egl":
            from mujoco.egl import GLContext
        else:
            raise UserError(f"MUJOCO_GL is {backend}; expected egl or osmesa, or none of it")
        return GLContext(*size)
    except (ImportError, AttributeError, RuntimeError) as error:
        packages = {"egl": "libegl1 libgl1-mesa-dri", "osmesa": "libosmesa6"}[backend]
        raise UserError(
            f"the camera needs OpenGL through {backend}, which is not installed or does not work here "
            f"({error}); type: apt-get install {packages}, or say camera: off"
        ) from error
