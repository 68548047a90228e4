"""The page as a browser shows it."""

from __future__ import annotations

import json
from typing import Any

DESK = {"width": 1280, "height": 800}
PATIENCE_MS = 60_000


class Seen:
    """A page that must not complain."""

    def __init__(self, browser: Any, url: str, size: dict[str, int], **options: Any) -> None:
        self.context = browser.new_context(viewport=size, **options)
        self.page = self.context.new_page()
        self.page.set_default_timeout(PATIENCE_MS)
        self.complaints: list[str] = []
        self.page.on("console", self._hear)
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.goto(url)
        self.until("page.player && page.story.count > 0")
        self.settle()

    def _hear(self, message: Any) -> None:
        ours = "willReadFrequently" in message.text  # it is the test that reads the canvas
        if message.type in ("error", "warning") and not ours:
            self.complaints.append(message.text)

    def run(self, script: str) -> Any:
        return self.page.evaluate(script)

    def until(self, condition: str) -> None:
        """Until something holds in the page; not by ``wait_for_function``, which its CSP forbids."""
        never = json.dumps(f"never: {condition}")
        self.run(
            f"new Promise((done, fail) => {{ const end = performance.now() + {PATIENCE_MS};"
            f" const look = () => {{ if ({condition}) done(); else if (performance.now() < end)"
            f" setTimeout(look, 20); else fail(new Error({never})); }}; look(); }})"
        )

    def settle(self) -> None:
        """Until what was asked for has come and is drawn."""
        self.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def seek(self, time_s: float) -> None:
        self.run(f"page.seek({time_s})")
        self.until(f"Math.abs(page.player.time - {time_s}) < 1e-6")
        self.settle()

    def key(self, *keys: str) -> None:
        for key in keys:
            self.page.keyboard.press(key)

    def held(self, robot: str) -> dict[str, Any]:
        """What the page holds of a robot."""
        state = f"page.player.state.robots.get({json.dumps(robot)})"
        return self.run(
            f"(() => {{ const {{ tick, nodes, board, visited, newest }} = {state};"
            " return JSON.parse(JSON.stringify({ tick, nodes, board, visited, newest },"
            " (_, value) => value === Infinity ? 'inf' : value)); })()"
        )

    def rows(self) -> list[tuple[str, str, str]]:
        """Name, status and words of every row of the tree, as they stand there."""
        return [
            tuple(row)
            for row in self.run(
                "[...document.querySelectorAll('#tree .row')].map((row) => ["
                " row.querySelector('.name').textContent, row.querySelector('.glyph').classList.item(2),"
                " row.querySelector('.words').textContent])"
            )
        ]

    def pixels(self, spots: list[tuple[float, float]]) -> list[list[int]]:
        """The colours on the map at places, of the screen's pixels there."""
        return self.run(
            "(() => { const canvas = document.getElementById('map'), { width, height } = canvas;"
            " const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);"
            f" return {json.dumps(spots)}.map(([x, y]) => page.map.toScreen(x, y).map((each) =>"
            " Math.round(each * devicePixelRatio))).map(([x, y]) => 4 * (y * width + x))"
            ".map((begin) => [...data.slice(begin, begin + 3)]); })()"
        )

    def shade(self, name: str) -> list[int]:
        """A colour of the page's palette."""
        style = "getComputedStyle(document.documentElement)"
        colour = self.run(f"{style}.getPropertyValue('--{name}')").strip()
        return [int(colour[i : i + 2], 16) for i in (1, 3, 5)]

    def close(self) -> None:
        self.context.close()
        assert self.complaints == []
