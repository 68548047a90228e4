from explore_bt_controllers import Mppi, Pursuit

from explore_bt.interfaces import Controller
from explore_bt.testing.controller_contract import ControllerContract


class TestPursuitContract(ControllerContract):
    def make(self) -> Controller:
        return Pursuit(Pursuit.Options())


class TestMppiContract(ControllerContract):
    def make(self) -> Controller:
        return Mppi(Mppi.Options())
