from __future__ import annotations

import textwrap
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from explore_bt.debug import Command, DebugSession, DebugState, History, Params, Quit, Resume
from explore_bt.interfaces import Sink
from explore_bt.mission import Mission, load_mission
from explore_bt.plugin import Registry, load_plugins
from explore_bt.recording import McapRecorder
from explore_bt.runtime import Attendant, StopFlag, run_mission
from explore_bt.types import Result
from tests.groot.box import WORLD

PATIENCE_S = 120.0

HEAD = """
format: explore-bt/1
name: box
params:
  first: {type: duration, default: 0.5 s, min: 0.1 s, max: 1 min}
  limit: {type: duration, default: 10 s}
  again: {type: integer, default: 1}
  radius: {type: length, default: 0.2 m}
  budget: {type: duration, default: 30 s}
  unused: {type: number, default: 1}
robots:
  robot:
    driver: {use: sim2d, world: box.yaml, radius: $params.radius}
    slam: {use: ground_truth}
    planner: {use: grid_astar}
    controller: {use: pursuit}
limits: {time: $params.budget}
tree: main
"""

TREE = """
trees:
  main:
    sequence:
      - wait: {duration: $params.first}
        name: first
        timeout: $params.limit
        retry: $params.again
      - fallback:
          - invert: wait_until_localised
          - wait: {duration: 0.3 s}
            name: second
      - choose_place: {x: 3.5 m, y: 1.5 m}
      - drive_to
"""


class Debugged:
    """A mission under a debugger, in a thread of its own; the test is the client."""

    def __init__(
        self, mission: Mission, registry: Registry, out: Path, session: DebugSession, sinks: Sequence[Sink]
    ) -> None:
        self.session, self.out, self.stop, self.history = session, out, StopFlag(), History()
        self.result: Future[Result] = Future()
        self._at_rest = threading.Event()
        session.subscribe(self._hear)
        every = [McapRecorder(McapRecorder.Options()), self.history, *sinks]

        def run() -> None:
            try:
                self.result.set_result(
                    run_mission(
                        mission,
                        registry=registry,
                        out=out,
                        seed=0,
                        sinks=every,
                        stop=self.stop,
                        attendant=session,
                    )
                )
            except BaseException as fault:
                self.result.set_exception(fault)

        self.thread = threading.Thread(target=run, daemon=True)
        self.thread.start()

    def _hear(self, state: DebugState) -> None:
        if state.paused or state.over:
            self._at_rest.set()

    def rest(self) -> DebugState:
        """The state once the run is paused or over."""
        while not ((state := self.session.state()).paused or state.over):
            assert self._at_rest.wait(PATIENCE_S), f"still {state.why}"
            self._at_rest.clear()
        return state

    def do(self, command: Command[Any]) -> Any:
        return self.session.submit(command).result(PATIENCE_S)

    def go(self, command: Command[Any]) -> DebugState:
        self.do(command)
        return self.rest()

    def finish(self) -> Result:
        if not self.rest().over:
            self.do(Resume())
        return self.result.result(PATIENCE_S)

    @property
    def recording(self) -> bytes:
        return (self.out / "recording.mcap").read_bytes()


@pytest.fixture(scope="session")
def registry() -> Registry:
    return load_plugins().registry


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "box.yaml").write_text(WORLD)
    return tmp_path


Debug = Callable[..., Debugged]


@pytest.fixture
def load(folder: Path, registry: Registry) -> Callable[..., Mission]:
    def load(*settings: str, tree: str = TREE, head: str = HEAD) -> Mission:
        path = folder / "mission.yaml"
        if not path.is_file():
            path.write_text(head + textwrap.dedent(tree))
        return load_mission(path, registry, settings)

    return load


@pytest.fixture
def debug(folder: Path, registry: Registry, load: Callable[..., Mission]) -> Iterator[Debug]:
    """Run a mission in the box under a debugger, paused before the first tick."""
    begun: list[Debugged] = []

    def debug(
        *settings: str, tree: str = TREE, head: str = HEAD, sinks: Sequence[Sink] = (), paused: bool = True
    ) -> Debugged:
        mission = load(*settings, tree=tree, head=head)
        params = Params(mission, lambda again: load(*again), settings)
        session = DebugSession(params, paused=paused)
        run = Debugged(mission, registry, folder / f"run{len(begun)}", session, sinks)
        begun.append(run)
        if paused:
            run.rest()
        return run

    yield debug
    for run in begun:
        run.session.submit(Quit())
        run.thread.join(PATIENCE_S)
        assert not run.thread.is_alive()


@pytest.fixture
def alone(folder: Path, registry: Registry, load: Callable[..., Mission]) -> Callable[..., bytes]:
    """The recording of the same run let go, without a debugger."""

    def alone(*settings: str, tree: str = TREE, head: str = HEAD) -> bytes:
        out = folder / "alone"
        run_mission(
            load(*settings, tree=tree, head=head),
            registry=registry,
            out=out,
            seed=0,
            sinks=[McapRecorder(McapRecorder.Options())],
            stop=StopFlag(),
            attendant=Attendant(),
        )
        return (out / "recording.mcap").read_bytes()

    return alone
