from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit

import pytest
from websockets.sync.client import ClientConnection, connect

from explore_bt.debug.web import Desk, PageServer, RunFeed
from explore_bt.recording import McapRecorder, Recording, read_recording
from tests.debug.web.seen import DESK, Seen
from tests.report.flat_drive import Drive, make_drive

PATIENCE_S = 60.0
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--no-first-run"]


@pytest.fixture(scope="session")
def drive(tmp_path_factory) -> Drive:
    """A minute and a half through the flat with two robots."""
    made = make_drive(tmp_path_factory.mktemp("page"), speed_mps=0.6, robots=("anna", "bert <b>"))
    made.show_to(McapRecorder(McapRecorder.Options()))
    return made


@pytest.fixture(scope="session")
def recording(drive) -> Recording:
    return read_recording(drive.run.folder / "recording.mcap")


@pytest.fixture(scope="session")
def feed(recording) -> RunFeed:
    return RunFeed.of(recording)


@pytest.fixture
def server(feed) -> Iterator[PageServer]:
    with PageServer(Desk(feed)) as server:
        yield server


class Asker:
    """A client that asks like the page."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self._count = 0

    def ask(self, ask: str, **members: Any) -> dict[str, Any]:
        self._count += 1
        self.socket.send(json.dumps({"id": self._count, "ask": ask, **members}))
        return self.hear(self._count)

    def hear(self, id_: int | None) -> dict[str, Any]:
        while True:
            message = json.loads(self.socket.recv(timeout=PATIENCE_S))
            if message.get("id", id_) == id_ and "news" not in message:
                return message


@contextmanager
def asking(server: PageServer, **headers: Any) -> Iterator[Asker]:
    url = urlsplit(server.url)
    token = f"?{url.fragment}" if url.fragment else ""
    options = {"origin": f"http://{url.netloc}", "compression": None, "max_size": None} | headers
    with connect(f"ws://{url.netloc}/socket{token}", **options) as socket:
        yield Asker(socket)


@pytest.fixture(scope="package")
def browser() -> Iterator[Any]:
    playwright, chromium = pytest.importorskip("playwright.sync_api"), shutil.which("chromium")
    if chromium is None:
        pytest.skip("chromium is not installed")
    with playwright.sync_playwright() as started:
        browser = started.chromium.launch(executable_path=chromium, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture
def see(browser) -> Iterator[Any]:
    opened: list[Seen] = []

    def see(url: str, size: dict[str, int] = DESK, **options: Any) -> Seen:
        opened.append(Seen(browser, url, size, **options))
        return opened[-1]

    yield see
    for each in opened:
        each.close()
