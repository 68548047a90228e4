"""Several robots in one mission: what they tell one another, and the map they have together."""

from explore_bt.fleet.alone import Alone
from explore_bt.fleet.clocks import Clocks, WordAges
from explore_bt.fleet.link import TeamLink
from explore_bt.fleet.messages import MESSAGE_VERSION, MessageError, Presence, Tile, decode, encode
from explore_bt.fleet.roster import Roster
from explore_bt.fleet.team_map import TeamMap, merged_map
from explore_bt.fleet.tiles import TILE_CELLS, TileCutter

__all__ = [
    "MESSAGE_VERSION",
    "TILE_CELLS",
    "Alone",
    "Clocks",
    "MessageError",
    "Presence",
    "Roster",
    "TeamLink",
    "TeamMap",
    "Tile",
    "TileCutter",
    "WordAges",
    "decode",
    "encode",
    "merged_map",
]
