"""What a body that cannot drive sees and feels is kept from SLAM."""

from __future__ import annotations

from explore_bt.interfaces import Driver, Slam

__all__ = ["Upright"]


class Upright:
    """Passes measurements on while the body can drive, and none while it cannot.

    A lidar that lies on its side shows walls where none are, and an IMU that is thrown about knows nothing of
    where it went. Once the body can drive again SLAM is told to look about for where it stands.
    """

    def __init__(self, driver: Driver, slam: Slam) -> None:
        self._driver, self._slam = driver, slam
        self._was_down = False

    def passes(self) -> bool:
        """Whether SLAM is to hear of what was measured just now."""
        is_down = self._driver.fault is not None
        if self._was_down and not is_down:
            self._slam.pick_up()
        self._was_down = is_down
        return not is_down
