"""What stands in which kind of room."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from explore_bt.worlds.furnishing import SIDES, Furnisher
from explore_bt.worlds.plan import Box, rounded

__all__ = ["furnish"]

_OPPOSITE = dict(zip(SIDES, ("north", "west", "south", "east"), strict=True))
_OUTWARD = dict(zip(SIDES, ((0, -1), (1, 0), (0, 1), (-1, 0)), strict=True))


def furnish(room: Furnisher, kind: str) -> None:
    """Furnish a space after its kind; what finds no place is left out."""
    recipe = _RECIPES.get(kind)
    if recipe is not None:
        recipe(room)


def _length(rng: np.random.Generator, low_m: float, high_m: float) -> float:
    return rounded(float(rng.uniform(low_m, high_m)))


def _in_front(box: Box, side: str, gap_m: float, along_m: float, deep_m: float) -> Box:
    """A box before the middle of one that stands at a wall."""
    out_x, out_y = _OUTWARD[side]
    mid_x, mid_y = (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2
    if out_x:
        edge = box.x0 - gap_m if out_x > 0 else box.x1 + gap_m
        x0, x1 = (edge - deep_m, edge) if out_x > 0 else (edge, edge + deep_m)
        return Box(x0, rounded(mid_y - along_m / 2), x1, rounded(mid_y - along_m / 2) + along_m)
    edge = box.y0 - gap_m if out_y > 0 else box.y1 + gap_m
    y0, y1 = (edge - deep_m, edge) if out_y > 0 else (edge, edge + deep_m)
    return Box(rounded(mid_x - along_m / 2), y0, rounded(mid_x - along_m / 2) + along_m, y1)


def _living(room: Furnisher) -> None:
    rng = room.rng
    sofa = room.against_wall("sofa", _length(rng, 1.8, 2.4), 0.9, 0.8)
    if sofa:
        box, side = sofa
        table = _in_front(box, side, 0.4, _length(rng, 0.8, 1.1), 0.5)
        room.put("coffee table", table, 0.45)
        room.against_wall(
            "television", _length(rng, 1.2, 1.8), 0.4, 1.1, [_OPPOSITE[side], *room.free_sides()]
        )
    if rng.random() < 0.7:
        room.against_wall("armchair", 0.8, 0.8, 0.8, corner=True)
    room.against_wall("bookshelf", _length(rng, 0.8, 1.6), 0.35, 2.0)
    if rng.random() < 0.5:
        room.against_wall("sideboard", _length(rng, 1.0, 1.6), 0.4, 0.8)
    if room.floor.width * room.floor.height > 20.0:
        _dining(room, int(rng.integers(2, 5)))
    room.in_corner("floor lamp", 0.15, 1.6)
    room.in_corner("plant", 0.2, 1.2)


def _dining(room: Furnisher, chairs: int) -> None:
    """A table on legs somewhere in the open, chairs at its long sides."""
    rng, f = room.rng, room.floor
    long_m, wide_m = _length(rng, 1.2, 1.6), 0.8
    for _ in range(20):
        along_x = rng.random() < 0.5
        w, h = (long_m, wide_m) if along_x else (wide_m, long_m)
        if f.width - w < 1.0 or f.height - h < 1.0:
            continue
        x = rounded(float(rng.uniform(f.x0 + 0.3, f.x1 - w - 0.3)))
        y = rounded(float(rng.uniform(f.y0 + 0.3, f.y1 - h - 0.3)))
        if not room.put("dining table", Box(x, y, x + w, y + h), 0.75, legs_m=0.06, gap_m=0.5):
            continue
        size, shares = 0.4, (0.25, 0.75)
        for number in range(chairs):
            share, far = shares[number // 2 % 2], number % 2 == 1
            if along_x:
                cx, cy = rounded(x + share * w - size / 2), (y + h + 0.05 if far else y - size - 0.05)
            else:
                cx, cy = (x + w + 0.05 if far else x - size - 0.05), rounded(y + share * h - size / 2)
            room.put("chair", Box(cx, cy, cx + size, cy + size), 0.9, legs_m=0.04)
        return


def _kitchen(room: Furnisher) -> None:
    rng, f = room.rng, room.floor
    if not _corner_worktop(room):
        longest = max(f.width, f.height)
        for length in (longest, 0.75 * longest, 0.5 * longest, 1.2):
            if room.against_wall("worktop", rounded(length), 0.6, 0.9):
                break
    room.against_wall("fridge", 0.65, 0.65, 1.8, corner=True)
    _dining(room, int(rng.integers(2, 5)))


def _corner_worktop(room: Furnisher) -> bool:
    """An L in a corner: one outline of two boxes."""
    f, deep = room.floor, 0.6
    for i in room.rng.permutation(4):
        sx, sy = (1, -1)[int(i) % 2], (1, -1)[int(i) // 2]
        cx, cy = (f.x0 if sx > 0 else f.x1), (f.y0 if sy > 0 else f.y1)
        a, b = (
            _length(room.rng, 1.8, max(f.width * 0.8, 1.9)),
            _length(room.rng, 1.4, max(f.height * 0.8, 1.5)),
        )
        outline = [(0.0, 0.0), (a, 0.0), (a, deep), (deep, deep), (deep, b), (0.0, b)]
        xy = [(round(cx + sx * u, 3), round(cy + sy * v, 3)) for u, v in outline]
        parts = []
        for u0, v0, u1, v1 in ((0.0, 0.0, a, deep), (0.0, deep, deep, b)):
            xs, ys = sorted((cx + sx * u0, cx + sx * u1)), sorted((cy + sy * v0, cy + sy * v1))
            parts.append(Box(xs[0], ys[0], xs[1], ys[1]))
        if room.put_polygon("worktop", xy, parts, 0.9):
            return True
    return False


def _bedroom(room: Furnisher) -> None:
    rng = room.rng
    wide = float(rng.choice([0.9, 1.4, 1.6, 1.8]))
    bed = None
    for width in (wide, 1.4, 0.9):
        bed = bed or room.against_wall("bed", width, 2.05, 0.5)
    if bed:
        box, side = bed
        for before in (True, False):
            _beside(room, "bedside table", box, side, before, 0.4)
    room.against_wall("wardrobe", _length(rng, 1.2, 2.0), 0.6, 2.2)
    if rng.random() < 0.6:
        _desk(room, "desk", 1.2, 0.6)
    if rng.random() < 0.4:
        room.against_wall("chest of drawers", 0.8, 0.45, 0.9)


def _beside(room: Furnisher, name: str, box: Box, side: str, before: bool, size: float) -> None:
    """Something at the wall on one side of a piece that stands at it."""
    if side in ("south", "north"):
        x = box.x0 - size if before else box.x1
        y = box.y0 if side == "south" else box.y1 - size
    else:
        y = box.y0 - size if before else box.y1
        x = box.x0 if side == "west" else box.x1 - size
    room.put(name, Box(x, y, x + size, y + size), 0.5)


def _desk(room: Furnisher, name: str, along_m: float, deep_m: float) -> None:
    """A desk on legs at a wall, with its chair."""
    desk = room.against_wall(name, along_m, deep_m, 0.75, legs_m=0.05)
    if desk:
        seat = _in_front(desk[0], desk[1], 0.1, 0.5, 0.5)
        room.put_round("desk chair", (seat.x0 + seat.x1) / 2, (seat.y0 + seat.y1) / 2, 0.25, 0.9)


def _bathroom(room: Furnisher) -> None:
    rng = room.rng
    if rng.random() < 0.5 or not room.against_wall("bathtub", 1.7, 0.75, 0.6, corner=True):
        room.against_wall("shower", 0.9, 0.9, 2.0, corner=True)
    room.against_wall("toilet", 0.4, 0.6, 0.45)
    room.against_wall("basin", _length(rng, 0.5, 0.8), 0.45, 0.85)
    if rng.random() < 0.6:
        room.against_wall("washing machine", 0.6, 0.6, 0.85, corner=True)


def _study(room: Furnisher) -> None:
    _desk(room, "desk", _length(room.rng, 1.4, 1.6), 0.8)
    room.against_wall("bookshelf", _length(room.rng, 1.0, 2.0), 0.35, 2.0)
    room.in_corner("plant", 0.2, 1.2)


def _storage(room: Furnisher) -> None:
    for _ in range(3):
        room.against_wall("shelf", _length(room.rng, 0.9, 1.8), 0.4, 2.0)


def _corridor(room: Furnisher) -> None:
    room.against_wall("cabinet", _length(room.rng, 0.7, 1.1), 0.3, 1.0)
    if room.rng.random() < 0.5:
        room.in_corner("coat rack", 0.2, 1.8)


def _office(room: Furnisher) -> None:
    for _ in range(1 + int(room.floor.width * room.floor.height > 13.0)):
        _desk(room, "desk", 1.6, 0.8)
    room.against_wall("cabinet", _length(room.rng, 0.8, 1.6), 0.45, 1.2)
    if room.rng.random() < 0.5:
        room.in_corner("plant", 0.25, 1.4)


def _meeting(room: Furnisher) -> None:
    """One long table in the middle, chairs along it, a board at a wall."""
    f, (mid_x, mid_y) = room.floor, room.middle
    along_x = f.width >= f.height
    long_m = rounded(max(1.6, (f.width if along_x else f.height) - 2.6))
    wide_m = 1.2 if min(f.width, f.height) > 3.6 else 0.9
    w, h = (long_m, wide_m) if along_x else (wide_m, long_m)
    x, y = rounded(mid_x - w / 2), rounded(mid_y - h / 2)
    if room.put("meeting table", Box(x, y, x + w, y + h), 0.75, legs_m=0.08):
        for number in range(int(long_m / 0.8)):
            at = 0.4 + 0.8 * number
            for off_m in (-0.3, wide_m + 0.3):
                cx, cy = (x + at, y + off_m) if along_x else (x + off_m, y + at)
                room.put_round("chair", rounded(cx), rounded(cy), 0.22, 0.9)
    room.against_wall("board", 1.5, 0.15, 1.9)


def _open_plan(room: Furnisher) -> None:
    """Islands of four desks, cabinets at the walls."""
    shapes = [(3.2, 1.6), (1.6, 3.2)]
    for i in room.rng.permutation(2):
        if _islands(room, *shapes[i]):
            break
    for _ in range(3):
        room.against_wall("cabinet", _length(room.rng, 1.0, 2.0), 0.45, 1.2)
    room.in_corner("plant", 0.25, 1.4)


def _islands(room: Furnisher, w: float, h: float) -> int:
    """As many as fit in rows and columns, spread evenly; how many stand."""
    f, aisle_m = room.floor, 1.25
    across, down = (int((n - aisle_m) / (size + aisle_m)) for n, size in ((f.width, w), (f.height, h)))
    gap_x, gap_y = ((n - k * size) / (k + 1) for n, k, size in ((f.width, across, w), (f.height, down, h)))
    return sum(
        _island(
            room,
            rounded(f.x0 + gap_x + i * (w + gap_x)),
            rounded(f.y0 + gap_y + j * (h + gap_y)),
            w,
            h,
        )
        for i in range(across)
        for j in range(down)
    )


def _island(room: Furnisher, x: float, y: float, w: float, h: float) -> bool:
    if not room.put("desk island", Box(x, y, x + w, y + h), 0.75, gap_m=0.3):
        return False
    for along in (0.25, 0.75):
        for far in (False, True):
            if w > h:
                cx, cy = x + along * w, (y + h + 0.35 if far else y - 0.35)
            else:
                cx, cy = (x + w + 0.35 if far else x - 0.35), y + along * h
            room.put_round("desk chair", rounded(cx), rounded(cy), 0.28, 0.9)
    return True


def _toilets(room: Furnisher) -> None:
    for cabins in (3, 2, 1):
        if room.against_wall("row of cabins", 0.9 * cabins, 1.3, 2.0, corner=True):
            break
    room.against_wall("basins", 1.2, 0.45, 0.85)


_RECIPES: Mapping[str, Callable[[Furnisher], None]] = {
    "living room": _living,
    "kitchen": _kitchen,
    "bedroom": _bedroom,
    "bathroom": _bathroom,
    "study": _study,
    "storage": _storage,
    "corridor": _corridor,
    "office": _office,
    "meeting room": _meeting,
    "open plan": _open_plan,
    "toilets": _toilets,
    "copy room": _storage,
}
