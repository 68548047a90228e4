"""Worlds for simulated robots: files, geometry, what can be reached and seen."""

from explore_bt_drivers.world.observable import SPARE_M, fitting_cells, observable_floor
from explore_bt_drivers.world.plan import Person, Stand, Thing, WorldPlan
from explore_bt_drivers.world.ramps import Ramp
from explore_bt_drivers.world.scenery import Scenery
from explore_bt_drivers.world.solid import Material, Solid
from explore_bt_drivers.world.start import Taken, choose_start, stand_of
from explore_bt_drivers.world.versions import with_every_stand, with_solids
from explore_bt_drivers.world.world import World, load_world
from explore_bt_drivers.world.world_file import FORMAT, read_world_file

__all__ = [
    "FORMAT",
    "SPARE_M",
    "Material",
    "Person",
    "Ramp",
    "Scenery",
    "Solid",
    "Stand",
    "Taken",
    "Thing",
    "World",
    "WorldPlan",
    "choose_start",
    "fitting_cells",
    "load_world",
    "observable_floor",
    "read_world_file",
    "stand_of",
    "with_every_stand",
    "with_solids",
]
