"""The sink that records a run."""

from __future__ import annotations

import json
import logging
from dataclasses import asdict
from pathlib import Path

from pydantic import Field

from explore_bt.files import RECORDING
from explore_bt.interfaces import API_VERSION, Event, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.recording.chunk_writer import ChunkWriter
from explore_bt.recording.foxglove import log_message, stamp_ns
from explore_bt.recording.reader import Recording, RecordingError, read_recording
from explore_bt.recording.robot_track import Periods, RobotTrack
from explore_bt.recording.topics import ROBOT_TOPICS, RUN_TOPICS
from explore_bt.recording.values import to_json
from explore_bt.types import Result
from explore_bt.units import Duration

__all__ = [
    "McapRecorder",
    "McapRecorderOptions",
    "periods_of",
    "result_message",
    "run_message",
]

_log = logging.getLogger("explore_bt")


class McapRecorderOptions(PluginOptions):
    """How often things are written, in mission time."""

    chunk_period: Duration = Field(1.0, gt=0, description="a killed process loses at most this much")
    key_frame_period: Duration = Field(5.0, gt=0, description="between full states of tree and blackboard")
    scan_period: Duration = Field(0.5, gt=0, description="between scans")
    map_period: Duration = Field(2.0, gt=0, description="between maps; longer above 80,000 cells")
    clouds: bool = Field(False, description="record 3D lidars too; 15,000 points take 50 kB a sweep")


class McapRecorder(Sink):
    """Writes ``recording.mcap`` into the run's folder; the same run gives the same bytes.

    That of a resumed run is written anew from what was recorded before, and takes the place of the old file
    once it holds all of that: at every moment there is one file with everything.
    """

    name = "mcap"
    api_version = API_VERSION
    Options = McapRecorderOptions

    def __init__(self, options: PluginOptions) -> None:
        super().__init__(options)
        self._settings = McapRecorderOptions.model_validate(options.model_dump())
        self._writer: ChunkWriter | None = None
        self._tracks: dict[str, RobotTrack] = {}
        self._time_ns = 0

    def open(self, run: RunInfo) -> None:
        """Create the file and write what is known from the start."""
        settings = self._settings
        periods = periods_of(settings)
        file = run.folder / RECORDING
        past = _past(file) if run.resumed_s is not None else None
        writer = ChunkWriter(
            file.with_suffix(".part") if past else file, run.version, stamp_ns(settings.chunk_period)
        )
        writer.register(
            [(topic.pattern, topic.schema) for topic in RUN_TOPICS]
            + [(topic.of(robot), topic.schema) for robot in run.trees for topic in ROBOT_TOPICS]
        )
        self._tracks = {
            robot: RobotTrack(robot, writer.write, periods, clouds=settings.clouds) for robot in run.trees
        }
        self._writer, self._time_ns = writer, stamp_ns(run.resumed_s or 0.0)
        if past is None:
            writer.write("/run", 0, run_message(run))
            writer.flush()
            return
        for topic, time_ns, data in past.raw_messages():
            if topic != "/result":  # of a part that was stopped: the whole has one of its own
                writer.write_raw(topic, time_ns, data)
        writer.flush()
        writer.move(file)

    def on_tick(self, tick: TickSnapshot) -> None:
        """Write what the tick has changed."""
        before_ns, self._time_ns = self._time_ns, stamp_ns(tick.stamp_s)
        if self._writer is not None and self._writer.is_due(self._time_ns):
            for track in self._tracks.values():  # into the chunk that will be closed
                track.write_measurements(before_ns)
        for robot in tick.robots:
            self._tracks[robot.robot].on_tick(self._time_ns, tick.index, robot)

    def on_event(self, event: Event) -> None:
        """Write the event's line."""
        if self._writer is not None:
            time_ns = stamp_ns(event.stamp_s)
            self._writer.write("/events", time_ns, log_message(time_ns, event))

    def close(self, result: Result | None) -> None:
        """Write the last maps and the result, then the index."""
        writer, self._writer = self._writer, None
        if writer is None:
            return
        for track in self._tracks.values():
            track.close(self._time_ns)
        if result is not None:
            writer.write("/result", self._time_ns, result_message(result))
        writer.close()


def periods_of(settings: McapRecorderOptions) -> Periods:
    """How often a robot's messages are written under these options."""
    return Periods(
        key_frame=stamp_ns(settings.key_frame_period),
        scan=stamp_ns(settings.scan_period),
        map=stamp_ns(settings.map_period),
    )


def _past(file: Path) -> Recording | None:
    """What was recorded before the run was resumed; None if it cannot be read, which its owner is told."""
    try:
        return read_recording(file)
    except RecordingError as fault:
        _log.warning("the recording before the run was resumed is lost: %s", fault)
        return None


def run_message(run: RunInfo) -> str:
    """The message on ``/run``."""
    return json.dumps(
        {
            "mission": run.mission,
            "mission_text": run.mission_text,
            "mission_sha256": run.mission_sha256,
            "seed": run.seed,
            "version": run.version,
            "footprint_radius_m": dict(run.footprint_radius_m),
            "sources": dict(run.sources),
            "trees": {robot: [asdict(node) for node in nodes] for robot, nodes in run.trees.items()},
        },
        ensure_ascii=False,
    )


def result_message(result: Result) -> str:
    """The result without what a clock on the wall has measured: two equal runs are equal files."""
    figures = result.as_dict()
    figures.pop("wall_time_s")
    for name in ("left_open", "mocked", "not_merged"):
        figures[name] = list(getattr(result, name))
    figures["slam"] = {name: value for name, value in result.slam.items() if not _is_computing_time(name)}
    return json.dumps({name: _figure(value) for name, value in figures.items()}, ensure_ascii=False)


def _figure(value: object) -> object:
    return [str(line) for line in value] if isinstance(value, list) else to_json(value)


def _is_computing_time(name: str) -> bool:
    return "wall" in name or "cpu" in name or "ms" in name.split("_")
