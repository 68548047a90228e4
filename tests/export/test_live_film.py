from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

from explore_bt.cli import app
from explore_bt.export.video import LiveFilm, Mp4Writer
from explore_bt.interfaces import Filming
from explore_bt.runtime import Attendant, Attendants

MISSION = Path(__file__).parents[2] / "missions" / "01_apartment.yaml"


class Shades(Filming):
    """A picture that gets lighter from one to the next; raises at the ``breaks``-th."""

    def __init__(self, size: tuple[int, int], breaks: int = 1000) -> None:
        self.size, self.breaks = size, breaks
        self.taken = 0
        self.is_closed = False

    def frame(self) -> Any:
        self.taken += 1
        if self.taken == self.breaks:
            raise RuntimeError("the lens is broken")
        return np.full((self.size[1], self.size[0], 3), 10 * self.taken, dtype=np.uint8)

    def close(self) -> None:
        self.is_closed = True


def filmed(path: Path, seconds: float, breaks: int = 1000) -> Shades:
    """A run of so many seconds with a tree at 10 Hz."""
    shades: list[Shades] = []

    def filming(size: tuple[int, int]) -> Shades:
        shades.append(Shades(size, breaks))
        return shades[0]

    runner: Any = SimpleNamespace(
        robots=[SimpleNamespace(driver=SimpleNamespace(filming=filming))], now_s=0.0
    )
    film = LiveFilm(path)
    film.begin(runner)
    for tick in range(round(10 * seconds) + 1):
        runner.now_s = tick / 10
        film.on_period()
    film.end()
    film.end()
    return shades[0]


def frames_of(path: Path) -> list[np.ndarray]:
    capture, frames = cv2.VideoCapture(str(path)), []
    while (found := capture.read())[0]:
        frames.append(found[1])
    return frames


def test_a_film_has_a_picture_for_every_four_tenths_of_a_second(tmp_path: Path) -> None:
    shades = filmed(tmp_path / "films" / "run.mp4", 4.0)
    frames = frames_of(tmp_path / "films" / "run.mp4")
    assert len(frames) == shades.taken == 11
    assert frames[0].shape == (540, 960, 3)
    greys = [float(frame.mean()) for frame in frames]
    assert np.diff(greys) == pytest.approx([10.0] * 10, abs=2.5)
    assert shades.is_closed


def test_a_camera_that_breaks_costs_the_film_and_not_the_run(tmp_path: Path) -> None:
    shades = filmed(tmp_path / "run.mp4", 4.0, breaks=5)
    assert shades.taken == 5
    assert list(tmp_path.iterdir()) == []


def test_a_film_is_whole_or_not_there(tmp_path: Path) -> None:
    def film(pictures: int) -> None:
        with Mp4Writer(tmp_path / "run.mp4", 10.0, (64, 48)) as writer:
            for picture in range(3):
                writer.write(np.full((48, 64, 3), 255 // (pictures - picture), np.uint8))

    with pytest.raises(ZeroDivisionError):
        film(2)
    assert list(tmp_path.iterdir()) == []
    film(3)
    assert [path.name for path in tmp_path.iterdir()] == ["run.mp4"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        (
            "run.mp4",
            "--video films a world with looks, and sim2d has none; take driver mujoco",
        ),
        ("run.avi", "videos are MP4 files; write"),
    ],
)
def test_what_cannot_be_filmed_is_said_before_the_run(tmp_path: Path, name: str, words: str) -> None:
    told = CliRunner().invoke(
        app, ["run", str(MISSION), "--video", str(tmp_path / name), "--out", str(tmp_path / "out")]
    )
    assert told.exit_code == 2
    assert words in " ".join(told.output.split())
    assert list(tmp_path.iterdir()) == []


def test_all_attendants_are_asked_in_their_order_and_all_hear_the_end() -> None:
    heard: list[str] = []

    class Listener(Attendant):
        def __init__(self, name: str) -> None:
            self.name = name

        def on_period(self) -> None:
            heard.append(f"{self.name} period")

        def before_tick(self) -> None:
            heard.append(f"{self.name} tick")

        def end(self) -> None:
            heard.append(f"{self.name} end")
            raise ValueError(self.name)

    both = Attendants([Listener("a"), Listener("b")])
    both.on_period()
    both.before_tick()
    with pytest.raises(ValueError, match="b"):
        both.end()
    assert heard == ["a period", "b period", "a tick", "b tick", "a end", "b end"]
