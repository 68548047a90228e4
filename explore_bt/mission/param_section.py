"""The section ``params``: declarations of all files, and their values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from explore_bt.mission.catalog import PluginCatalog
from explore_bt.mission.faults import Faults
from explore_bt.mission.files import MissionText
from explore_bt.mission.overrides import Override, params_overridden
from explore_bt.mission.params import Param, param_value, read_param
from explore_bt.mission.references import BROKEN

__all__ = ["read_params"]


def read_params(
    text: MissionText,
    overrides: Sequence[Override],
    catalog: PluginCatalog,
    environ: Mapping[str, str],
    faults: Faults,
) -> tuple[tuple[Param, ...], dict[str, object]]:
    """The declarations, and parameter -> value in SI (``BROKEN`` where a fault was noted)."""
    declared: list[Param] = []
    new = params_overridden(overrides, text.params, faults)
    params: dict[str, object] = {}
    for name, entry in text.params.items():
        param = read_param(entry, faults)
        value = param and param_value(param, new.get(name), catalog, environ, faults)
        params[name] = BROKEN if param is None else value
        declared += [param] if param else []
    return tuple(declared), params
