"""Which of our nodes is which of BehaviorTree.CPP's."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = [
    "BUILTIN_TAGS",
    "CONTROL_TAGS",
    "DECORATOR_TAGS",
    "ENTRY_HOLDS",
    "EXPLICIT_TAGS",
    "LIVE_TAGS",
    "MODIFIER",
    "OWN_NAME",
]

CONTROL_TAGS: Mapping[str, str] = {
    "sequence": "Sequence",
    "fallback": "Fallback",
    "reactive_sequence": "ReactiveSequence",
    "reactive_fallback": "ReactiveFallback",
}
"""Control nodes with any number of children and nothing to set."""

DECORATOR_TAGS: Mapping[str, str] = {
    "invert": "Inverter",
    "force_success": "ForceSuccess",
    "force_failure": "ForceFailure",
}
"""Control nodes with one child and nothing to set."""

ENTRY_HOLDS = "entry_holds"
"""The condition of ``if: $entry``: a node, as BehaviorTree.CPP's scripts know neither None nor empty."""

LIVE_TAGS: Mapping[str, str] = {
    **CONTROL_TAGS,
    **DECORATOR_TAGS,
    "parallel": "Parallel",
    "subtree": "SubTree",
    "timeout": "Timeout",
    "retry": "RetryUntilSuccessful",
    "if": "Sequence",
    "on_failure": "Fallback",
    "entry": ENTRY_HOLDS,
    "repeat": "Repeat",
}
"""Type of a built node -> tag; a leaf's tag is its own type key."""

EXPLICIT_TAGS = ("Action", "Condition", "Control", "Decorator")
"""Tags of the long form, ``<Action ID="drive_to"/>``."""

MODIFIER = "_modifier"
"""Attribute that marks the composition a modifier became; BehaviorTree.CPP passes over all with ``_``."""

OWN_NAME = "_name"
"""Attribute with a subtree node's own name: Groot2 cannot bear ``name`` there."""

# fmt: off
BUILTIN_TAGS = frozenset(
    (
        "Action", "AlwaysFailure", "AlwaysSuccess", "AsyncFallback", "AsyncSequence",
        "BehaviorTree", "Condition", "Control", "Decorator", "Delay", "Fallback", "ForceFailure",
        "ForceSuccess", "IfThenElse", "Inverter", "KeepRunningUntilFailure", "LoopBool",
        "LoopDouble", "LoopInt", "LoopString", "Parallel", "ParallelAll", "Precondition",
        "ReactiveFallback", "ReactiveSequence", "Repeat", "RetryUntilSuccessful", "RunOnce",
        "Script", "ScriptCondition", "Sequence", "SequenceWithMemory", "SetBlackboard",
        "SkipUnlessUpdated", "Sleep", "SubTree", "Switch2", "Switch3", "Switch4", "Switch5",
        "Switch6", "Timeout", "TryCatch", "UnsetBlackboard", "WaitValueUpdate", "WasEntryUpdated",
        "WhileDoElse",
    )
)
# fmt: on
"""Names that BehaviorTree.CPP has taken; neither a tree nor a leaf may have one."""
