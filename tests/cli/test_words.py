from __future__ import annotations

from pathlib import Path

import pytest

from explore_bt.cli.human import count, duration, percent
from explore_bt.cli.summary import summary_lines
from explore_bt.types import Outcome, Result


def result(**figures: object) -> Result:
    known: dict[str, object] = {
        "outcome": Outcome.EXPLORED,
        "reason": "nothing is left to see",
        "mission": "apartment",
        "coverage": 0.9888,
        "contacts": 0,
        "ate_rmse_m": 0.02,
        "path_length_m": 61.34,
        "mission_time_s": 232.0,
        "wall_time_s": 41.0,
        "min_clearance_m": 0.312,
        "mean_clearance_m": 0.6,
        "distance_to_home_m": 0.041,
        "seed": 0,
        "mission_sha256": "",
        "version": "0.1.0",
    }
    return Result(**{**known, **figures})  # type: ignore[arg-type]  # a table of fields


@pytest.mark.parametrize(
    ("seconds", "said"),
    [(0.2, "0 s"), (59.4, "59 s"), (59.6, "1 min 00 s"), (232, "3 min 52 s"), (3900, "1 h 05 min")],
)
def test_times_are_human(seconds, said):
    assert duration(seconds) == said


@pytest.mark.parametrize(
    ("share", "said"), [(0.0, "0.0 %"), (0.9888, "98.9 %"), (0.99999, "99.9 %"), (1.0, "100 %")]
)
def test_a_hundred_percent_means_all_of_it(share, said):
    assert percent(share) == said


def test_counts_have_a_plural():
    assert [count(n, "contact") for n in (0, 1, 2)] == ["0 contacts", "1 contact", "2 contacts"]


def test_the_summary_says_how_it_ended_and_where_the_files_are(tmp_path):
    for name in ("map.yaml", "report.html", "recording.mcap"):
        (tmp_path / name).touch()
    assert summary_lines(result(), tmp_path) == [
        (
            "explored",
            "98.9 % of the reachable floor · 61.3 m · 3 min 52 s · 0 contacts · closest 0.31 m · "
            "home within 4 cm",
        ),
        ("reason", "nothing is left to see"),
        ("map", str(tmp_path / "map.yaml")),
        ("report", str(tmp_path / "report.html")),
        ("recording", str(tmp_path / "recording.mcap")),
        ("replay", f"explore-bt replay {tmp_path}"),
    ]


@pytest.mark.parametrize(("touches", "said"), [(None, False), (0, False), (2, True)])
def test_the_summary_tells_touches_by_people_if_there_were_any(tmp_path, touches, said):
    figures = summary_lines(result(touched_by_people=touches), tmp_path)[0][1]
    assert (" · 0 contacts · touched by people: 2 · " in figures) == said


def test_the_summary_leaves_out_what_nobody_knows(tmp_path):
    unknown = result(
        outcome=Outcome.BUDGET,
        reason="the time budget of 60 s is spent",
        coverage=None,
        contacts=None,
        min_clearance_m=None,
        distance_to_home_m=3.14,
        left_open=("the room behind the glass door",),
    )
    assert summary_lines(unknown, tmp_path) == [
        ("budget", "61.3 m · 3 min 52 s · 3.1 m from home"),
        ("reason", "the time budget of 60 s is spent"),
        ("left open", "the room behind the glass door"),
    ]


def test_the_summary_lists_three_places_left_open_and_counts_the_rest(tmp_path):
    lines = summary_lines(result(left_open=("a", "b", "c", "d", "e")), tmp_path)
    left = [text for label, text in lines if label == "left open"]
    assert left == ["a", "b", "c", "and 2 more, see result.json"]


def test_the_summary_finds_the_files_of_several_robots(tmp_path):
    for robot in ("anna", "berta"):
        (tmp_path / robot).mkdir()
        (tmp_path / robot / "map.yaml").touch()
    paths = [Path(text) for label, text in summary_lines(result(), tmp_path) if label == "map"]
    assert paths == [tmp_path / "anna" / "map.yaml", tmp_path / "berta" / "map.yaml"]
