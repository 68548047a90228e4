"""Real ROS 2: every worker has a domain of its own, every test closes what it opens."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

_DOMAINS = range(40, 102)
"""Beyond 101 the middleware's ports meet those that Linux gives to anybody."""


@pytest.fixture(scope="session", autouse=True)
def domain() -> Iterator[int]:
    """The ROS domain of this worker, in the environment of the processes it starts."""
    before = os.environ.get("ROS_DOMAIN_ID")
    with _domain_of_nobody() as number:
        os.environ["ROS_DOMAIN_ID"] = str(number)
        yield number
    if before is None:
        del os.environ["ROS_DOMAIN_ID"]
    else:
        os.environ["ROS_DOMAIN_ID"] = before


@contextmanager
def _domain_of_nobody() -> Iterator[int]:
    """One that no other worker on this machine has: those of another checkout would drive our robots."""
    for number in _DOMAINS:
        path = Path(tempfile.gettempdir()) / f"explore-bt-tests-ros-domain-{number}"
        with path.open("a") as held:
            try:
                fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            yield number
            return
    raise AssertionError("every ROS domain is held by another run of these tests")
