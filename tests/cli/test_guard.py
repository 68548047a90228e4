from __future__ import annotations

import re
import tempfile
from pathlib import Path

import pytest
import typer
from typer.testing import CliRunner

from explore_bt.cli.guard import Crash, guarded
from explore_bt.errors import WorldError


def ended(command) -> tuple[int, str]:
    app = typer.Typer()
    app.command()(guarded(command))
    shown = CliRunner().invoke(app, [])
    return shown.exit_code, shown.stderr


def test_wrong_input_is_one_message_and_exit_code_2():
    def command() -> None:
        raise WorldError("worlds/flat.yaml: no free space")

    assert ended(command) == (2, "worlds/flat.yaml: no free space\n")


def test_our_own_fault_is_an_apology_with_the_log_in_a_temporary_folder(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))

    def command() -> None:
        raise ZeroDivisionError("division by zero")

    code, said = ended(command)
    assert code == 1
    assert "Traceback" not in said
    assert said.startswith("Sorry, explore-bt itself failed (ZeroDivisionError: division by zero).\n")
    log = Path(re.search(r"with (.*crash\.log)", said)[1])
    assert log.is_relative_to(tmp_path)
    assert "ZeroDivisionError: division by zero" in log.read_text()
    assert log.read_text().startswith("explore-bt ")


@pytest.mark.parametrize("exists", [True, False])
def test_a_crash_while_driving_is_logged_beside_the_run_if_there_is_one(tmp_path, monkeypatch, exists):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    folder = tmp_path / "runs" / "first"
    if exists:
        folder.mkdir(parents=True)

    def command() -> None:
        raise Crash(folder) from KeyError("goal")

    code, said = ended(command)
    assert code == 1
    assert folder.exists() == exists
    assert (str(folder / "crash.log") in said) == exists


def test_a_keyboard_interrupt_is_130_without_a_word():
    def command() -> None:
        raise KeyboardInterrupt

    assert ended(command) == (130, "")


def test_an_exit_code_passes():
    def command() -> None:
        raise typer.Exit(1)

    assert ended(command) == (1, "")
