"""The recording of a run: one MCAP file that outlives a crash and opens in Foxglove as it is."""

from explore_bt.recording.btlog import STATUS_BYTES, btlog, transition_record
from explore_bt.recording.foxglove import decode_grid
from explore_bt.recording.mcap_sink import McapRecorder, McapRecorderOptions
from explore_bt.recording.measurements_reader import decode_measurements
from explore_bt.recording.reader import RecordedMessage, Recording, RecordingError, read_recording
from explore_bt.recording.topics import TOPICS, Topic
from explore_bt.recording.values import to_json

__all__ = [
    "SINKS",
    "STATUS_BYTES",
    "TOPICS",
    "McapRecorder",
    "McapRecorderOptions",
    "RecordedMessage",
    "Recording",
    "RecordingError",
    "Topic",
    "btlog",
    "decode_grid",
    "decode_measurements",
    "read_recording",
    "to_json",
    "transition_record",
]

SINKS = (McapRecorder,)
"""The sinks of this package, for the plugin host."""
