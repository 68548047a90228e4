from __future__ import annotations

import os
import signal

import pytest

from explore_bt.cli.stopping import stopping_by_signal
from explore_bt.runtime.stop_flag import StopFlag


@pytest.mark.parametrize(("number", "name"), [(signal.SIGINT, "Ctrl-C"), (signal.SIGTERM, "SIGTERM")])
def test_a_signal_raises_the_flag_and_says_so(capfd, number, name):
    stop = StopFlag()
    with stopping_by_signal(stop):
        os.kill(os.getpid(), number)
        assert stop.reason == f"stopped by hand ({name})"
    assert capfd.readouterr().err == "\nstopping: the robot brakes, then the results are saved\n"


def test_a_second_ctrl_c_tells_that_it_is_stopping(capfd):
    with stopping_by_signal(StopFlag()):
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
    assert capfd.readouterr().err.splitlines()[-1] == (
        "still stopping; Ctrl-\\ ends the program at once and loses what is not saved yet"
    )


def test_the_handlers_of_before_are_back_afterwards():
    before = signal.getsignal(signal.SIGINT)
    with stopping_by_signal(StopFlag()):
        assert signal.getsignal(signal.SIGINT) is not before
    assert signal.getsignal(signal.SIGINT) is before
