"""From scan to command over ROS 2: ``python benchmarks/ros2.py [SECONDS]``.

A simulated robot in a process of its own in real time, stamps by the system's clock, no /clock; the mission
explores the apartment with ``kiss_gtsam``, ``skeleton`` and ``pursuit``. Measured in the mission's process:
from the end of a sweep (its last beam) until the first command that knows of it has been published.
Network, decoding, SLAM, gate and whatever the loop was doing are in it. The second row is what of that the
control thread computed, in CPU time from reading the scan to the command, without other work on the machine.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from explore_bt_ros2.driver import Ros2

from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Measurement, Scan2D, Twist2

MISSIONS = Path(__file__).parents[1] / "missions"
START = "start=[3.3 m, 3.6 m, 0 deg]"


class Timed(Ros2):
    """Notes when the first command after each scan is out."""

    name = "timed_ros2"
    delays_s: list[float] = []  # noqa: RUF012  # read when the run is over
    computed_s: list[float] = []  # noqa: RUF012  # likewise
    _begun_s = 0.0
    _newest_s: float | None = None

    def read(self) -> Sequence[Measurement]:
        """As ever; the newest scan's stamp is kept."""
        self._begun_s = time.thread_time()
        found = super().read()
        stamps_s = [each.stamp_s for each in found if isinstance(each, Scan2D)]
        self._newest_s = stamps_s[-1] if stamps_s else self._newest_s
        return found

    def command(self, twist: Twist2) -> None:
        """As ever."""
        super().command(twist)
        if self._newest_s is not None:
            self.delays_s.append(self.clock.now_s() - self._newest_s)
            self.computed_s.append(time.thread_time() - self._begun_s)
            self._newest_s = None


def main() -> None:
    """One run, one line of the table."""
    duration_s = float(sys.argv[1]) if len(sys.argv) > 1 else 180.0
    os.environ.setdefault("ROS_DOMAIN_ID", "90")
    robot = subprocess.Popen(
        [
            *(sys.executable, "-c", "from explore_bt.cli import main; main()", "ros2-sim"),
            *(str(MISSIONS / "01_apartment.yaml"), "--wall-time", "--set", START),
        ]
    )
    try:
        registry = load_plugins().registry
        registry.add(Timed, "benchmark")
        text = (MISSIONS / "06_ros2.yaml").read_text().replace("use: ros2", "use: timed_ros2")
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(MISSIONS / "trees", Path(folder) / "trees")
            path = Path(folder) / "timed.yaml"
            path.write_text(text)
            mission = load_mission(path, registry, [START])
            stop = StopFlag()
            timer = threading.Timer(duration_s, stop.raise_flag, ["measured for long enough"])
            timer.start()
            result = run_mission(
                mission, registry=registry, out=Path(folder) / "run", seed=0, sinks=[], stop=stop
            )
            timer.cancel()
    finally:
        robot.terminate()
        robot.wait()
    print(f"{result.outcome}, {result.path_length_m:.1f} m in {result.mission_time_s:.0f} s")
    print("| | scans | median ms | 95 % ms | 99 % ms | longest ms |")
    print("|---|---|---|---|---|---|")
    for what, taken_s in (("scan to command", Timed.delays_s), ("computing alone", Timed.computed_s)):
        taken_ms = 1e3 * np.array(taken_s[50:])  # the first seconds load kernels
        figures = " | ".join(f"{figure:.1f}" for figure in np.percentile(taken_ms, [50, 95, 99, 100]))
        print(f"| {what} | {len(taken_ms)} | {figures} |")


if __name__ == "__main__":
    main()
