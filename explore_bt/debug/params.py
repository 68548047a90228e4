"""Parameters of a mission, changed while it is under way."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import cast

from explore_bt.debug.places import Places
from explore_bt.debug.state import ParamState
from explore_bt.debug.uses import Use, uses
from explore_bt.errors import DebugError, MissionError
from explore_bt.mission import Mission, NodeSpec
from explore_bt.mission.words import did_you_mean, quantity
from explore_bt.tree import Leaf, Repeat, Retry, Timeout

__all__ = ["Params"]

Load = Callable[[Sequence[str]], Mission]


class Params:
    """Reads the mission again with the new value, and brings the difference into the built trees.

    So a value is checked exactly as ``--set`` does it, and what the parameter is used for is known, not
    guessed. What is made when a run begins (plugins with their options, limits, the shape of the trees)
    cannot be changed: such a parameter is refused as a whole.

    Args:
        mission: as the run was begun with; None for a run whose mission cannot be read again.
        load: reads it again, with overrides as ``--set`` takes them.
        settings: the overrides that the run was begun with.
    """

    def __init__(
        self, mission: Mission | None = None, load: Load | None = None, settings: Sequence[str] = ()
    ) -> None:
        self._mission = mission
        self._load = load
        self._settings = list(settings)
        self._states = _states(mission)

    @property
    def states(self) -> tuple[ParamState, ...]:
        """All parameters, with their present values."""
        return self._states

    def change(self, name: str, text: str, places: Places) -> str:
        """Set a parameter; what has changed, in words.

        Raises:
            DebugError: no such parameter, a value that it does not take, or one that is used for something
                that cannot be changed any more.
        """
        before, load = self._mission, self._load
        if before is None or load is None:
            raise DebugError("the parameters of this run cannot be changed: its mission cannot be read again")
        known = [param.name for param in before.declared]
        if name not in known:
            raise DebugError(f'there is no parameter "{name}"; {did_you_mean(name, known, "parameters")}')
        kept = [each for each in self._settings if _name_of(each) != name]
        settings = [*kept, f"{name}={text}"]
        after = self._read(before, load, settings)
        found = uses(before, after)
        fixed = [use.what for use in found if not use.can_change]
        if fixed:
            raise DebugError(
                f"{name} decides on {'; '.join(fixed)}: that is made when a run begins; "
                f"start again with --set {name}={text}"
            )
        for use in found:
            _apply(use, places)
        old = next(each.value for each in self._states if each.name == name)
        self._mission, self._settings, self._states = after, settings, _states(after)
        new = next(each.value for each in self._states if each.name == name)
        what = ", ".join(dict.fromkeys(use.what for use in found))
        return f"{name} = {new}, was {old}: {what or 'nothing in the trees of this run uses it'}"

    def _read(self, before: Mission, load: Load, settings: Sequence[str]) -> Mission:
        try:
            again, after = load(self._settings), load(settings)
        except MissionError as error:
            faults = "; ".join(": ".join(filter(None, (fault.message, fault.hint))) for fault in error.faults)
            raise DebugError(faults or str(error)) from None
        if again.sha256 != before.sha256:
            raise DebugError("the mission's files have changed since the run began; start again")
        return after


def _name_of(setting: str) -> str:
    """The parameter that an override is for."""
    return setting.partition("=")[0].strip().removeprefix("params.")


def _apply(use: Use, places: Places) -> None:
    assert use.after is not None
    spec = use.after
    for place in places:
        if place.robot.name != use.robot:
            continue
        if place.info.path == spec.path:
            _apply_to_node(place.node, spec)
        elif place.info.path == f"{spec.path}@timeout" and isinstance(place.node, Timeout):
            place.node.duration_s = cast(float, spec.modifiers.timeout_s)
        elif place.info.path == f"{spec.path}@retry" and isinstance(place.node, Retry):
            place.node.retries = cast(int, spec.modifiers.retry)


def _apply_to_node(node: object, spec: NodeSpec) -> None:
    if isinstance(node, Leaf):
        node.bind(spec.bindings)
    elif isinstance(node, Repeat):
        node.times = cast(int, spec.settings["times"])


def _states(mission: Mission | None) -> tuple[ParamState, ...]:
    if mission is None:
        return ()
    return tuple(
        ParamState(
            param.name,
            param.type,
            quantity(mission.params.get(param.name), param.asked.dimension),
            param.doc,
        )
        for param in mission.declared
    )
