"""The recording of a run: one MCAP file that outlives a crash and opens in Foxglove as it is."""

from explore_bt.recording.foxglove import decode_grid
from explore_bt.recording.mcap_sink import McapRecorder, McapRecorderOptions
from explore_bt.recording.measurements_reader import decode_measurements
from explore_bt.recording.reader import RecordedMessage, Recording, RecordingError, read_recording
from explore_bt.recording.topics import TOPICS, Topic
from explore_bt.recording.tree_statistics import NodeStatistics, TreeStatistics, tree_statistics
from explore_bt.recording.tree_tally import NodeTally, TreeTally
from explore_bt.recording.values import to_json

__all__ = [
    "SINKS",
    "TOPICS",
    "McapRecorder",
    "McapRecorderOptions",
    "NodeStatistics",
    "NodeTally",
    "RecordedMessage",
    "Recording",
    "RecordingError",
    "Topic",
    "TreeStatistics",
    "TreeTally",
    "decode_grid",
    "decode_measurements",
    "read_recording",
    "to_json",
    "tree_statistics",
]

SINKS = (McapRecorder,)
"""The sinks of this package, for the plugin host."""
