"""What people look at: the report, the map files, the live view in a terminal."""

from explore_bt.report.cloud_exporter import PcdExporter, PlyExporter
from explore_bt.report.g2o_exporter import G2oExporter
from explore_bt.report.live import ProgressLines, TerminalView
from explore_bt.report.map_picture import data_uri
from explore_bt.report.map_server_exporter import MapServerExporter
from explore_bt.report.octomap_exporter import OctomapExporter
from explore_bt.report.overlay import cropped, overlaid
from explore_bt.report.palette import robot_colour
from explore_bt.report.report_sink import ReportSink
from explore_bt.report.tum_exporter import TumExporter

__all__ = [
    "EXPORTERS",
    "SINKS",
    "G2oExporter",
    "MapServerExporter",
    "OctomapExporter",
    "PcdExporter",
    "PlyExporter",
    "ProgressLines",
    "ReportSink",
    "TerminalView",
    "TumExporter",
    "cropped",
    "data_uri",
    "overlaid",
    "robot_colour",
]

SINKS = (ReportSink, TerminalView, ProgressLines)
"""The sinks of this package, for the plugin host."""
EXPORTERS = (
    MapServerExporter,
    TumExporter,
    PlyExporter,
    PcdExporter,
    OctomapExporter,
    G2oExporter,
)
"""The exporters of this package, for the plugin host."""
