"""The debugger's page: one run, recorded or going on, in a browser."""

from explore_bt.debug.web.access import Access
from explore_bt.debug.web.controls import Controls
from explore_bt.debug.web.desk import Desk
from explore_bt.debug.web.feed import RunFeed
from explore_bt.debug.web.live_sink import LiveSink
from explore_bt.debug.web.server import PageServer

__all__ = ["Access", "Controls", "Desk", "LiveSink", "PageServer", "RunFeed"]
