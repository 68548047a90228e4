from __future__ import annotations

import pytest

from explore_bt.recording import McapRecorder
from tests.report.flat_drive import make_drive


@pytest.fixture(scope="session")
def recorded_drive(tmp_path_factory):
    """Ten minutes through the flat, recorded."""
    drive = make_drive(tmp_path_factory.mktemp("ten_minutes"), speed_mps=0.0897)
    drive.show_to(McapRecorder(McapRecorder.Options()))
    return drive
