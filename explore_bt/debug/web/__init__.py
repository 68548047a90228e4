"""The debugger's page: one run, recorded or going on, in a browser."""

from explore_bt.debug.web.access import Access
from explore_bt.debug.web.desk import Desk
from explore_bt.debug.web.feed import RunFeed
from explore_bt.debug.web.server import PageServer

__all__ = ["Access", "Desk", "PageServer", "RunFeed"]
