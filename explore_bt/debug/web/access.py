"""Who may talk to the page's server: the rules on host, origin and token."""

from __future__ import annotations

import hmac
import ipaddress
import secrets
import socket
from dataclasses import dataclass
from urllib.parse import urlsplit

__all__ = ["Access"]


@dataclass(frozen=True, slots=True)
class Access:
    """Rules that hold for one bound address.

    Attributes:
        is_local: whether only this machine can connect.
        names: under which the server may be asked for, besides IP addresses. A name of somebody else's
            that leads here (DNS rebinding) is none of them, and an address cannot be made to lead here.
        token: demanded on the socket; empty where none is.
    """

    is_local: bool
    names: frozenset[str]
    token: str

    @classmethod
    def to(cls, host: str, token: str) -> Access:
        """The rules for an address; anything but loopback has a token, if not this one, a new one."""
        local = _is_loopback(host)
        machine = socket.gethostname().lower()
        names = {"localhost"} if local else {"localhost", machine, f"{machine}.local", host.lower()}
        return cls(local, frozenset(names), token or ("" if local else secrets.token_urlsafe(24)))

    def admits_host(self, host: str | None) -> bool:
        """Whether a request for this ``Host`` is meant for us; its port may be that of a tunnel."""
        name = _name_in(f"//{host}") if host else ""
        if not name or name in self.names:
            return bool(name)
        return _is_loopback(name) if self.is_local else _is_address(name)

    def admits_origin(self, origin: str | None, host: str | None) -> bool:
        """Whether a socket was opened by our own page: same host, same port."""
        scheme, _, rest = (origin or "").partition("://")
        return scheme in ("http", "https") and bool(host) and rest.lower() == (host or "").lower()

    def admits_token(self, token: str) -> bool:
        """Whether the token is the right one, in a time that does not tell how much of it is."""
        return not self.token or hmac.compare_digest(token.encode(), self.token.encode())


def _name_in(url: str) -> str:
    try:
        parts = urlsplit(url)
        parts.port  # noqa: B018  # raises for a port that is none
    except ValueError:
        return ""
    return "" if parts.username is not None or parts.path else (parts.hostname or "")


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _is_loopback(name: str) -> bool:
    return name == "localhost" or (_is_address(name) and ipaddress.ip_address(name).is_loopback)
