"""People in simulated worlds: which ways they walk, and where they are at a time."""

from explore_bt_drivers.people.crowd import Crowd
from explore_bt_drivers.people.town import Town
from explore_bt_drivers.people.walks import Walk, there_and_back

__all__ = ["Crowd", "Town", "Walk", "there_and_back"]
