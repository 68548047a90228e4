from __future__ import annotations

import os
import re
from pathlib import Path

import pytest

from explore_bt.cli.places import find_mission, new_run_folder, shipped_missions
from explore_bt.errors import UserError


def refusal(call, *arguments) -> str:
    with pytest.raises(UserError) as refused:
        call(*arguments)
    return str(refused.value)


def test_a_file_is_taken_as_it_is(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("format: explore-bt/1\n")
    assert find_mission(str(path)) == path


def test_a_shipped_mission_is_found_by_its_bare_name():
    assert find_mission("01_apartment").name == "01_apartment.yaml"
    assert find_mission("01_apartment").is_file()


def test_a_file_in_the_working_folder_comes_before_a_shipped_one(tmp_path, monkeypatch):
    (tmp_path / "01_apartment").write_text("format: explore-bt/1\n")
    monkeypatch.chdir(tmp_path)
    assert find_mission("01_apartment") == Path("01_apartment")


def test_an_unknown_mission_gets_a_suggestion_and_the_shipped_ones():
    assert refusal(find_mission, "apartment") == (
        'there is no mission apartment; did you mean "01_apartment"? '
        f"Shipped missions: {', '.join(shipped_missions())}"
    )


def test_a_folder_is_not_a_mission(tmp_path):
    assert refusal(find_mission, str(tmp_path)) == f"{tmp_path} is a folder; name a mission file in it"


def test_a_run_goes_into_a_folder_named_after_mission_and_time():
    folder = new_run_folder(None, "01_apartment")
    assert re.fullmatch(r"runs/01_apartment-\d{8}-\d{6}", str(folder))
    assert not folder.exists()


def test_two_runs_of_one_second_get_two_folders(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first = new_run_folder(None, "m")
    first.mkdir(parents=True)
    assert new_run_folder(None, "m") != first


def test_an_empty_folder_is_taken(tmp_path):
    assert new_run_folder(tmp_path, "m") == tmp_path


def test_a_folder_with_anything_in_it_is_refused(tmp_path):
    (tmp_path / "map.yaml").write_text("mine")
    assert refusal(new_run_folder, tmp_path, "m") == (
        f"{tmp_path} is not empty; nothing is ever overwritten, name a new folder with --out"
    )


def test_a_file_in_place_of_the_folder_is_refused(tmp_path):
    path = tmp_path / "out"
    path.write_text("mine")
    assert refusal(new_run_folder, path, "m") == f"{path} is a file; name a new folder with --out"


def test_a_file_above_the_folder_is_refused_before_anything_is_made_ready(tmp_path):
    path = tmp_path / "out"
    path.write_text("mine")
    assert refusal(new_run_folder, path / "a" / "b", "m") == (
        f"{path / 'a' / 'b'} cannot be made: {path} is a file; name another folder with --out"
    )


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_may_not_be_written_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    assert "you may not write into" in refusal(new_run_folder, tmp_path / "run", "m")
