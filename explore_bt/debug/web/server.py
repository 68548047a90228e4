"""The page's server: static files, one socket, and the rules on who may use them."""

from __future__ import annotations

import socket
import threading
from importlib.resources import files
from types import TracebackType
from urllib.parse import quote

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from explore_bt.debug.web.access import Access
from explore_bt.debug.web.client import Client, Share
from explore_bt.debug.web.desk import Desk
from explore_bt.errors import UserError

__all__ = ["PageServer"]

MOST_CLIENTS = 16
_MOST_BYTES_ASKED = 64 * 1024
_MOST_CONNECTIONS = 64
_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".svg": "image/svg+xml",
}
_HEADERS = [
    (
        b"content-security-policy",
        b"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
        b"base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    ),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
    (b"cross-origin-opener-policy", b"same-origin"),
    (b"cross-origin-resource-policy", b"same-origin"),
    (b"cache-control", b"no-store"),
]


class PageServer:
    """Serves the page in a thread of its own while inside ``with``.

    Only what is in the package's folder of assets is ever served, from memory: no request names a file.

    Args:
        desk: answers what the page asks.
        host: address to bind; anything but loopback demands a token.
        port: 0 for a free one.
        token: demanded on any address if given.
        share: of one core that answering may take.

    Raises:
        UserError: the address cannot be had.
    """

    def __init__(
        self, desk: Desk, *, host: str = "127.0.0.1", port: int = 0, token: str = "", share: float = 1.0
    ) -> None:
        self._desk = desk
        self._access = Access.to(host, token)
        self._listener = _bound(host, port)
        self._share = Share(share)
        self._clients = 0
        app = Starlette(
            routes=[
                WebSocketRoute("/socket", self._serve_socket),
                Route("/{name}", self._serve_asset, methods=["GET"]),
                Route("/", self._serve_asset, methods=["GET"]),
            ]
        )
        self._assets = _assets()
        self._server = uvicorn.Server(
            uvicorn.Config(
                _Guarded(app, self._access),
                log_config=None,
                access_log=False,
                server_header=False,
                lifespan="off",
                http="h11",
                ws="websockets-sansio",
                ws_max_size=_MOST_BYTES_ASKED,
                ws_per_message_deflate=False,
                limit_concurrency=_MOST_CONNECTIONS,
                timeout_graceful_shutdown=1,
            )
        )
        self._thread = threading.Thread(target=self._run, name="page server", daemon=True)

    @property
    def url(self) -> str:
        """What to open; the token stands behind ``#``, where browsers send it to nobody."""
        host, port = self._listener.getsockname()[:2]
        shown = {"0.0.0.0": socket.gethostname(), "::": socket.gethostname()}.get(host, host)
        shown = f"[{shown}]" if ":" in shown else shown
        token = f"#token={quote(self._access.token)}" if self._access.token else ""
        return f"http://{shown}:{port}/{token}"

    def __enter__(self) -> PageServer:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._server.should_exit = True
        self._thread.join(5.0)
        self._listener.close()

    def _run(self) -> None:
        self._server.run(sockets=[self._listener])

    async def _serve_asset(self, request: Request) -> Response:
        found = self._assets.get(request.path_params.get("name", "index.html"))
        if found is None:
            return PlainTextResponse("there is no such page", 404)
        content, type_ = found
        return Response(content, media_type=type_)

    async def _serve_socket(self, page: WebSocket) -> None:
        if self._clients >= MOST_CLIENTS:
            await page.close(1013)
            return
        self._clients += 1
        try:
            await page.accept()
            await Client(page, self._desk, self._share).serve()
        finally:
            self._clients -= 1


class _Guarded:
    """Turns away who may not ask, and sets the headers that keep the page to itself."""

    def __init__(self, app: ASGIApp, access: Access) -> None:
        self._app = app
        self._access = access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        connection = HTTPConnection(scope)
        refused = self._refusal(connection, is_socket=scope["type"] == "websocket")
        if refused and scope["type"] == "websocket":
            await WebSocket(scope, receive, send).close(1008, refused)  # before accept: 403
            return
        app = PlainTextResponse(refused, 403) if refused else self._app

        async def send_with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", ()), *_HEADERS]
            await send(message)

        await app(scope, receive, send_with_headers)

    def _refusal(self, connection: HTTPConnection, *, is_socket: bool) -> str:
        hosts = connection.headers.getlist("host")
        host = hosts[0] if len(hosts) == 1 else None
        if not self._access.admits_host(host):
            return "this server does not go by that name; open the address it printed"
        if not is_socket:
            return ""
        if not self._access.admits_origin(connection.headers.get("origin"), host):
            return "only the page of this server may open its socket"
        if not self._access.admits_token(connection.query_params.get("token", "")):
            return "the token is missing or wrong; open the address that was printed, with all behind its #"
        return ""


def _bound(host: str, port: int) -> socket.socket:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        return socket.create_server((host, port), family=family)
    except OSError as error:
        raise UserError(
            f"{host}:{port} cannot be listened on: {error.strerror or error}; "
            "choose another --port, or 0 for a free one"
        ) from None


def _assets() -> dict[str, tuple[bytes, str]]:
    folder = files("explore_bt.debug.web") / "assets"
    return {
        each.name: (each.read_bytes(), _TYPES["." + each.name.rpartition(".")[2]])
        for each in folder.iterdir()
        if each.is_file()
    }
