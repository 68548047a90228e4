"""The log of a run: into its folder, and onto the screen if asked for."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

__all__ = ["run_log"]


class _FileInFolder(logging.FileHandler):
    """Writes once the folder is there: wrong input must leave no folder behind."""

    def emit(self, record: logging.LogRecord) -> None:
        if Path(self.baseFilename).parent.is_dir():
            super().emit(record)


@contextmanager
def run_log(file: Path, *, verbose: bool, goes_on: bool = False) -> Iterator[None]:
    """While inside, what ``explore_bt`` logs goes to ``file``; ``goes_on``: behind what is in it."""
    handlers: list[logging.Handler] = [_FileInFolder(file, mode="a" if goes_on else "w", delay=True)]
    if verbose:
        handlers.append(logging.StreamHandler())
    logger = logging.getLogger("explore_bt")
    level = logger.level
    logger.setLevel(logging.INFO)
    for handler in handlers:
        handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
        logger.addHandler(handler)
    try:
        yield
    finally:
        logger.setLevel(level)
        for handler in handlers:
            logger.removeHandler(handler)
            handler.close()
