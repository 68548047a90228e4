from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from explore_bt.checkpoint import Checkpoint, CheckpointError, CheckpointStore


def write(store: CheckpointStore, tick: int, before: Checkpoint | None = None) -> Checkpoint:
    draft = store.begin(tick, before)
    draft.write("run.json", f'{{"tick":{tick}}}')
    draft.write("robot/memory.json", "[]")
    (draft.folder / "robot" / "slam").mkdir()
    (draft.folder / "robot" / "slam" / "cells").write_bytes(bytes(range(256)) * tick)
    return draft.commit()


@pytest.fixture
def store(tmp_path: Path) -> CheckpointStore:
    return CheckpointStore(tmp_path / "checkpoint")


def test_the_newest_of_the_last_two_is_found(store: CheckpointStore) -> None:
    for tick in (1, 2, 3, 12):
        write(store, tick)
    checkpoint, faults = store.newest()
    assert (checkpoint.tick, faults) == (12, [])
    assert checkpoint.read("run.json") == b'{"tick":12}'
    assert sorted(each.name for each in store.folder.iterdir()) == ["000000003", "000000012"]


def test_a_draft_is_nothing_before_it_is_committed(store: CheckpointStore) -> None:
    write(store, 1)
    store.begin(2).write("run.json", "{}")
    assert store.newest()[0].tick == 1
    assert CheckpointStore(store.folder).newest()[0].tick == 1
    write(store, 3)
    assert not list(store.folder.glob(".unfinished*"))


def test_without_any_checkpoint_that_is_said(store: CheckpointStore) -> None:
    with pytest.raises(CheckpointError, match="no checkpoint was ever written"):
        store.newest()


@given(st.data())
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_whatever_is_damaged_the_one_before_is_found(store: CheckpointStore, data: st.DataObject) -> None:
    shutil.rmtree(store.folder, ignore_errors=True)
    write(store, 1)
    newest = write(store, 2)
    file = data.draw(st.sampled_from(sorted(each for each in newest.folder.rglob("*") if each.is_file())))
    content = file.read_bytes()
    place = data.draw(st.integers(0, len(content) - 1))
    if data.draw(st.booleans()):
        file.write_bytes(content[:place])
    else:
        flipped = content[place] ^ data.draw(st.integers(1, 255))
        file.write_bytes(content[:place] + bytes([flipped]) + content[place + 1 :])
    checkpoint, faults = store.newest()
    assert checkpoint.tick == 1
    assert len(faults) == 1
    assert str(newest.folder) in faults[0]


def test_a_foreign_and_a_missing_file_are_named(store: CheckpointStore) -> None:
    write(store, 1)
    newest = write(store, 2)
    (newest.folder / "notes.txt").write_text("mine")
    assert "notes.txt does not belong to it" in store.newest()[1][0]
    (newest.folder / "notes.txt").unlink()
    (newest.folder / "run.json").unlink()
    assert "run.json is missing" in store.newest()[1][0]


def test_where_none_is_whole_each_fault_is_named(store: CheckpointStore) -> None:
    for tick in (1, 2):
        (write(store, tick).folder / "manifest.json").write_text("{}")
    with pytest.raises(CheckpointError, match=r"000000002.*not of the format.*000000001"):
        store.newest()


def test_a_linked_file_is_checked_as_any_other(store: CheckpointStore) -> None:
    write(store, 1)
    draft = store.begin(3, write(store, 2))
    before = draft.before("robot/slam")
    assert before is not None
    (draft.folder / "cells").hardlink_to(before / "cells")
    third = draft.commit()
    assert store.newest() == (third, [])
    (third.folder / "cells").write_bytes(b"other")
    with pytest.raises(CheckpointError, match=r"cells is damaged.*cells is damaged"):
        store.newest()  # one file under two names


def test_two_processes_cannot_work_on_one_run(store: CheckpointStore) -> None:
    with (
        store.locked(),
        pytest.raises(CheckpointError, match="another process is at work"),
        CheckpointStore(store.folder).locked(),
    ):
        pass
    with CheckpointStore(store.folder).locked():
        pass
