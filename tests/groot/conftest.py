from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import pytest

from explore_bt.debug import DebugSession, DebugState, Quit, Resume
from explore_bt.groot import GrootSink
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry, load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result
from tests.groot.box import MISSION, WORLD
from tests.groot.client import Client, free_port

PATIENCE_S = 120.0


class Watched:
    """A mission with a Groot2 server, in a thread of its own, paused before the first tick."""

    def __init__(self, path: Path, registry: Registry, out: Path, **options: Any) -> None:
        mission = load_mission(path, registry)
        self.session, self.stop = DebugSession(paused=True), StopFlag()
        self.port = free_port(4)
        self.sink = GrootSink(mission, self.session, port=self.port, **options)
        self.sink.bind()
        self.result: Future[Result] = Future()
        self._at_rest = threading.Event()
        self.session.subscribe(self._hear)

        def run() -> None:
            try:
                sinks = [self.sink]
                self.result.set_result(
                    run_mission(
                        mission,
                        registry=registry,
                        out=out,
                        seed=0,
                        sinks=sinks,
                        stop=self.stop,
                        attendant=self.session,
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

    def go_on(self) -> DebugState:
        self.session.submit(Resume()).result(PATIENCE_S)
        return self.rest()


@pytest.fixture(scope="session")
def registry() -> Registry:
    return load_plugins().registry


@pytest.fixture
def watched(tmp_path: Path, registry: Registry) -> Iterator[Callable[..., Watched]]:
    """Runs a mission in the box."""
    begun: list[Watched] = []
    (tmp_path / "box.yaml").write_text(WORLD)

    def watch(text: str = MISSION, **options: Any) -> Watched:
        path = tmp_path / "mission.yaml"
        path.write_text(text)
        run = Watched(path, registry, tmp_path / f"run{len(begun)}", **options)
        begun.append(run)
        run.rest()
        return run

    yield watch
    for run in begun:
        run.session.submit(Quit())
        run.thread.join(PATIENCE_S)
        assert not run.thread.is_alive()


@pytest.fixture
def connect() -> Iterator[Callable[[Watched], Client]]:
    """A client of a run."""
    clients: list[Client] = []

    def connect(run: Watched) -> Client:
        clients.append(Client(run.port))
        return clients[-1]

    yield connect
    for client in clients:
        client.close()
