"""The debugger's page: how long a seek takes in a long recording, and what a page costs a tick.

    python benchmarks/debug_page.py RECORDING            seeks, in Python and over the socket
    python benchmarks/debug_page.py --ticks              ticks of 01_apartment with and without a page

Seeks go to random moments, and to the end; each is timed by itself. Ticks are timed in one process, in turns
of 200 ticks with and without a page that follows the run over its socket, so that a busy machine is
the same for both.
"""

from __future__ import annotations

import argparse
import json
import random
import statistics
import subprocess
import sys
import threading
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from urllib.parse import urlsplit

from machine import machine
from websockets.sync.client import ClientConnection, connect

from explore_bt.debug import DebugSession
from explore_bt.debug.web import Controls, Desk, LiveSink, PageServer, RunFeed
from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import load_plugins
from explore_bt.recording import McapRecorder, read_recording, state_at
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result

SEEKS = 300
TURN = 200
TICKS = 2400
