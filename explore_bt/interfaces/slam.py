"""Contract of SLAM back ends: measurements in, pose and map out."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Mapping
from pathlib import Path

from explore_bt.interfaces.graph_share import GraphShare
from explore_bt.interfaces.plugin import Plugin, RobotContext
from explore_bt.types import Estimate, GridWindow, MapStructure, Measurement, OccupancyGrid, Trajectory

__all__ = ["Slam"]


class Slam(Plugin):
    """Where the robot is and what its surroundings look like.

    All methods are called by one thread, the control thread; what they return is immutable and may be read
    by others.
    """

    kind = "slam"

    @abstractmethod
    def setup(self, context: RobotContext) -> None:
        """Get ready: ``context.start`` is the pose in ``map`` to begin with (identity if None).

        Compile and warm up here, never in ``update``.
        """

    @abstractmethod
    def update(self, measurement: Measurement) -> None:
        """Take one measurement, in time order; kinds it has no use for are ignored.

        Bad data (NaN, empty scan, time going back) is survived and shows in ``estimate().health``.
        """

    @abstractmethod
    def estimate(self) -> Estimate:
        """The newest pose in ``map``, with covariance and health. Cheap.

        Late is fine, and made up for from the commands; more than a second late holds the robot.
        """

    @abstractmethod
    def grid(self) -> OccupancyGrid:
        """The newest map; the same object as before while the revision stands."""

    @abstractmethod
    def changed_since(self, revision: int) -> GridWindow | None:
        """Cells of ``grid()`` that may differ from that revision; None if that can't be told.

        None also when the grid has grown or moved: the caller then takes all of it.
        """

    def forget_near(self, position: tuple[float, float], radius_m: float) -> bool:  # noqa: ARG002  # for those that can
        """Call obstacles free until they are seen again; False where a plugin cannot (the default).

        Args:
            position: x, y in metres, ``map`` frame.
            radius_m: how far about it.
        """
        return False

    @abstractmethod
    def trajectory(self) -> Trajectory:
        """The best present belief about the whole way so far, one pose per scan, ``map`` frame."""

    @abstractmethod
    def figures(self) -> Mapping[str, float]:
        """Numbers for the report: ``keyframes``, ``loop_closures``, ``ms_per_scan_median``, ..."""

    def structure(self) -> MapStructure:
        """Voxels and pose graph for the exporters, called once at the end; nothing unless overridden."""
        return MapStructure()

    def graph_share(self) -> GraphShare:
        """What is told to team mates and found out about them; nothing unless overridden. Called once."""
        return GraphShare()

    @abstractmethod
    def save(self, folder: Path) -> None:
        """Write all that ``load`` needs to go on in this map."""

    def begin_save(self, folder: Path, before: Path | None) -> Callable[[], None]:  # noqa: ARG002  # those that can
        """Take hold of what ``save`` would write now, quickly, and return what writes it.

        A checkpoint is written beside the control loop: what is returned is called once, by another
        thread, while ``update`` goes on, and must read nothing that ``update`` changes. The default saves
        at once, which holds the robot's loop up for as long as ``save`` takes.

        Args:
            folder: as for ``save``.
            before: what this plugin wrote for the checkpoint before, if it is still there: files that
                would be the same may be linked from it (``os.link``); None: write everything.
        """
        self.save(folder)
        return lambda: None

    def pick_up(self) -> None:
        """A resumed run has given ``update`` all that was recorded, or a fallen robot has been stood up.

        It stands still now. It may stand half a metre from ``estimate()``, turned by as much as it had time
        for. The default trusts ``update`` to find that out.
        """

    @abstractmethod
    def load(self, folder: Path) -> None:
        """Go on in a saved map; called after ``setup``.

        Raises:
            UserError: the folder holds no map of this plugin.
        """
