"""The debugger in a terminal: plain lines, so that it works over ssh and from a script."""

from explore_bt.debug.terminal.console import Console, Terminated
from explore_bt.debug.terminal.reader import LineReader

__all__ = ["Console", "LineReader", "Terminated"]
