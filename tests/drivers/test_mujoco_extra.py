"""Without its libraries the driver is left out, and nobody misses it."""

import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

from explore_bt.cli import app

MISSIONS = Path(__file__).parents[2] / "missions"


@pytest.fixture
def without_mujoco(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("importlib.util.find_spec", lambda module: None if module == "mujoco" else module)
    monkeypatch.delitem(sys.modules, "explore_bt_drivers.mujoco", raising=False)


def test_the_list_of_plugins_names_the_line_to_type(without_mujoco: None) -> None:
    told = CliRunner().invoke(app, ["plugins", "--kind", "driver"]).stdout
    assert 'type pip install "explore-bt[mujoco]"' in told
    assert "sim2d" in told


def test_a_mission_that_wants_it_is_refused_with_that_line(without_mujoco: None) -> None:
    refused = CliRunner().invoke(app, ["check", str(MISSIONS / "04_mujoco_flat.yaml")])
    assert refused.exit_code == 2
    assert "mujoco" in refused.stderr + refused.stdout
    assert 'pip install "explore-bt[mujoco]"' in " ".join((refused.stderr + refused.stdout).split())


def test_checking_a_mission_does_not_import_the_physics() -> None:
    code = (
        "import sys; from explore_bt.cli import app; from typer.testing import CliRunner; "
        f"found = CliRunner().invoke(app, ['check', {str(MISSIONS / '04_mujoco_flat.yaml')!r}]); "
        "assert found.exit_code == 0, found.output; assert 'mujoco' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
