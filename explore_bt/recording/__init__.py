"""The recording of a run: one MCAP file that outlives a crash and opens in Foxglove as it is."""

from explore_bt.recording.btlog import STATUS_BYTES, btlog, transition_record
from explore_bt.recording.chunk_writer import PERIOD_NS, ChunkWriter
from explore_bt.recording.foxglove import decode_event, decode_grid, decode_pose, log_message, stamp_ns
from explore_bt.recording.mcap_sink import (
    McapRecorder,
    McapRecorderOptions,
    periods_of,
    result_message,
    run_message,
)
from explore_bt.recording.measurements_reader import decode_measurements
from explore_bt.recording.message_log import LoggedMessage, MessageLog
from explore_bt.recording.reader import RecordedMessage, Recording, RecordingError, read_recording
from explore_bt.recording.robot_track import Periods, RobotTrack
from explore_bt.recording.run_state import NodeNow, RobotState, followed_topics, state_at
from explore_bt.recording.schemas import schema_text
from explore_bt.recording.timeline import Timeline
from explore_bt.recording.topics import ROBOT_TOPICS, RUN_TOPICS, TOPICS, Topic
from explore_bt.recording.tree_statistics import NodeStatistics, TreeStatistics, tree_statistics
from explore_bt.recording.tree_tally import NodeTally, TreeTally
from explore_bt.recording.values import to_json

__all__ = [
    "PERIOD_NS",
    "ROBOT_TOPICS",
    "RUN_TOPICS",
    "SINKS",
    "STATUS_BYTES",
    "TOPICS",
    "ChunkWriter",
    "LoggedMessage",
    "McapRecorder",
    "McapRecorderOptions",
    "MessageLog",
    "NodeNow",
    "NodeStatistics",
    "NodeTally",
    "Periods",
    "RecordedMessage",
    "Recording",
    "RecordingError",
    "RobotState",
    "RobotTrack",
    "Timeline",
    "Topic",
    "TreeStatistics",
    "TreeTally",
    "btlog",
    "decode_event",
    "decode_grid",
    "decode_measurements",
    "decode_pose",
    "followed_topics",
    "log_message",
    "periods_of",
    "read_recording",
    "result_message",
    "run_message",
    "schema_text",
    "stamp_ns",
    "state_at",
    "to_json",
    "transition_record",
    "tree_statistics",
]

SINKS = (McapRecorder,)
"""The sinks of this package, for the plugin host."""
