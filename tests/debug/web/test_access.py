from __future__ import annotations

import socket
import string

import pytest
from hypothesis import given
from hypothesis import strategies as st

from explore_bt.debug.web import Access

LOCAL = Access.to("127.0.0.1", "")
WIDE = Access.to("0.0.0.0", "")
MACHINE = socket.gethostname().lower()


@pytest.mark.parametrize(
    "host", ["127.0.0.1:80", "127.0.0.1", "localhost:9000", "[::1]:80", "LOCALHOST", "127.9.9.9"]
)
def test_this_machine_goes_by_its_loopback_names_through_a_tunnel_too(host):
    assert LOCAL.admits_host(host)


@pytest.mark.parametrize(
    "host",
    [
        *("evil.example", "127.0.0.1.evil.example", "localhost.evil.example", "10.0.0.7:80", "", None),
        *("127.0.0.1:99999", "127.0.0.1:x", "a@127.0.0.1", "127.0.0.1/x", "[::1", "2130706433", " "),
        *(f"{MACHINE}.evil.example", "0x7f.1"),
    ],
)
def test_no_other_name_leads_to_this_machine_alone(host):
    assert not LOCAL.admits_host(host)


@pytest.mark.parametrize(
    "host", ["192.168.1.5:80", "[fd00::1]:80", MACHINE, f"{MACHINE}.local:80", "localhost"]
)
def test_an_open_server_goes_by_addresses_and_the_machines_own_name(host):
    assert WIDE.admits_host(host)


@pytest.mark.parametrize("host", ["evil.example", "rebound.evil.example:80", None])
def test_an_open_server_cannot_be_rebound(host):
    assert not WIDE.admits_host(host)


def test_only_the_pages_own_origin_is_admitted():
    host = "127.0.0.1:8000"
    assert LOCAL.admits_origin("http://127.0.0.1:8000", host)
    assert LOCAL.admits_origin("https://127.0.0.1:8000", host)
    for origin in (
        *("http://127.0.0.1:8001", "http://localhost:8000", "null", "", None, "file://", "http://127.0.0.1"),
        *(
            "http://127.0.0.1:8000.evil.example",
            "http://127.0.0.1:8000/",
            "chrome-extension://127.0.0.1:8000",
        ),
    ):
        assert not LOCAL.admits_origin(origin, host), origin
    assert not LOCAL.admits_origin("http://", "")
    assert not LOCAL.admits_origin("http://", None)


def test_only_loopback_needs_no_token_and_every_made_up_one_is_new():
    for host in ("127.0.0.1", "localhost", "::1"):
        assert Access.to(host, "").token == ""
        assert Access.to(host, "mine").token == "mine"
    for host in ("0.0.0.0", "::", "192.168.1.5", "robot.local"):
        assert len(Access.to(host, "").token) >= 32
        assert Access.to(host, "").token != Access.to(host, "").token
        assert Access.to(host, "mine").token == "mine"


@given(st.text(string.printable + "äß", max_size=40))
def test_no_other_token_is_the_token(guess):
    access = Access.to("0.0.0.0", "the right one")
    assert access.admits_token(guess) == (guess == "the right one")
    assert LOCAL.admits_token(guess)
