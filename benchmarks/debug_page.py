"""How fast is a seek in a long recording, and what does a page cost a tick?

``python benchmarks/debug_page.py RECORDING`` seeks to random moments: in Python, over the socket, and in
Chromium until the page is drawn. ``python benchmarks/debug_page.py --ticks`` runs the first minute of
01_apartment in turns: alone, and under the debugger with a page in Chromium that follows it. The same seed
gives the same ticks, so that each tick is compared with itself: of its times in all turns, the shortest.
"""

from __future__ import annotations

import argparse
import json
import random
import shutil
import statistics
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

from machine import ROOT, describe_machine
from websockets.sync.client import connect

from explore_bt.debug import DebugSession
from explore_bt.debug.web import Controls, Desk, LiveSink, PageServer, RunFeed
from explore_bt.interfaces import PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry, load_plugins
from explore_bt.recording import McapRecorder, read_recording, state_at
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result

SEEKS = 300
TURNS = 3
MISSION_S = 60
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"]


@contextmanager
def chromium() -> Iterator[Any]:
    """A page in a browser."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        yield browser.new_page(viewport={"width": 1280, "height": 800})
        browser.close()


def seeks(path: Path) -> None:
    """The table of seeks."""
    begun_s = time.perf_counter()
    feed = RunFeed.of(read_recording(path))
    feed.timeline.catch_up()
    opened_s = time.perf_counter() - begun_s
    chance = random.Random(0)
    times_s = [chance.uniform(0.0, feed.end_ns / 1e9) for _ in range(SEEKS)]
    print(
        f"{path.name}: {feed.end_ns / 60e9:.1f} min, {path.stat().st_size / 1e6:.1f} MB, "
        f"{len(feed.log)} messages; opened in {opened_s:.1f} s\n"
    )
    print("| a seek | median | 99 % | longest |\n|---|---|---|---|")
    cpu = time.process_time
    row("in Python, CPU", [timed(lambda at_s=at_s: in_python(feed, at_s), cpu) for at_s in times_s])
    row("in Python", [timed(lambda at_s=at_s: in_python(feed, at_s)) for at_s in times_s])
    with PageServer(Desk(feed)) as server:
        url = urlsplit(server.url)
        with connect(
            f"ws://{url.netloc}/socket", origin=f"http://{url.netloc}", max_size=None, compression=None
        ) as socket:
            row("over the socket", [timed(lambda at_s=at_s: over_socket(socket, at_s)) for at_s in times_s])
        with chromium() as page:
            page.goto(server.url)
            page.evaluate(UNTIL_READY)
            spent_s = busy(page)
            before_s = next(spent_s)
            row("in Chromium, until drawn", [page.evaluate(SEEK, at_s) for at_s in times_s])
            print(f"\nCPU of the page's own thread: {1e3 * (next(spent_s) - before_s) / SEEKS:.1f} ms a seek")


UNTIL_READY = """new Promise((done) => {
  const look = () => window.page?.story.count > 0 ? done() : setTimeout(look, 50);
  look();
})"""
SEEK = """async (time) => {
  const begun = performance.now();
  await page.player.seek(time);
  await new Promise((done) => requestAnimationFrame(() => setTimeout(done)));
  return performance.now() - begun;
}"""


def busy(page: Any) -> Iterator[float]:
    """CPU time that the page's main thread has spent, seconds, as often as it is asked."""
    session = page.context.new_cdp_session(page)
    session.send("Performance.enable", {"timeDomain": "threadTicks"})
    while True:
        metrics = session.send("Performance.getMetrics")["metrics"]
        yield next(each["value"] for each in metrics if each["name"] == "TaskDuration")


def in_python(feed: RunFeed, at_s: float) -> None:
    """Every robot's state."""
    for robot in feed.robots:
        state_at(feed.log, robot, round(at_s * 1e9))


def over_socket(socket: Any, at_s: float) -> None:
    """Ask, and read the answer."""
    socket.send(json.dumps({"id": 1, "ask": "state", "at_s": at_s}))
    while "messages" not in json.loads(socket.recv()):
        pass


def timed(work: Callable[[], None], clock: Callable[[], float] = time.perf_counter) -> float:
    """Milliseconds."""
    begun_s = clock()
    work()
    return 1e3 * (clock() - begun_s)


def row(name: str, spent_ms: list[float]) -> None:
    """One line of the table."""
    spent_ms = sorted(spent_ms)
    print(
        f"| {name} | {statistics.median(spent_ms):.1f} ms | {spent_ms[int(0.99 * len(spent_ms))]:.1f} ms"
        f" | {spent_ms[-1]:.1f} ms |"
    )


class Stopwatch(Sink):
    """Wall and CPU time of the tick thread from tick to tick."""

    name = "stopwatch"
    api_version = 1

    def __init__(self) -> None:
        super().__init__(PluginOptions())
        self.wall_s: list[float] = []
        self.cpu_s: list[float] = []
        self._last = (0.0, 0.0)

    def open(self, run: RunInfo) -> None:
        """The run begins."""

    def on_tick(self, tick: TickSnapshot) -> None:  # noqa: ARG002  # when it comes is all that counts
        """A tick has ended."""
        now = time.perf_counter(), time.thread_time()
        if self._last[0]:
            self.wall_s.append(now[0] - self._last[0])
            self.cpu_s.append(now[1] - self._last[1])
        self._last = now

    def close(self, result: Result | None) -> None:
        """The run is over."""


def drive(registry: Registry, attended: bool, page: Any = None) -> Stopwatch:
    """One turn; the run is made in a thread of its own, as Chromium is driven from this one."""
    mission = load_mission(ROOT / "missions" / "01_apartment.yaml", registry, [f"limits.time={MISSION_S} s"])
    watch, live, session = Stopwatch(), LiveSink(), DebugSession()
    with tempfile.TemporaryDirectory() as folder:
        sinks: list[Sink] = [watch, McapRecorder(McapRecorder.Options()), *([live] if attended else [])]

        def run() -> None:
            run_mission(
                mission,
                registry=registry,
                out=Path(folder) / "run",
                seed=1,
                sinks=sinks,
                stop=StopFlag(),
                attendant=session if attended else None,
            )

        thread = threading.Thread(target=run)
        if not attended:
            thread.start()
            thread.join()
            return watch
        with PageServer(Desk(live.feed, Controls(session)), share=0.2) as server:
            page.goto(server.url)
            thread.start()
            while thread.is_alive():
                page.wait_for_timeout(200)
            shown_s = page.evaluate("window.page.player?.time ?? 0")
            assert shown_s > 0.5 * MISSION_S, f"the page has followed to {shown_s} s only"
    return watch


def ticks() -> None:
    """The table of ticks."""
    registry = load_plugins().registry
    alone, attended = [], []
    drive(registry, attended=False)  # compiles
    with chromium() as page:
        for _ in range(TURNS):
            alone.append(drive(registry, attended=False))
            attended.append(drive(registry, attended=True, page=page))
    print(f"01_apartment, first {MISSION_S} s, {TURNS} turns each\n")
    print("| tick | alone | debugger and a page in Chromium | more |\n|---|---|---|---|")
    for name, times in (("CPU of the tick thread", "cpu_s"), ("wall", "wall_s")):
        before, after = (shortest([getattr(each, times) for each in turns]) for turns in (alone, attended))
        for what, figure in (("mean", statistics.mean), ("median", statistics.median)):
            one, two = 1e3 * figure(before), 1e3 * figure(after)
            print(f"| {name}, {what} | {one:.2f} ms | {two:.2f} ms | {100 * (two / one - 1):+.1f} % |")


def shortest(turns: list[list[float]]) -> list[float]:
    """Of each tick's times, the shortest."""
    return [min(times) for times in zip(*turns, strict=False)]


def main() -> None:
    """One table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("recording", type=Path, nargs="?")
    parser.add_argument("--ticks", action="store_true")
    arguments = parser.parse_args()
    print(describe_machine())
    if arguments.recording is not None:
        seeks(arguments.recording)
    if arguments.ticks:
        ticks()


if __name__ == "__main__":
    main()
