"""Planners from the package index, behind one face: an inflated grid and two cells in, a polyline out."""

from __future__ import annotations

import contextlib
import os
import warnings
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

__all__ = ["PEERS", "PIP_LINE", "Cell", "Peer", "Route"]

PIP_LINE = 'pip install "explore-bt[bench]"'

Cell = tuple[int, int]
Route = NDArray[np.float64]
"""(N, 2) float64 rows and columns of cell centres or between them, start and goal included."""


class Peer(Protocol):
    """Made once per map, which is not timed; a call is one plan, which is."""

    def __call__(self, start: Cell, goal: Cell) -> Route | None:
        """A route, None if it finds none."""


def _pyastar2d(passable: NDArray[np.bool_]) -> Peer:
    astar_path = import_module("pyastar2d").astar_path
    weights = np.where(passable, 1.0, np.inf).astype(np.float32)

    def plan(start: Cell, goal: Cell) -> Route | None:
        path = astar_path(weights, start, goal, allow_diagonal=True)
        return None if path is None else np.asarray(path, dtype=np.float64)

    return plan


def _pathfinding(passable: NDArray[np.bool_]) -> Peer:
    grids = import_module("pathfinding.core.grid")
    moves = import_module("pathfinding.core.diagonal_movement").DiagonalMovement
    finder = import_module("pathfinding.finder.a_star").AStarFinder(
        diagonal_movement=moves.only_when_no_obstacle
    )
    grid = grids.Grid(matrix=passable.astype(int).tolist())

    def plan(start: Cell, goal: Cell) -> Route | None:
        grid.cleanup()
        ends = (grid.node(start[1], start[0]), grid.node(goal[1], goal[0]))
        path, _ = finder.find_path(*ends, grid)
        return np.array([(node.y, node.x) for node in path], dtype=np.float64) if path else None

    return plan


def _motion_planning(name: str) -> Callable[[NDArray[np.bool_]], Peer]:
    def make(passable: NDArray[np.bool_]) -> Peer:
        package = import_module("python_motion_planning")
        rows, cols = passable.shape
        world = package.Grid(bounds=[[0, rows], [0, cols]])
        world.type_map[:] = np.where(passable, package.TYPES.FREE, package.TYPES.OBSTACLE)
        planner_class = getattr(package, name)

        def plan(start: Cell, goal: Cell) -> Route | None:
            planner = planner_class(map_=world, start=start, goal=goal)
            path, told = planner.plan()
            return np.asarray(path, dtype=np.float64) if told["success"] else None

        return plan

    return make


def _ompl(passable: NDArray[np.bool_]) -> Peer:
    base, geometric = (import_module(f"ompl.{part}") for part in ("base", "geometric"))
    rows, cols = passable.shape
    import_module("ompl.util").setLogLevel(import_module("ompl.util").LogLevel.LOG_NONE)

    def plan(start: Cell, goal: Cell) -> Route | None:
        space = base.RealVectorStateSpace(2)
        bounds = base.RealVectorBounds(2)
        for axis, size in enumerate((rows, cols)):
            bounds.setLow(axis, 0.0)
            bounds.setHigh(axis, float(size - 1))
        space.setBounds(bounds)
        setup = geometric.SimpleSetup(space)
        setup.setStateValidityChecker(lambda at: bool(passable[round(at[0]), round(at[1])]))
        information = setup.getSpaceInformation()
        information.setStateValidityCheckingResolution(0.5 / float(np.hypot(rows, cols)))
        ends = [space.allocState() for _ in range(2)]
        for state, cell in zip(ends, (start, goal), strict=True):
            state[0], state[1] = float(cell[0]), float(cell[1])
        setup.setStartAndGoalStates(*ends)
        setup.setPlanner(geometric.RRTConnect(information))
        with _silence():
            if not setup.solve(10.0) or not setup.haveExactSolutionPath():
                return None
            setup.simplifySolution()
        states = setup.getSolutionPath().getStates()
        return np.array([(state[0], state[1]) for state in states])

    return plan


@contextlib.contextmanager
def _silence() -> Iterator[None]:
    """A library that prints from C++ would write into the table."""
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        yield
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)


PEERS: dict[str, Callable[[NDArray[np.bool_]], Any]] = {
    "pyastar2d": _pyastar2d,
    "pathfinding A*": _pathfinding,
    "python-motion-planning A*": _motion_planning("AStar"),
    "python-motion-planning Theta*": _motion_planning("ThetaStar"),
    "python-motion-planning Voronoi": _motion_planning("VoronoiPlanner"),
    "OMPL RRTConnect + simplify": _ompl,
}
"""Name and maker; a maker raises ImportError where the package is missing."""

warnings.filterwarnings("ignore", module=r"python_motion_planning.*")
