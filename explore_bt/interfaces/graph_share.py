"""What a SLAM tells of its pose graph, and finds out about those of team mates."""

from __future__ import annotations

from explore_bt.types import MapFit, Pose2, SharedKeyframe, SharedStretch

__all__ = ["GraphShare"]


class GraphShare:
    """One robot's end of the pose graph over all robots; this one tells nothing and finds nothing.

    Every robot solves the graph for itself, in its own ``map`` frame, with what the others have measured.
    All methods are called by the control thread.

    Attributes:
        can_find: whether it can find out by itself how another robot's map lies in its own.
    """

    can_find = False

    def keyframe_count(self) -> int:
        """How many keyframes there are to tell of."""
        return 0

    def keyframe(self, number: int) -> SharedKeyframe:
        """What was seen from one of them."""
        raise IndexError(f"there is no keyframe {number}")

    def stretch(self, number: int) -> SharedStretch:
        """Where some of them are now, see ``SharedStretch``."""
        raise IndexError(f"there is no stretch {number}")

    def take(self, mate: str, told: SharedKeyframe | SharedStretch) -> None:
        """What a mate has told; in any order, the newest of each counts."""

    def expect(self, mate: str, T_ours_theirs: Pose2) -> None:
        """Somebody says that the mate's map lies like this; it is to be checked."""

    def look(self) -> None:
        """Called every control period: look for places that both know; ten milliseconds or so at most."""

    def fit(self, mate: str) -> MapFit | None:
        """How the mate's map lies in one's own, once several closures agree.

        The same object until it changes; None until then, and again if later places contradict it.
        """

    def doubts(self, mate: str) -> bool:  # noqa: ARG002  # for those that know
        """Whether what was found so far speaks against what was said, though it proves nothing yet."""
        return False

    def refuse(self, mate: str) -> None:
        """The fit is wrong, whatever the walls say: forget it, and never believe it again."""

    def why_not(self, mate: str) -> str:  # noqa: ARG002  # for those that know
        """Why there is no fit, in a few words."""
        return "its SLAM finds no places of others"
