"""Builds ``nav2_msgs`` with the one action that is needed, for a stand-in of Nav2: ``build(folder)``.

The wheels of ROS 2 can build interfaces, with cmake and a compiler; only their cmake files name the Python
they were built with, which is put right first.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

__all__ = ["build", "can_build", "preload"]

_SOURCE = Path(__file__).with_name("nav2_msgs")
_BUILDERS = "/opt/python/cp3{minor}-cp3{minor}"


def can_build() -> bool:
    """Whether a compiler, cmake and the generators are there."""
    tools = shutil.which("cmake") and shutil.which("c++")
    return bool(tools) and (Path(sys.prefix) / "share/rosidl_default_generators").is_dir()


def build(folder: Path) -> Path:
    """Build and install below ``folder``; what is to be put on ``sys.path``."""
    _mend_wheels()
    made, installed = folder / "build", folder / "installed"
    python = sys.executable
    configure = [
        *("cmake", "-S", _SOURCE, "-B", made, f"-DCMAKE_PREFIX_PATH={sys.prefix}"),
        *(f"-DCMAKE_INSTALL_PREFIX={installed}", f"-DPython3_EXECUTABLE={python}"),
        "-DCMAKE_BUILD_TYPE=Release",
        f"-DCMAKE_INSTALL_RPATH=$ORIGIN;{installed / 'lib'}",
    ]
    environment = {**os.environ, "AMENT_PREFIX_PATH": sys.prefix}
    for command in (configure, ["cmake", "--build", made, "-j2"], ["cmake", "--install", made]):
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=False)
        assert done.returncode == 0, f"{command}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    (found,) = installed.rglob("nav2_msgs/action/__init__.py")
    return found.parents[2]


def preload(where: Path) -> None:
    """Load them, so that the middleware, which looks for names, finds them in this process."""
    for kind in ("introspection_c", "fastrtps_c", "fastrtps_cpp", "c"):
        for path in sorted(where.parents[1].glob(f"libnav2_msgs__rosidl_*{kind}.so")):
            ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)


def _mend_wheels() -> None:
    minor = sys.version_info.minor
    old = _BUILDERS.format(minor=minor)
    base = Path(sys.base_prefix)
    for path in (Path(sys.prefix) / "share").rglob("*.cmake"):
        text = path.read_text(encoding="utf-8", errors="surrogateescape")
        if old in text:
            path.write_text(text.replace(old, str(base)), encoding="utf-8", errors="surrogateescape")
