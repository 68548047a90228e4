"""What changes from second to second and is small: written far more often than a whole checkpoint."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

__all__ = ["Recent", "read_recent", "write_recent"]

_FORMAT = "explore-bt-recent/1"
_FILE = "recent.json"


@dataclass(frozen=True, slots=True)
class Recent:
    """The memories of robots after a tick, without what is large; ``robots`` are texts of a ``Codec``."""

    tick: int
    robots: Mapping[str, str]


def write_recent(folder: Path, recent: Recent) -> None:
    """Take the place of the one before, whole.

    Not waited for until it is on the disk: it outlives a killed process, and after a power cut the last
    checkpoint is what counts.

    Raises:
        OSError: the disk is full, or gone.
    """
    body = json.dumps({"format": _FORMAT, "tick": recent.tick, "robots": dict(recent.robots)})
    draft = folder / f".{_FILE}"
    draft.write_text(f"{_sum(body)}\n{body}")
    os.replace(draft, folder / _FILE)


def read_recent(folder: Path) -> Recent | None:
    """The last one; None where there is none, or it is damaged."""
    try:
        checksum, _, body = (folder / _FILE).read_text().partition("\n")
        if checksum != _sum(body):
            return None
        found = json.loads(body)
        return Recent(int(found["tick"]), dict(found["robots"])) if found["format"] == _FORMAT else None
    except (OSError, ValueError, KeyError, TypeError):
        return None


def _sum(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
