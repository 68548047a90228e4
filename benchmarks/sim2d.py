"""How fast is sim2d without SLAM? Prints simulated time over process CPU, one line per world.

python benchmarks/sim2d.py [WORLD.yaml ...]
"""

from __future__ import annotations

import statistics
import sys
import time
from pathlib import Path

from explore_bt_drivers import Sim2d, Sim2dOptions
from machine import ROOT, describe_machine

from explore_bt.interfaces import RobotContext
from explore_bt.types import Twist2

_WORLDS = ROOT / "missions" / "worlds"
_CONTROL_HZ = 20
_SIMULATED_S = 60
_REPEATS = 5


def simulated_over_cpu(world: Path, beams: int) -> float:
    """Simulated seconds per second of process CPU: 10 Hz scans, 100 Hz IMU, 20 Hz commands."""
    driver = Sim2d(Sim2dOptions.model_validate({"world": world, "beams": beams}))
    driver.setup(RobotContext(seed=1))
    clock, measured = driver.clock, 0
    begin = time.process_time()
    for period in range(1, _CONTROL_HZ * _SIMULATED_S + 1):
        weave = 0.6 if (period // (2 * _CONTROL_HZ)) % 2 else -0.6
        driver.command(Twist2(0.2, weave))
        clock.wait_until(period / _CONTROL_HZ)
        measured += len(driver.read())
    spent = time.process_time() - begin
    driver.close()
    expected = _SIMULATED_S * (10 + 100 + 20)
    if measured != expected:
        raise RuntimeError(f"{measured} measurements came, {expected} were due")
    return _SIMULATED_S / spent


def main() -> None:
    """Print one table."""
    worlds = [Path(name) for name in sys.argv[1:]] or [_WORLDS / "room.yaml", _WORLDS / "apartment.yaml"]
    print(
        f"sim2d without SLAM: times real time by process CPU, median of {_REPEATS} drives of {_SIMULATED_S} s"
    )
    print(f"{describe_machine()}\n\n| world | 360 beams | 720 beams |\n|---|---|---|")
    for world in worlds:
        figures = [
            statistics.median(simulated_over_cpu(world, beams) for _ in range(_REPEATS))
            for beams in (360, 720)
        ]
        print(f"| {world.stem} | {figures[0]:.0f} × | {figures[1]:.0f} × |", flush=True)


if __name__ == "__main__":
    main()
