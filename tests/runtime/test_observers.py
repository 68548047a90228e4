from explore_bt.interfaces import Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.runtime.observers import PATIENCE, Observers
from explore_bt.types import Result

EVENT = Event(0.0, "robot", "info", "test", "something happened")


class CountingSink(Sink):
    name = "counting"
    api_version = 1

    def __init__(self, fails: int = 0) -> None:
        super().__init__(PluginOptions())
        self.calls = 0
        self.fails = fails

    def open(self, run: RunInfo) -> None: ...

    def on_tick(self, tick: TickSnapshot) -> None: ...

    def on_event(self, event: Event) -> None:
        self.calls += 1
        if self.calls <= self.fails:
            raise RuntimeError("disk full")

    def close(self, result: Result | None) -> None: ...


def test_a_sink_that_keeps_failing_is_cut_off_and_the_others_go_on() -> None:
    broken, sound = CountingSink(fails=100), CountingSink()
    observers = Observers([broken, sound])
    for _ in range(10):
        observers.event(EVENT)
    assert broken.calls == PATIENCE
    assert sound.calls == 10


def test_a_sink_that_recovers_keeps_its_place() -> None:
    shaky = CountingSink(fails=PATIENCE - 1)
    observers = Observers([shaky])
    for _ in range(10):
        observers.event(EVENT)
    assert shaky.calls == 10
