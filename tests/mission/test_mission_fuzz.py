"""Whatever stands in a mission file: a mission comes out, or a ``MissionError``."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from explore_bt.mission import MissionError, load_mission
from explore_bt.plugin import Registry

TOKENS = st.sampled_from(
    [
        *(
            "{}",
            "[]",
            "[",
            "]",
            "{",
            "}",
            ":",
            "- ",
            "\n",
            "  ",
            "\t",
            "null",
            "~",
            "0",
            "-1",
            "1e999",
            ".nan",
        ),
        *(
            "$goal",
            "$params.stride",
            "${x}",
            "{goal}",
            "$robot.name",
            "$env.HOME",
            "&a ",
            "*a",
            "<<: ",
            "!!int ",
        ),
        *(
            '"',
            "'",
            "|",
            ">",
            "#",
            "---",
            "...",
            "?",
            "yes",
            "true",
            "30 m",
            "60 s",
            "sequence",
            "home",
            "drive",
        ),
        *(
            "if: ",
            "retry: ",
            "timeout: ",
            "subtree: ",
            "name: ",
            "use: ",
            "\ufeff",
            "\u2028",
            "\u0085",
            "\x00",
            "é",
            "🤖",
        ),
    ]
)


def survives(catalog: Registry, data: bytes, overrides: tuple[str, ...] = ()) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "m.yaml"
        path.write_bytes(data)
        shown = "nothing was run"
        try:
            load_mission(path, catalog, overrides, environ={})
        except MissionError as error:
            shown = str(error) if error.faults else "a refusal without a fault"
        assert shown.endswith("nothing was run")


@settings(deadline=None, max_examples=150)
@given(data=st.binary(max_size=200))
def test_any_bytes(catalog, data) -> None:
    survives(catalog, data)


@settings(deadline=None, max_examples=150)
@given(text=st.text(max_size=200))
def test_any_text(catalog, text) -> None:
    survives(catalog, text.encode(errors="replace"))


@settings(deadline=None, max_examples=300)
@given(data=st.data())
def test_a_mission_with_pieces_cut_out_and_others_put_in(catalog, good, data) -> None:
    text = good
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(text)))
        end = data.draw(st.integers(start, min(len(text), start + 12)))
        text = text[:start] + "".join(data.draw(st.lists(TOKENS, max_size=3))) + text[end:]
    survives(catalog, text.encode())


@settings(deadline=None, max_examples=200)
@given(line=st.integers(0, 30), other=st.integers(0, 30), indent=st.integers(0, 14))
def test_a_mission_with_lines_moved(catalog, good, line, other, indent) -> None:
    lines = good.splitlines()
    lines[line % len(lines)] = " " * indent + lines[other % len(lines)].strip()
    survives(catalog, "\n".join(lines).encode())


@settings(deadline=None, max_examples=150)
@given(
    name=st.text(max_size=10) | st.sampled_from(["stride", "start", "limits.speed", "world"]),
    value=st.text(max_size=20),
)
def test_any_override(catalog, good, name, value) -> None:
    survives(catalog, good.encode(), (f"{name}={value}",))


@pytest.mark.parametrize(
    "value",
    [
        "\ud800",
        "9" * 5000,
        "0x" + "f" * 500,
        "1_000",
        "1:30",
        ".inf",
        "=",
        "<<",
        "~nobody/x",
        "!!binary aGk=",
    ],
)
def test_odd_scalars(catalog, good, value) -> None:
    text = good.replace("default: 1.5 m", f"default: {value}")
    survives(catalog, text.encode(errors="surrogatepass"))
    survives(catalog, good.encode(), (f"stride={value}",))
    survives(catalog, good.encode(), (f"world={value}",))
