"""One page at the other end of a socket: asks and is answered, and hears how far the run is."""

from __future__ import annotations

import asyncio
import json
import logging
import time
from collections.abc import Awaitable, Callable
from functools import partial

from starlette.websockets import WebSocket, WebSocketDisconnect, WebSocketState

from explore_bt.debug.web.desk import Desk
from explore_bt.debug.web.requests import AskCommand, AskLook, read_request
from explore_bt.errors import UserError

__all__ = ["Client", "Share"]

_log = logging.getLogger("explore_bt")

NEWS_PERIOD_S = 0.1
PATIENCE_S = 20.0
_FAULTS_BEFORE_PARTING = 50


class Share:
    """Keeps the answering of all pages together below a share of one core, however much they ask.

    Answering takes time from the thread that ticks the trees. After work that took ``d`` seconds nothing
    is answered for ``d / share - d``.
    """

    def __init__(
        self,
        share: float,
        clock: Callable[[], float] = time.monotonic,
        sleep: Callable[[float], Awaitable[None]] = asyncio.sleep,
    ) -> None:
        self._rest = 1.0 / share - 1.0
        self._clock, self._sleep = clock, sleep
        self._turn = asyncio.Lock()
        self._free_s = 0.0

    async def spend(self, work: Callable[[], str]) -> str:
        """Do a piece of work when its turn has come."""
        async with self._turn:
            await self._sleep(max(0.0, self._free_s - self._clock()))
            began_s = self._clock()
            try:
                return work()
            finally:
                now_s = self._clock()
                self._free_s = now_s + self._rest * (now_s - began_s)


class Client:
    """Serves one socket until it closes.

    Nothing is queued for a client: it is sent an answer when it asks, and the newest news. While it does
    not read, its own task waits, and after 20 s it is parted with; nobody else notices.
    """

    def __init__(self, socket: WebSocket, desk: Desk, share: Share) -> None:
        self._socket = socket
        self._desk = desk
        self._share = share
        self._sending = asyncio.Lock()
        self._faults = 0

    async def serve(self) -> None:
        """Until either side has gone."""
        tasks = [asyncio.ensure_future(each) for each in (self._answer(), self._tell_news())]
        try:
            await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
        if self._socket.application_state is WebSocketState.CONNECTED:
            await self._close()

    async def _answer(self) -> None:
        while self._faults < _FAULTS_BEFORE_PARTING:
            try:
                message = await self._socket.receive_text()
            except (WebSocketDisconnect, KeyError):  # KeyError: bytes instead of text
                return
            await self._send(await self._answer_to(message))

    async def _answer_to(self, message: str) -> str:
        try:
            request = read_request(message)
        except ValueError:
            self._faults += 1
            return '{"id":null,"error":"not a request of this page"}'
        try:
            if isinstance(request, AskLook | AskCommand):
                answer = await self._desk.have_done(request)
            else:
                answer = partial(self._desk.answer, request)
            members = await self._share.spend(answer)
        except UserError as fault:
            return f'{{"id":{request.id},"error":{json.dumps(str(fault))}}}'
        except Exception as fault:  # of ours: it must not cost the page its socket
            _log.exception("the page's question %s was not answered", request.ask)
            words = f"explore-bt itself failed ({type(fault).__name__}); the log says where"
            return f'{{"id":{request.id},"error":{json.dumps(words)}}}'
        return f'{{"id":{request.id},{members}}}'

    async def _tell_news(self) -> None:
        told = ""
        while True:
            news = self._desk.news()
            if news != told:
                told = news
                await self._send(f'{{"news":{news}}}')
            await asyncio.sleep(NEWS_PERIOD_S)

    async def _send(self, text: str) -> None:
        async with self._sending, asyncio.timeout(PATIENCE_S):
            await self._socket.send_text(text)

    async def _close(self) -> None:
        try:
            async with asyncio.timeout(1.0):
                await self._socket.close(1008)
        except (TimeoutError, RuntimeError, OSError, WebSocketDisconnect):
            pass  # it has gone already
