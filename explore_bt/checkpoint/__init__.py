"""What a run needs to go on after its process has died: values as text, and folders written whole."""

from explore_bt.checkpoint.codec import Codec, CodecError
from explore_bt.checkpoint.recent import Recent, read_recent, write_recent
from explore_bt.checkpoint.state import Origin, RobotMemory, RunMemory
from explore_bt.checkpoint.store import Checkpoint, CheckpointError, CheckpointStore, Draft

__all__ = [
    "Checkpoint",
    "CheckpointError",
    "CheckpointStore",
    "Codec",
    "CodecError",
    "Draft",
    "Origin",
    "Recent",
    "RobotMemory",
    "RunMemory",
    "read_recent",
    "write_recent",
]
