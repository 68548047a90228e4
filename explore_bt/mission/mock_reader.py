"""Mock files: YAML text to rules that say which leaves play which script."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import cast

from pydantic import TypeAdapter

from explore_bt.mission.bounds import Asked
from explore_bt.mission.checking import check_value
from explore_bt.mission.document import Entries, Scalar, Value
from explore_bt.mission.faults import Faults
from explore_bt.mission.reading import check_keys, expect_entries, expect_items, expect_text, written
from explore_bt.mission.references import BROKEN, Scope, resolve
from explore_bt.mission.source import Place
from explore_bt.mission.words import did_you_mean
from explore_bt.tree import Round, Status
from explore_bt.units import DURATION, Duration

__all__ = ["MOCK_FORMAT", "MockRule", "read_rules"]

MOCK_FORMAT = "explore-bt-mocks/1"
_FILE_KEYS = ("format", "doc", "mocks")
_RULE_KEYS = ("leaf", "ticks", "after", "then", "at_end", "say", "set")
_TICKS = re.compile(r"(running|success|failure)(?:\*([1-9][0-9]{0,5}))?")
_STATUS = {"running": Status.RUNNING, "success": Status.SUCCESS, "failure": Status.FAILURE}
_EXAMPLE = "ticks: [running*20, success]"
_DURATION: TypeAdapter[float] = TypeAdapter(Duration)


@dataclass(frozen=True, slots=True)
class MockRule:
    """One entry of a mock file.

    Attributes:
        pattern: a glob over the paths of leaves; ``*`` stands for any part of a path.
        place: where the pattern stands.
        outputs: port -> what to write, not yet checked against a leaf.
    """

    pattern: str
    place: Place
    rounds: tuple[Round, ...]
    cycles: bool
    say: str
    outputs: Entries

    def matches(self, path: str) -> bool:
        """Whether a leaf at that path plays this script."""
        return fnmatchcase(path, self.pattern)


def read_rules(root: Entries, scope: Scope, faults: Faults) -> tuple[MockRule, ...]:
    """All rules of a file that name a leaf; where a fault was noted their rounds may be missing."""
    check_keys(root, _FILE_KEYS, "a mock file", faults)
    given = root.by_key.get("format")
    if given is None:
        faults.add(root.place, "the format is missing", f"begin with format: {MOCK_FORMAT}")
    elif not isinstance(given.value, Scalar) or given.value.text != MOCK_FORMAT:
        faults.add(given.value.place, f"format {written(given.value)} is not known", f"write {MOCK_FORMAT}")
    items = expect_items(root.get("mocks"), "mocks", '[{leaf: "*/drive_to", after: 3 s}]', faults)
    if not items and not faults:
        faults.add(root.place, "no leaf is mocked", 'write mocks: [{leaf: "*/drive_to", after: 3 s}]')
    rules = (_RuleReader(item, scope, faults).rule() for item in items)
    return tuple(rule for rule in rules if rule is not None)


class _RuleReader:
    def __init__(self, item: Value, scope: Scope, faults: Faults) -> None:
        self._item = item
        self._scope = scope
        self._faults = faults

    def rule(self) -> MockRule | None:
        entries = expect_entries(self._item, "a mock", '{leaf: "*/drive_to", after: 3 s}', self._faults)
        if entries is None:
            return None
        check_keys(entries, _RULE_KEYS, "a mock", self._faults)
        entries = cast(Entries, resolve(entries, self._scope, self._faults))
        pattern = expect_text(entries.get("leaf"), "leaf", self._faults)
        if pattern is None:
            if "leaf" not in entries.by_key:
                self._faults.add(entries.place, "a mock needs the key leaf", 'write leaf: "*/drive_to"')
            return None
        head = entries.by_key["leaf"]
        rounds = self._rounds(entries, head.place)
        none = Entries((), entries.place)
        example = "{goal: [1 m, 2 m, 0 deg]}"
        outputs = expect_entries(entries.get("set"), "set", example, self._faults) or none
        say = expect_text(entries.get("say"), "say", self._faults) or ""
        cycles = self._choice(entries, "at_end", ("cycle", "last")) != "last"
        return MockRule(pattern, head.value.place, rounds, cycles, say, outputs)

    def _rounds(self, entries: Entries, place: Place) -> tuple[Round, ...]:
        ticks, after = entries.get("ticks"), entries.get("after")
        answer = self._choice(entries, "then", ("success", "failure"))
        if ticks is not None and after is not None:
            self._faults.add(after.place, "a mock has ticks or after, not both", f"remove it, or {_EXAMPLE}")
        elif ticks is not None:
            if "then" in entries.by_key:
                hint = "put the answer into ticks"
                self._faults.add(entries.by_key["then"].place, "then belongs to after", hint)
            return self._rounds_of(ticks)
        elif after is not None:
            after_s = check_value(
                lambda text: _DURATION.validate_json(text, strict=True),
                after,
                "after",
                Asked(DURATION, ge=0.0),
                self._faults,
            )
            if isinstance(after_s, float) and after_s < 0.0:
                self._faults.add(after.place, f"after: {written(after)} is below zero", "write after: 3 s")
            elif after_s is not BROKEN:
                return (Round(0, cast(float, after_s), _STATUS[answer or "success"]),)
        else:
            self._faults.add(place, "a mock needs ticks or after", f"write {_EXAMPLE}, or after: 3 s")
        return ()

    def _rounds_of(self, ticks: Value) -> tuple[Round, ...]:
        rounds: list[Round] = []
        running = 0
        items = expect_items(ticks, "ticks", "[running*20, success]", self._faults)
        for item in items:
            found = _TICKS.fullmatch(item.text) if isinstance(item, Scalar) else None
            if found is None:
                word = item.text.partition("*")[0] if isinstance(item, Scalar) else ""
                hint = did_you_mean(word, _STATUS, "write running*20;")
                self._faults.add(item.place, f"ticks: {written(item)} is not a status", hint)
            elif found[1] == "running":
                running += int(found[2] or 1)
            else:
                answer, times = _STATUS[found[1]], int(found[2] or 1)
                rounds += [Round(running, 0.0, answer), *[Round(0, 0.0, answer)] * (times - 1)]
                running = 0
        if running:
            rounds.append(Round(running, 0.0, None))
        if not items:
            self._faults.add(ticks.place, "ticks: nothing is in it", f"write {_EXAMPLE}")
        return tuple(rounds)

    def _choice(self, entries: Entries, key: str, words: tuple[str, ...]) -> str | None:
        value = entries.get(key)
        word = expect_text(value, key, self._faults)
        if value is None or word is None or word in words:
            return word
        self._faults.add(value.place, f'{key}: "{word}" is not known', did_you_mean(word, words))
        return None
