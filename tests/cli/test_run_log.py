from __future__ import annotations

import logging

from explore_bt.cli.run_log import run_log


def test_the_log_lies_in_the_runs_folder(tmp_path):
    with run_log(tmp_path / "run.log", verbose=False):
        logging.getLogger("explore_bt.runtime").info("the gate brakes")
    assert (tmp_path / "run.log").read_text().endswith("INFO the gate brakes\n")


def test_no_line_no_file(tmp_path):
    with run_log(tmp_path / "run.log", verbose=False):
        pass
    assert list(tmp_path.iterdir()) == []


def test_without_a_folder_none_is_made(tmp_path):
    with run_log(tmp_path / "runs" / "run.log", verbose=False):
        logging.getLogger("explore_bt").warning("before the folder")
    assert list(tmp_path.iterdir()) == []


def test_verbose_shows_it_too(tmp_path, capsys):
    with run_log(tmp_path / "run.log", verbose=True):
        logging.getLogger("explore_bt").info("closed a loop")
    assert capsys.readouterr().err.endswith("INFO closed a loop\n")


def test_the_logger_is_left_as_it_was(tmp_path):
    logger = logging.getLogger("explore_bt")
    before = (logger.level, list(logger.handlers))
    with run_log(tmp_path / "run.log", verbose=True):
        pass
    assert (logger.level, logger.handlers) == before
