from __future__ import annotations

import pytest

from explore_bt.errors import PluginError
from explore_bt.interfaces import API_VERSION, PluginOptions, RunInfo, Sink, TickSnapshot
from explore_bt.plugin import KINDS, BrokenPlugin, Registry
from explore_bt.tree import Leaf, Status
from explore_bt.types import Result


class Ready(Leaf):
    """Is ready at once.

    And says no more than that.
    """

    type_key = "ready"

    def update(self) -> Status:
        return Status.SUCCESS


class Deaf(Sink):
    """Hears nothing."""

    name = "deaf"
    api_version = API_VERSION

    def open(self, run: RunInfo) -> None: ...

    def on_tick(self, tick: TickSnapshot) -> None: ...

    def close(self, result: Result | None) -> None: ...


def refusal(cls: object) -> str:
    with pytest.raises(PluginError) as refused:
        Registry().add(cls, "acme (acme.plugins)")  # type: ignore[arg-type]  # wrong on purpose
    return str(refused.value)


def test_a_leaf_is_found_by_its_type_key_and_others_by_their_name():
    registry = Registry()
    registry.add(Ready, "acme")
    registry.add(Deaf, "acme")
    assert registry.get("behaviour", "ready") is Ready
    assert registry.get("sink", "deaf") is Deaf


def test_an_entry_says_who_brought_the_class_and_what_it_is():
    registry = Registry()
    registry.add(Ready, "acme (acme.plugins)", "1.2")
    (entry,) = registry.entries()
    assert (entry.kind, entry.name, entry.origin) == ("behaviour", "ready", "acme (acme.plugins)")
    assert (entry.version, entry.doc) == ("1.2", "Is ready at once.")


def test_names_are_sorted_and_of_one_kind_only():
    registry = Registry()
    for key in ("walk", "ask", "ready"):
        registry.add(type("L", (Ready,), {"type_key": key}), "acme")
    registry.add(Deaf, "acme")
    assert registry.names("behaviour") == ("ask", "ready", "walk")
    assert registry.names("planner") == ()


def test_entries_come_by_kind_then_by_name():
    registry = Registry()
    for cls in (Deaf, type("Z", (Ready,), {"type_key": "z"}), type("A", (Ready,), {"type_key": "a"})):
        registry.add(cls, "acme")
    assert [(entry.kind, entry.name) for entry in registry.entries()] == [
        ("behaviour", "a"),
        ("behaviour", "z"),
        ("sink", "deaf"),
    ]


def test_two_registries_do_not_meet():
    registry = Registry()
    registry.add(Ready, "acme")
    assert Registry().entries() == ()


def test_a_second_owner_of_a_name_is_refused_and_both_are_named():
    registry = Registry()
    registry.add(Ready, "acme (acme.plugins)")
    other = type("AlsoReady", (Ready,), {})
    with pytest.raises(PluginError) as refused:
        registry.add(other, "/missions/explore_bt_inline.py")
    assert str(refused.value) == (
        'the behaviour "ready" has two owners: acme (acme.plugins) (Ready) and '
        "/missions/explore_bt_inline.py (AlsoReady); rename one of them"
    )
    assert registry.get("behaviour", "ready") is Ready


def test_a_plugin_is_registered_whole_or_not_at_all():
    registry = Registry()
    with pytest.raises(PluginError):
        registry.add_all([Ready, int], "acme")
    assert registry.entries() == ()


def test_an_object_is_refused():
    assert (
        refusal(3)
        == "acme (acme.plugins): 3 is not a class; explore_bt_register returns classes, not objects"
    )


def test_a_class_of_no_kind_is_refused():
    assert refusal(int).startswith("acme (acme.plugins): int has no kind; derive it from one of explore_bt.")


def test_a_class_of_unknown_kind_is_refused():
    radio = type("Radio", (), {"kind": "radio", "name": "radio", "api_version": API_VERSION})
    assert "Radio is of unknown kind 'radio'; derive it from one of" in refusal(radio)


def test_a_class_that_only_claims_its_kind_is_refused():
    claims = type("Claims", (), {"kind": "planner", "name": "claims", "api_version": API_VERSION})
    assert refusal(claims) == (
        'acme (acme.plugins): Claims says kind = "planner" but does not derive from '
        "explore_bt.interfaces.Planner"
    )


def test_a_class_with_abstract_methods_left_is_refused_with_their_names():
    half = type("Half", (Sink,), {"name": "half", "api_version": API_VERSION, "open": lambda self, run: None})
    assert refusal(half) == (
        "acme (acme.plugins): Half lacks close, on_tick: explore_bt.interfaces.Sink asks for every one of "
        "them"
    )


def test_a_class_without_a_name_is_refused():
    nameless = type("Nameless", (Leaf,), {"update": lambda self: Status.SUCCESS})
    assert refusal(nameless) == (
        'acme (acme.plugins): Nameless has no type_key; write type_key = "..." in the class'
    )


@pytest.mark.parametrize("name", ["two words", "drive-to", "$goal", "7up"])
def test_a_name_that_a_mission_cannot_write_is_refused(name):
    odd = type("Odd", (Deaf,), {"name": name})
    assert refusal(odd) == (
        f'acme (acme.plugins): Odd is called "{name}"; a name is made of letters, digits and underscores'
    )


def test_a_class_without_an_api_version_is_refused():
    body = {name: lambda *_: None for name in ("open", "on_tick", "close")}
    old = type("Old", (Sink,), {"name": "old", **body})
    assert (
        refusal(old)
        == f"acme (acme.plugins): Old has no api_version; write api_version = {API_VERSION} in the class"
    )


def test_a_class_for_another_version_of_the_contracts_is_refused():
    old = type("Old", (Deaf,), {"api_version": 99})
    assert refusal(old) == (
        "acme (acme.plugins): Old was written for version 99 of the plugin contracts, this explore-bt has "
        f"version {API_VERSION}; install versions that fit together"
    )


def test_options_of_another_base_are_refused():
    odd = type("Odd", (Deaf,), {"Options": dict})
    assert refusal(odd) == (
        "acme (acme.plugins): Odd.Options does not derive from explore_bt.interfaces.PluginOptions"
    )
    assert issubclass(Deaf.Options, PluginOptions)


def test_an_unknown_name_gets_a_suggestion_and_the_names_there_are():
    registry = Registry()
    registry.add(Ready, "acme")
    with pytest.raises(PluginError) as unknown:
        registry.get("behaviour", "redy")
    assert str(unknown.value) == (
        'no behaviour is called "redy"; did you mean "ready"? Installed: ready. '
        "See explore-bt plugins --kind behaviour"
    )


def test_an_unknown_name_among_none_says_so():
    with pytest.raises(PluginError) as unknown:
        Registry().get("slam", "mine")
    assert str(unknown.value) == (
        'no slam is called "mine". No slam is installed. See explore-bt plugins --kind slam'
    )


def test_an_unknown_name_is_explained_by_the_plugin_that_was_left_out():
    registry = Registry()
    registry.set_aside(BrokenPlugin("mujoco", "explore-bt (explore_bt_mujoco)", "it needs the module mujoco"))
    with pytest.raises(PluginError) as unknown:
        registry.get("driver", "mujoco")
    assert "Left out: mujoco (it needs the module mujoco)." in str(unknown.value)


def test_an_unknown_kind_is_not_taken_for_an_empty_one():
    with pytest.raises(PluginError) as unknown:
        Registry().get("motor", "m")
    assert str(unknown.value) == f'there is no plugin kind "motor"; kinds are {", ".join(KINDS)}'
