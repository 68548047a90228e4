"""What the nodes of a tree did over many runs, and which were never ticked in any."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields

from explore_bt.recording.reader import Recording
from explore_bt.recording.tree_tally import NodeTally

__all__ = ["NodeStatistics", "TreeStatistics", "tree_statistics"]


@dataclass(slots=True)
class NodeStatistics:
    """One node of all trees that have it; the same path and type is the same node.

    Attributes:
        runs: trees of runs that it was in; several robots of a run count one by one.
        ticked_in: in how many of them it was ticked.
        total: its tallies added up; ``longest_s`` is the longest of all.
    """

    path: str
    type: str
    runs: int = 0
    ticked_in: int = 0
    total: NodeTally = field(default_factory=NodeTally)

    def add(self, tally: NodeTally) -> None:
        """Take in one more run."""
        total = self.total
        self.runs += 1
        self.ticked_in += tally.ticks > 0
        total.ticks += tally.ticks
        total.successes += tally.successes
        total.failures += tally.failures
        total.cut_off += tally.cut_off
        total.running_s += tally.running_s
        total.longest_s = max(total.longest_s, tally.longest_s)


@dataclass(frozen=True, slots=True)
class TreeStatistics:
    """All nodes in the order of their trees, and what has to be known about the runs.

    Attributes:
        runs: how many recordings were counted.
        notes: one sentence each: trees that differ, recordings that are cut off, mocked or without counts.
    """

    runs: int
    nodes: tuple[NodeStatistics, ...]
    notes: tuple[str, ...]

    @property
    def never_ticked(self) -> tuple[NodeStatistics, ...]:
        """The nodes that no run has ticked."""
        return tuple(node for node in self.nodes if not node.ticked_in)


_Key = tuple[str, str]
_FIELDS = tuple(each.name for each in fields(NodeTally))


def tree_statistics(recordings: Iterable[Recording]) -> TreeStatistics:
    """Add up the last counts of each recording."""
    nodes: dict[_Key, NodeStatistics] = {}
    trees: dict[tuple[_Key, ...], list[str]] = {}
    notes: list[str] = []
    runs = 0
    for recording in recordings:
        runs += 1
        notes += [f"{recording.path}: {recording.damage}"] if recording.damage else []
        for robot in recording.robots:
            if any(node.get("is_mocked") for node in recording.info["trees"][robot]):
                notes.append(f"{recording.path} ({robot}): a dry run, some leaves are mocked")
            tree = [(str(node["path"]), str(node["type"])) for node in recording.info["trees"][robot]]
            trees.setdefault(tuple(tree), []).append(f"{recording.path} ({robot})")
            tallies = _last_tallies(recording, robot)
            if len(tallies) != len(tree):
                notes.append(f"{recording.path} ({robot}): holds no counts of its nodes; left out")
                continue
            for key, tally in zip(tree, tallies, strict=True):
                nodes.setdefault(key, NodeStatistics(*key)).add(tally)
    return TreeStatistics(runs, tuple(nodes.values()), (*notes, *_differences(trees)))


def _last_tallies(recording: Recording, robot: str) -> list[NodeTally]:
    last = recording.last(f"/{robot}/nodes")
    nodes = [] if last is None else last.value["nodes"]
    return [NodeTally(**{name: node[name] for name in _FIELDS}) for node in nodes]


def _differences(trees: dict[tuple[_Key, ...], list[str]]) -> Sequence[str]:
    if len(trees) < 2:
        return ()
    everywhere = set.intersection(*map(set, trees))
    lines = [f"the runs have {len(trees)} different trees; a node counts in those that have it"]
    for tree, runs in trees.items():
        own = len(set(tree) - everywhere)
        more = f" and {len(runs) - 1} more" if len(runs) > 1 else ""
        lines.append(f"{tree[0][0]}: {len(tree)} nodes, {own} of them not in every tree; in {runs[0]}{more}")
    return lines
