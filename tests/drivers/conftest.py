from collections.abc import Sequence

from explore_bt_drivers import Sim2d

from explore_bt.types import Measurement, Scan2D, Twist2


def drive(driver: Sim2d, twist: Twist2, duration_s: float) -> list[Measurement]:
    measured: list[Measurement] = []
    begin = driver.clock.now_s()
    for period in range(1, round(duration_s * 20) + 1):
        driver.command(twist)
        driver.clock.wait_until(begin + period / 20)
        measured += driver.read()
    return measured


def prints(measured: Sequence[Measurement]) -> list[object]:
    return [m.ranges_m.tobytes() if isinstance(m, Scan2D) else m for m in measured]
