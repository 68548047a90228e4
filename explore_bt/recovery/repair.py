"""A whole recording from one that was cut off."""

from __future__ import annotations

from pathlib import Path

from explore_bt.recording import PERIOD_NS, ChunkWriter, Recording
from explore_bt.version import __version__

__all__ = ["repair"]


def repair(recording: Recording, target: Path) -> Path:
    """Write every message that can be read into a file with an index, whole or not there at all.

    Raises:
        OSError: it cannot be written.
    """
    part = target.with_name(f".{target.name}.part")
    writer = ChunkWriter(part, str(recording.info.get("version", __version__)), PERIOD_NS)
    try:
        writer.register(recording.schemas.items())
        for topic, time_ns, data in recording.raw_messages():
            writer.write_raw(topic, time_ns, data)
        writer.close(target)
    finally:
        part.unlink(missing_ok=True)
    return target
