"""The recording of a run: one MCAP file that outlives a crash and opens in Foxglove as it is."""

from explore_bt.recording.chunk_writer import PERIOD_NS, ChunkWriter
from explore_bt.recording.foxglove import decode_grid
from explore_bt.recording.mcap_sink import RECORDING, McapRecorder, McapRecorderOptions
from explore_bt.recording.measurements_reader import decode_measurements
from explore_bt.recording.reader import RecordedMessage, Recording, RecordingError, read_recording
from explore_bt.recording.topics import TOPICS, Topic
from explore_bt.recording.values import to_json

__all__ = [
    "PERIOD_NS",
    "RECORDING",
    "SINKS",
    "TOPICS",
    "ChunkWriter",
    "McapRecorder",
    "McapRecorderOptions",
    "RecordedMessage",
    "Recording",
    "RecordingError",
    "Topic",
    "decode_grid",
    "decode_measurements",
    "read_recording",
    "to_json",
]

SINKS = (McapRecorder,)
"""The sinks of this package, for the plugin host."""
