"""Real ROS 2: every worker has a domain of its own, every test closes what it opens."""

from __future__ import annotations

import os
from collections.abc import Iterator

import pytest

_FIRST_DOMAIN = 60


@pytest.fixture(scope="session", autouse=True)
def domain() -> Iterator[int]:
    """The ROS domain of this worker, in the environment of the processes it starts."""
    number = _FIRST_DOMAIN + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
    before = os.environ.get("ROS_DOMAIN_ID")
    os.environ["ROS_DOMAIN_ID"] = str(number)
    yield number
    if before is None:
        del os.environ["ROS_DOMAIN_ID"]
    else:
        os.environ["ROS_DOMAIN_ID"] = before
