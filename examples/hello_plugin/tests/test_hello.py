# ruff: noqa: D103  # the name of a test is its sentence
"""The leaf ticked by hand, the sink shown what the leaf has said."""

from types import SimpleNamespace

from hello_plugin import Hello, VisitorsBook

from explore_bt.interfaces import RunInfo
from explore_bt.tree import Blackboard, Status


def test_hello_greets_on_every_tick_until_it_is_done():
    blackboard = Blackboard()
    leaf = Hello("greet", SimpleNamespace(), blackboard, {"to": "Ada", "times": 2})
    leaf.tick_once()
    assert (leaf.status, leaf.feedback_message) == (Status.RUNNING, "hello Ada (1 of 2)")
    leaf.tick_once()
    assert (leaf.status, blackboard["greeting"]) == (Status.SUCCESS, "hello Ada")


def test_the_book_keeps_each_greeting_once(tmp_path):
    book = VisitorsBook(VisitorsBook.Options())
    book.open(RunInfo("mission", "", "", 0, "0.1.0", tmp_path, {}, {}))
    for greeting in ("hello Ada", "hello Ada", "hello Bob"):
        robot = SimpleNamespace(robot="scout", blackboard={"greeting": greeting})
        book.on_tick(SimpleNamespace(robots=(robot,)))
    book.close(None)
    assert (tmp_path / "visitors.txt").read_text() == "scout: hello Ada\nscout: hello Bob\n"
