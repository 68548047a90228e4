"""A floor plan as a world file (``format: explore-bt-world/1``)."""

from __future__ import annotations

from explore_bt.worlds.plan import WALL_M, Door, FloorPlan, Piece, Space

__all__ = ["world_text"]


def world_text(plan: FloorPlan, remark: str) -> str:
    """The file's text; ``remark`` tells how it was made.

    Args:
        plan: complete, with a start.
        remark: one line.
    """
    o = plan.outline
    corners = [(o.x0, o.y0), (o.x1, o.y0), (o.x1, o.y1), (o.x0, o.y1)]
    path = ", ".join(f"[{_m(x)}, {_m(y)}]" for x, y in corners)
    lines = [f"# {remark}", "format: explore-bt-world/1", f"name: {plan.name}"]
    if plan.start is not None:
        x, y, degrees = plan.start
        lines.append(f"start: [{_m(x)}, {_m(y)}, {degrees:g} deg]")
    lines += [f"wall: {{thickness: {100 * WALL_M:g} cm, height: 2.5 m}}", "", "rooms:"]
    lines += [_room(space) for space in plan.spaces if space.walled]
    lines += ["", "walls:", f"  - {{name: outer wall, path: [{path}], closed: true}}", "", "doors:"]
    lines += [_door(door) for door in plan.doors]
    if plan.pieces:
        lines += ["", "furniture:", *(_piece(piece) for piece in plan.pieces)]
    return "\n".join(lines) + "\n"


def _room(space: Space) -> str:
    b = space.box
    return f"  - {{name: {space.name}, box: [{_m(b.x0)}, {_m(b.y0)}, {_m(b.x1)}, {_m(b.y1)}]}}"


def _door(door: Door) -> str:
    return f"  - {{name: {door.name}, at: [{_m(door.x)}, {_m(door.y)}], width: {_m(door.width_m)}}}"


def _piece(piece: Piece) -> str:
    if piece.shape == "polygon":
        xy = piece.numbers
        shape = ", ".join(f"[{_m(x)}, {_m(y)}]" for x, y in zip(xy[::2], xy[1::2], strict=True))
    else:
        shape = ", ".join(_m(value) for value in piece.numbers)
    extras = f", legs: {100 * piece.legs_m:g} cm" if piece.legs_m else ""
    return f"  - {{name: {piece.name}, {piece.shape}: [{shape}]{extras}, height: {_m(piece.height_m)}}}"


def _m(value: float) -> str:
    return f"{round(value, 3) + 0.0:g}"
