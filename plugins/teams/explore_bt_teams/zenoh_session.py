"""Sessions of Eclipse Zenoh, which is imported here and only when it is needed."""

from __future__ import annotations

import json
import zlib
from collections.abc import Sequence
from typing import Any

from explore_bt.errors import PluginError

__all__ = ["imported", "opened"]

_RETURN = {
    "transport/unicast/open_timeout": "2500",
    "transport/unicast/accept_timeout": "2500",
}
"""Milliseconds; of the four words of a greeting one is easily lost, and zenoh would wait for it for 10 s."""
_RETRY = "{period_init_ms: 500, period_max_ms: %d, period_increase_factor: 2}"


def imported() -> Any:
    """The library.

    Raises:
        PluginError: it is not installed.
    """
    try:
        import zenoh
    except ImportError:
        raise PluginError('team zenoh is not installed; type: pip install "explore-bt[fleet]"') from None
    return zenoh


def opened(
    name: str, mode: str, *, listen: Sequence[str], connect: Sequence[str] = (), multicast: bool = False
) -> Any:
    """A session.

    Args:
        name: of the robot: two that seek each other at the same moments would refuse each other for ever.
        mode: ``peer``, ``client`` or ``router``.
        listen: endpoints to be reached at, ``tcp/192.168.1.1:7447``.
        connect: endpoints to go to.
        multicast: whether to look for others on the local network.

    Raises:
        PluginError: zenoh is not installed, or an endpoint cannot be had.
    """
    zenoh = imported()
    config = zenoh.Config()
    config.insert_json5("mode", f'"{mode}"')
    config.insert_json5("scouting/multicast/enabled", "true" if multicast else "false")
    config.insert_json5("connect/retry", _RETRY % (600 + zlib.crc32(name.encode()) % 1500))
    for key, value in _RETURN.items():
        config.insert_json5(key, value)
    for key, endpoints in (("connect", connect), ("listen", listen)):
        if endpoints:
            config.insert_json5(f"{key}/endpoints", json.dumps(list(endpoints)))
    try:
        return zenoh.open(config)
    except zenoh.ZError as refusal:
        raise PluginError(
            f"team zenoh: no session: {refusal}. Check connect, listen and multicast, and that a router "
            "runs if mode is client: explore-bt router"
        ) from None
