"""What does not stay as it was drawn: ``shut`` of a door, ``moved`` of furniture."""

from __future__ import annotations

import yaml

from explore_bt.maps import MarkedFile
from explore_bt.types import Pose2
from explore_bt.units import DURATION
from explore_bt_drivers.world.piece import Piece
from explore_bt_drivers.world.plan import Stand, Thing
from explore_bt_drivers.world.solid import Solid

__all__ = ["read_moved", "read_shut"]

Bounds = tuple[float, float, float, float]
"""x0, y0, x1, y1 in metres."""


def read_shut(file: MarkedFile, node: yaml.Node | None, leaf: Solid) -> list[Thing]:
    """``shut: [[begin, end], ...]``: between these times the leaf fills its opening.

    Returns:
        The leaf as the one thing that changes; nothing where the door is never shut.
    """
    stands = [Stand(0.0, ())]
    last_s = 0.0
    for item in file.items(node, "shut"):
        span = file.durations(item, "begin end")
        if span is None:
            continue
        begin_s, end_s = span
        if not last_s <= begin_s < end_s:
            file.fault(
                item,
                f"{leaf.name} is shut from {begin_s:g} s to {end_s:g} s; expected begin < end, and no begin "
                f"before {last_s:g} s: put the spans in order",
            )
            continue
        last_s = end_s
        stands += [Stand(begin_s, (leaf,)), Stand(end_s, ())]
    return [Thing(leaf.name, tuple(stands))] if len(stands) > 1 else []


def read_moved(file: MarkedFile, node: yaml.Node | None, piece: Piece, bounds: Bounds | None) -> list[Thing]:
    """``moved: [{at: time, to: [x, y] or [x, y, turn]}, ...]``: then its middle stands there.

    The middle is that of the box round all of it; the turn is about the middle and counts from the drawing.

    Returns:
        The furniture as the one thing that changes; nothing where it is never moved.
    """
    stands = [Stand(0.0, piece.solids, piece.overhangs)]
    for item in file.items(node, "moved"):
        stand = _read_move(file, item, piece, bounds)
        if stand is None:
            continue
        if len(stands) > 1 and stand.begin_s <= stands[-1].begin_s:
            times = f"at {stand.begin_s:g} s, the move before it at {stands[-1].begin_s:g} s"
            file.fault(item, f"{piece.name} is moved {times}; put the moves in order")
            continue
        stands.append(stand)
    return [Thing(piece.name, tuple(stands))] if len(stands) > 1 else []


def _read_move(file: MarkedFile, node: yaml.Node, piece: Piece, bounds: Bounds | None) -> Stand | None:
    keys = file.fields(node, "a move", required=("at", "to"))
    at_s = file.quantity(keys.get("at"), DURATION, "at", low=0.0)
    to = _read_place(file, keys.get("to"))
    if at_s is None or to is None or not piece.parts:
        return None
    moved = piece.moved(to)
    corners = moved.corners
    if bounds is not None and ((corners < bounds[:2]) | (corners > bounds[2:])).any():
        x0, y0, x1, y1 = bounds
        reach = f"which reaches from [{x0:g}, {y0:g}] to [{x1:g}, {y1:g}]"
        file.fault(keys["to"], f"{piece.name} would stand outside the world, {reach}; move it further in")
        return None
    return Stand(at_s, moved.solids, moved.overhangs)


def _read_place(file: MarkedFile, node: yaml.Node | None) -> Pose2 | None:
    if isinstance(node, yaml.SequenceNode) and len(node.value) == 2:
        xy = file.lengths(node, "x y")
        return None if xy is None else Pose2(xy[0], xy[1], 0.0)
    pose = None if node is None else file.pose(node, "turn")
    return None if pose is None else Pose2(*pose)
