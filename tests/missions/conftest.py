from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from explore_bt.interfaces import Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.mission import load_mission
from explore_bt.plugin import Registry, load_plugins
from explore_bt.runtime import StopFlag, run_mission
from explore_bt.types import Result

MISSIONS = Path(__file__).resolve().parents[2] / "missions"

RunMission = Callable[..., Result]


class Watcher(Sink):
    """Keeps all that observers are shown."""

    name = "watcher"
    api_version = 1

    def __init__(self) -> None:
        super().__init__(PluginOptions())
        self.events: list[Event] = []
        self.ticks: list[TickSnapshot] = []

    def open(self, run: RunInfo) -> None: ...

    def on_tick(self, tick: TickSnapshot) -> None:
        self.ticks.append(tick)

    def on_event(self, event: Event) -> None:
        self.events.append(event)

    def close(self, result: Result | None) -> None: ...


@pytest.fixture
def registry() -> Registry:
    return load_plugins().registry


@pytest.fixture
def run(registry: Registry, tmp_path: Path) -> RunMission:
    """Run a shipped mission in this process; results go to ``tmp_path / out``."""

    def run(
        name: str,
        *settings: str,
        seed: int = 0,
        out: str = "run",
        sinks: Sequence[Sink] = (),
        stop: StopFlag | None = None,
    ) -> Result:
        mission = load_mission(MISSIONS / name, registry, list(settings))
        return run_mission(
            mission, registry=registry, out=tmp_path / out, seed=seed, sinks=sinks, stop=stop or StopFlag()
        )

    return run
