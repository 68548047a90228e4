"""The run as it happens: a live view for terminals, plain lines for everything else."""

from explore_bt.report.live.map_dots import MapDots, RobotMark
from explore_bt.report.live.progress import ProgressLines
from explore_bt.report.live.terminal import TerminalView

__all__ = ["MapDots", "ProgressLines", "RobotMark", "TerminalView"]
