"""The trees with the status of every node, and what leaves say."""

from __future__ import annotations

from explore_bt.export.video.canvas import Canvas, rgb
from explore_bt.export.video.scene import RobotScene, Scene
from explore_bt.report.palette import robot_colour

__all__ = ["STATUS_COLOURS", "TreePane"]

STATUS_COLOURS = {
    "running": rgb("#2f6fed"),
    "success": rgb("#0f9d76"),
    "failure": rgb("#d7263d"),
    "idle": rgb("#c3cad2"),
}
_INK, _SOFT = rgb("#16202c"), rgb("#5d6b7a")
_ROW, _INDENT, _MARGIN = 19, 14, 12


class TreePane:
    """Draws into a box of a canvas; the robots share its height.

    Where a tree has more nodes than there is room for, what lies below idle nodes is left out, then what lies
    below nodes that do not run.
    """

    def __init__(self, box: tuple[int, int, int, int]) -> None:
        self._box = box

    def draw(self, canvas: Canvas, scene: Scene) -> None:
        """All trees, one below the other."""
        left, top, width, height = self._box
        share = height // max(len(scene.robots), 1)
        for index, (name, robot) in enumerate(scene.robots.items()):
            y = top + index * share + 8
            if len(scene.robots) > 1:
                canvas.text((left + _MARGIN, y), name, rgb(robot_colour(index)), bold=True)
                y += _ROW
            self._draw_tree(canvas, robot, y, top + (index + 1) * share, left + width)

    def _draw_tree(self, canvas: Canvas, robot: RobotScene, top: int, bottom: int, right: int) -> None:
        rows = _rows(robot, (bottom - top) // _ROW)
        for row, index in enumerate(rows):
            node, (status, words) = robot.tree[index], robot.nodes[index]
            y = top + row * _ROW
            x = self._box[0] + _MARGIN + min(node["path"].count("/"), 12) * _INDENT
            canvas.dot((x + 5.0, y + 9.0), 5.0, STATUS_COLOURS[status])
            name, bold = canvas.cut_to(node["name"], right - x - 24), status == "running"
            canvas.text((x + 16, y), name, _SOFT if status == "idle" else _INK, bold=bold)
            begin = x + 26 + canvas.width_of(name, bold=bold)
            if words and status != "idle" and right - begin > 40:
                canvas.text((begin, y + 1), canvas.cut_to(words, right - begin - 6, 11), _SOFT, 11)


def _rows(robot: RobotScene, room: int) -> list[int]:
    """The nodes that are shown, parents before children."""
    everything = list(range(len(robot.tree)))
    if len(everything) <= room:
        return everything
    for hidden in (("idle",), ("idle", "success", "failure")):
        rows = _without_below(robot, hidden)
        if len(rows) <= room:
            break
    return rows[:room]


def _without_below(robot: RobotScene, hidden: tuple[str, ...]) -> list[int]:
    rows: list[int] = []
    shown: set[int] = set()
    for index, node in enumerate(robot.tree):
        parent = node["parent"]
        if parent is None or (parent in shown and robot.nodes[parent][0] not in hidden):
            rows.append(index)
            shown.add(index)
    return rows
