"""A client of yaml-language-server over stdio, as an editor is one."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping
from pathlib import Path
from typing import Any

__all__ = ["LanguageClient"]


class LanguageClient:
    """Opens documents and waits for what the server has to say about them."""

    def __init__(self, command: list[str], schema: Path) -> None:
        self._server = subprocess.Popen([*command, "--stdio"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._settings = {
            "yaml": {
                "schemas": {schema.as_uri(): ["*.yaml"]},
                "schemaStore": {"enable": False},
                "validate": True,
                "yamlVersion": "1.2",
            }
        }
        self._number = 0
        self._said: dict[str, list[dict[str, Any]]] = {}
        capabilities = {"workspace": {"configuration": True, "didChangeConfiguration": {}}}
        self._ask("initialize", {"processId": None, "rootUri": None, "capabilities": capabilities})
        self._tell("initialized", {})
        self._tell("workspace/didChangeConfiguration", {"settings": self._settings})

    def complaints(self, texts: Mapping[Path, str]) -> dict[Path, list[tuple[int, str]]]:
        """Line (from 1) and message of everything that is wrong in each text."""
        for path, text in texts.items():
            document = {"uri": path.as_uri(), "languageId": "yaml", "version": 1, "text": text}
            self._tell("textDocument/didOpen", {"textDocument": document})
        while any(path.as_uri() not in self._said for path in texts):
            self._take(self._receive())
        return {
            path: [
                (each["range"]["start"]["line"] + 1, each["message"]) for each in self._said[path.as_uri()]
            ]
            for path in texts
        }

    def close(self) -> None:
        self._server.kill()
        self._server.communicate()

    def _ask(self, method: str, params: object) -> Any:
        self._number += 1
        self._send({"id": self._number, "method": method, "params": params})
        while True:
            message = self._receive()
            if message.get("id") == self._number and "method" not in message:
                return message["result"]
            self._take(message)

    def _tell(self, method: str, params: object) -> None:
        self._send({"method": method, "params": params})

    def _take(self, message: dict[str, Any]) -> None:
        if message.get("method") == "textDocument/publishDiagnostics":
            self._said[message["params"]["uri"]] = message["params"]["diagnostics"]
        elif "id" in message and "method" in message:  # the server asks
            answer: Any = None
            if message["method"] == "workspace/configuration":
                sections = [item.get("section") for item in message["params"]["items"]]
                answer = [self._settings.get(section) for section in sections]
            self._send({"id": message["id"], "result": answer})

    def _send(self, message: dict[str, Any]) -> None:
        body = json.dumps({"jsonrpc": "2.0", **message}).encode()
        assert self._server.stdin is not None
        self._server.stdin.write(b"Content-Length: %d\r\n\r\n" % len(body) + body)
        self._server.stdin.flush()

    def _receive(self) -> dict[str, Any]:
        assert self._server.stdout is not None
        length = 0
        while (line := self._server.stdout.readline()) not in (b"\r\n", b""):
            name, _, value = line.partition(b":")
            length = int(value) if name.lower() == b"content-length" else length
        if not line:
            raise EOFError("yaml-language-server ended")
        found: dict[str, Any] = json.loads(self._server.stdout.read(length))
        return found
