"""Drives ahead while the robot may, and says in JSON when that changes: ``python drives.py SPEED``."""

from __future__ import annotations

import json
import math
import sys

from explore_bt_ros2.driver import Ros2
from explore_bt_ros2.options import Ros2Options

from explore_bt.interfaces import RobotContext
from explore_bt.types import Scan2D, Twist2, WheelOdometry

_PERIOD_S = 0.05
_MEMORY = 20


def main() -> None:
    """Until it is killed."""
    driver = Ros2(Ros2Options(discovery="subnet"))
    driver.setup(RobotContext())
    clock, speed_mps = driver.clock, float(sys.argv[1])
    scan_s, x, fault_before, late_s = -math.inf, 0.0, "?", [0.0]
    while True:
        due_s = clock.now_s() + _PERIOD_S
        clock.wait_until(due_s)
        late_s = [*late_s[-_MEMORY:], clock.now_s() - due_s]
        for measured in driver.read():
            if isinstance(measured, Scan2D):
                scan_s = measured.stamp_s
            elif isinstance(measured, WheelOdometry):
                x = measured.T_odom_base.x
        fault = driver.hindrance()
        sent_mps = 0.0 if fault else speed_mps
        driver.command(Twist2(sent_mps, 0.0))
        if bool(fault) != bool(fault_before):
            news = {
                "fault": fault,
                "sent_mps": sent_mps,
                "silent_s": min(clock.now_s() - scan_s, 1e9),  # since the newest scan was measured
                "late_s": max(late_s),  # what the machine kept this loop from running, lately
                "x": x,
            }
            print(json.dumps(news), flush=True)  # noqa: T201  # what the test reads
        fault_before = fault


if __name__ == "__main__":
    main()
