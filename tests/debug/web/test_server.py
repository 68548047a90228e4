"""The server from outside, over real sockets: who may ask, what is served, who can harm it."""

from __future__ import annotations

import json
import re
import socket
import struct
import threading
from contextlib import ExitStack, suppress
from importlib.resources import files
from urllib.parse import urlsplit

import httpx
import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import connect

from explore_bt.debug.web import Desk, PageServer
from explore_bt.debug.web.client import PATIENCE_S as CLIENT_PATIENCE_S
from explore_bt.debug.web.server import MOST_CLIENTS
from explore_bt.errors import UserError
from tests.debug.web.conftest import PATIENCE_S, asking

EVIL = "http://evil.example"


def place(server: PageServer) -> tuple[str, int]:
    url = urlsplit(server.url)
    return url.hostname, url.port


def raw(server: PageServer, request: bytes) -> bytes:
    """What comes back for these bytes, until the server closes."""
    with socket.create_connection(place(server), PATIENCE_S) as connection:
        connection.sendall(request)
        answer = b""
        while data := connection.recv(65536):
            answer += data
        return answer


def get(server: PageServer, path: str, *headers: str) -> bytes:
    host = "{}:{}".format(*place(server))
    told = headers or (f"Host: {host}",)
    return raw(server, "\r\n".join((f"GET {path} HTTP/1.1", *told, "Connection: close", "", "")).encode())


def still_answers(server: PageServer) -> bool:
    with asking(server) as asker:
        return "run" in asker.ask("run")


def test_the_page_and_all_it_needs_come_from_the_package_with_headers_that_keep_it_to_itself(server):
    with httpx.Client(base_url=server.url) as client:
        page = client.get("/")
        assert page.status_code == 200
        assert "default-src 'none'" in page.headers["content-security-policy"]
        assert page.headers["x-content-type-options"] == "nosniff"
        assert "server" not in page.headers
        for asset in (files("explore_bt.debug.web") / "assets").iterdir():
            answer = client.get(f"/{asset.name}")
            assert answer.content == asset.read_bytes()
            assert "javascript" in answer.headers["content-type"] or asset.name[-3:] != ".js"
            assert not re.search(rb"https?://(?!www\.w3\.org/2000/svg)[\w.]|@import", answer.content)


def test_nothing_else_is_served(server, drive):
    outside = (
        *("/..%2f..%2fserver.py", "/../server.py", "/%2e%2e/%2e%2e/server.py", "/assets/../server.py"),
        *("//etc/passwd", "/etc/passwd", "/%2fetc%2fpasswd", "/..\\server.py", "/index.html/../../server.py"),
        *("/recording.mcap", "/__init__.py", "/index.html%00.js", "/.", "/%c0%ae%c0%ae/server.py"),
        *("http://127.0.0.1/etc/passwd", "/index.html/", "/" + "a" * 5000),
    )
    for path in outside:
        answer = get(server, path)
        assert b" 200 " not in answer.split(b"\r\n")[0], path
        assert b"root:" not in answer
    assert drive.run.folder.name not in get(server, "/nothing").decode()


def test_a_link_in_the_run_folder_leads_nowhere(server, drive):
    link = drive.run.folder / "secret.txt"
    link.symlink_to("/etc/passwd")
    assert b" 404 " in get(server, "/secret.txt").split(b"\r\n")[0]


@pytest.mark.parametrize("method", ["POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE"])
def test_the_page_is_only_read(server, method):
    host = "{}:{}".format(*place(server))
    answer = raw(server, f"{method} / HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
    assert answer.split(b" ")[1] in (b"400", b"404", b"405")


@pytest.mark.parametrize(
    "headers", [("Host: evil.example",), ("Host: a\r\nHost: 127.0.0.1",), ("Accept: */*",), ("Host:",)]
)
def test_under_another_name_there_is_no_page(server, headers):
    assert get(server, "/", *headers).split(b" ")[1] in (b"400", b"403")


@pytest.mark.parametrize("origin", [EVIL, "null", None, "http://localhost:1"])
def test_a_foreign_page_cannot_open_the_socket(server, origin):
    with pytest.raises(InvalidStatus) as refused, asking(server, origin=origin):
        pass
    assert refused.value.response.status_code == 403


def test_a_rebound_name_cannot_open_the_socket(server):
    host, port = place(server)
    with socket.create_connection((host, port)) as plain, pytest.raises(InvalidStatus) as refused:
        open_and_close(f"ws://evil.example:{port}/socket", f"{EVIL}:{port}", sock=plain)
    assert refused.value.response.status_code == 403


def test_on_another_address_the_socket_wants_the_token(feed):
    with PageServer(Desk(feed), host="0.0.0.0") as server:
        url = urlsplit(server.url)
        assert url.fragment.startswith("token=")
        local = f"127.0.0.1:{url.port}"
        assert httpx.get(f"http://{local}/").status_code == 200  # the page itself tells nothing
        origin = f"http://{local}"
        for token in ("", "?token=", "?token=wrong", f"?token={url.fragment[6:-1]}"):
            with pytest.raises(InvalidStatus):
                open_and_close(f"ws://{local}/socket{token}", origin)
        open_and_close(f"ws://{local}/socket?{url.fragment}", origin)


def open_and_close(url: str, origin: str, **options) -> None:
    with connect(url, origin=origin, **options):
        pass


def test_a_port_that_is_taken_is_told_in_one_line(server, feed):
    with pytest.raises(UserError, match=r"127\.0\.0\.1:\d+ cannot be listened on.*--port"):
        PageServer(Desk(feed), port=place(server)[1])
    with pytest.raises(UserError, match=r"no\.such\.host\.invalid"):
        PageServer(Desk(feed), host="no.such.host.invalid")


@pytest.mark.parametrize("garbage", ["", "{", "[]", "null", '{"id":1}', "\0" * 100, "𝒳" * 1000, "[" * 50_000])
def test_garbage_is_answered_with_an_error_and_the_socket_lives(server, garbage):
    with asking(server) as asker:
        asker.socket.send(garbage)
        assert "not a request" in asker.hear(None)["error"]
        assert "run" in asker.ask("run")


def test_bytes_instead_of_text_end_the_socket_alone(server):
    with asking(server) as asker:
        asker.socket.send(b"\x00\x01")
        with pytest.raises(ConnectionClosed):
            asker.ask("run")
    assert still_answers(server)


def test_who_sends_only_garbage_is_parted_with(server):
    def litter(socket) -> None:
        for _ in range(10_000):
            socket.send("garbage")
            socket.recv()

    with asking(server) as asker, pytest.raises(ConnectionClosed):
        litter(asker.socket)
    assert still_answers(server)


def test_a_message_that_is_too_long_ends_the_socket_alone(server):
    with asking(server) as asker:
        asker.socket.send(json.dumps({"id": 1, "ask": "look", "robot": "x" * 1_000_000}))
        with pytest.raises(ConnectionClosed) as closed:
            asker.hear(1)
        assert closed.value.rcvd is not None
        assert closed.value.rcvd.code == 1009
    assert still_answers(server)


@pytest.mark.parametrize(
    "noise", [b"\x16\x03\x01\x02\x00\x01", b"GET", b"\r\n" * 10_000, b"G" * 200_000, b"\xff\xfe\x00" * 999]
)
def test_noise_on_the_port_harms_nothing(server, noise):
    deaf = suppress(ConnectionResetError, BrokenPipeError)  # it may have heard enough
    with deaf, socket.create_connection(place(server), PATIENCE_S) as connection:
        connection.sendall(noise)
    assert still_answers(server)


def test_only_so_many_pages_at_once(server):
    with ExitStack() as open_:
        askers = [open_.enter_context(asking(server)) for _ in range(MOST_CLIENTS)]
        with pytest.raises((InvalidStatus, ConnectionClosed)):
            open_.enter_context(asking(server)).ask("run")
        assert "run" in askers[-1].ask("run")
    assert still_answers(server)


def test_a_client_that_dies_in_the_middle_harms_nothing(server):
    for _ in range(10):
        with asking(server) as asker:
            asker.socket.send('{"id":1,"ask":"state","at_s":30}')
            plain = asker.socket.socket
            plain.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset
            plain.close()
    assert still_answers(server)


def test_who_asks_a_lot_and_reads_nothing_keeps_nobody_waiting(server):
    with asking(server) as glutton:
        plain = glutton.socket.socket
        plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        stop = threading.Event()

        def gorge() -> None:
            number = 0
            while not stop.is_set():
                number += 1
                try:
                    glutton.socket.send(json.dumps({"id": number, "ask": "state", "at_s": number % 60}))
                except ConnectionClosed:
                    return

        eater = threading.Thread(target=gorge, daemon=True)
        eater.start()
        with asking(server) as other:
            for at_s in range(60):
                assert other.ask("state", at_s=float(at_s))["at_s"] == at_s
        stop.set()
        plain.shutdown(socket.SHUT_RDWR)
        eater.join(CLIENT_PATIENCE_S)
        assert not eater.is_alive()
    assert still_answers(server)


def test_it_ends_at_once_with_clients_still_there(feed):
    with PageServer(Desk(feed)) as server, asking(server) as asker:
        assert "run" in asker.ask("run")
        name = "page server"
        assert name in [thread.name for thread in threading.enumerate()]
        server.__exit__(None, None, None)
        assert name not in [thread.name for thread in threading.enumerate()]
        with pytest.raises(ConnectionClosed):
            asker.ask("run")


def test_a_fault_of_ours_is_told_and_the_socket_lives(feed, caplog):
    class Faulty(Desk):
        def answer(self, request):
            return super().answer(request) if request.ask == "run" else str(1 / 0)

    with PageServer(Faulty(feed)) as server, asking(server) as asker:
        assert "ZeroDivisionError" in asker.ask("state", at_s=1.0)["error"]
        assert "run" in asker.ask("run")
    assert "question state was not answered" in caplog.text
