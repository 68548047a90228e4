from __future__ import annotations

import pytest

from tests.report.flat_drive import make_drive


@pytest.fixture(scope="session")
def flat_drive(tmp_path_factory):
    """Two minutes through the flat with one robot."""
    return make_drive(tmp_path_factory.mktemp("flat"))


@pytest.fixture(scope="session")
def pair_drive(tmp_path_factory):
    """The same with two robots, faster."""
    return make_drive(tmp_path_factory.mktemp("pair"), speed_mps=0.8, robots=("anna", "bert <b>"))
