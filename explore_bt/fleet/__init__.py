"""Several robots in one mission: what they tell one another, and the map they have together."""

from explore_bt.fleet.alone import Alone
from explore_bt.fleet.clocks import Clocks, WordAges
from explore_bt.fleet.doubts import Unseen, quarrel
from explore_bt.fleet.frames import SAME, Frames
from explore_bt.fleet.graph_messages import Fits
from explore_bt.fleet.graph_teller import GraphTeller
from explore_bt.fleet.link import TeamLink
from explore_bt.fleet.messages import MESSAGE_VERSION, MessageError, Presence, Tile, decode, encode
from explore_bt.fleet.roster import Roster
from explore_bt.fleet.team_map import TeamMap, merged_map
from explore_bt.fleet.tiles import TILE_CELLS, TileCutter

__all__ = [
    "MESSAGE_VERSION",
    "SAME",
    "TILE_CELLS",
    "Alone",
    "Clocks",
    "Fits",
    "Frames",
    "GraphTeller",
    "MessageError",
    "Presence",
    "Roster",
    "TeamLink",
    "TeamMap",
    "Tile",
    "TileCutter",
    "Unseen",
    "WordAges",
    "decode",
    "encode",
    "merged_map",
    "quarrel",
]
