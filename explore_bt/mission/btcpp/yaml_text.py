"""Trees as the YAML that people include into a mission."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from explore_bt.mission.document import Value
from explore_bt.mission.files import FORMAT
from explore_bt.mission.references import plain_data
from explore_bt.mission.scalars import plain_scalar

__all__ = ["trees_text"]


class _Dumper(yaml.SafeDumper):
    """Quotes what YAML 1.2 would not read as text, and writes no aliases."""

    def ignore_aliases(self, data: Any) -> bool:  # noqa: ARG002  # the base's signature
        return True


def _text(dumper: yaml.SafeDumper, text: str) -> yaml.ScalarNode:
    quoted = "'" if plain_scalar(text) != text else None
    return dumper.represent_scalar("tag:yaml.org,2002:str", text, style=quoted)


_Dumper.add_representer(str, _text)


def trees_text(trees: Mapping[str, Value], remarks: Sequence[str] = ()) -> str:
    """A file of trees; every remark a comment at its top."""
    head = "".join(f"# {remark}\n" for remark in remarks)
    body = {"format": FORMAT, "trees": {name: plain_data(tree) for name, tree in trees.items()}}
    return head + yaml.dump(
        body, Dumper=_Dumper, sort_keys=False, allow_unicode=True, width=100, default_flow_style=None
    )
