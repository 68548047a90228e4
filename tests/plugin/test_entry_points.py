from __future__ import annotations

from explore_bt.plugin import Registry
from explore_bt.plugin.manager import load_entry_points


def broken_of(site) -> dict[str, str]:
    registry = Registry()
    load_entry_points(registry, site.entry_points)
    return {each.name: each.reason for each in registry.broken}


def test_a_plugin_is_registered_with_distribution_module_and_version(site):
    site.install_leaf("acme", "acme_leaves", "ready")
    registry = Registry()
    load_entry_points(registry, site.entry_points)
    (entry,) = registry.entries()
    assert (entry.name, entry.origin, entry.version) == ("ready", "acme (acme_leaves)", "1.2")
    assert registry.broken == ()


def test_a_broken_plugin_is_named_and_the_others_live(site):
    site.install("broken", "broken_module", "raise RuntimeError('no licence')")
    site.install_leaf("sound", "sound_module", "ready")
    registry = Registry()
    load_entry_points(registry, site.entry_points)
    assert registry.names("behaviour") == ("ready",)
    (broken,) = registry.broken
    assert (broken.name, broken.origin) == ("broken-entry", "broken (broken_module)")
    assert broken.reason == f"RuntimeError: no licence ({site.folder}/broken_module.py:1)"


def test_a_missing_module_of_an_extra_says_what_to_type(site):
    requires = 'Requires-Dist: no_such_physics>=3 ; extra == "physics"\n'
    site.install("acme", "acme_driver", "import no_such_physics.viewer", requires)
    assert broken_of(site) == {
        "acme-entry": "it needs the module no_such_physics, which is not installed; "
        'type pip install "acme[physics]"'
    }


def test_a_missing_module_of_no_extra_is_named(site):
    site.install("acme", "acme_driver", "import no_such_physics")
    assert broken_of(site) == {"acme-entry": "it needs the module no_such_physics, which is not installed"}


def test_what_a_plugin_itself_says_about_a_missing_module_is_kept(site):
    code = """
        raise ModuleNotFoundError('mujoco is missing: pip install "explore-bt[mujoco]"', name="mujoco")
    """
    site.install("acme", "acme_driver", code)
    reason = broken_of(site)["acme-entry"]
    assert 'mujoco is missing: pip install "explore-bt[mujoco]"' in reason


def test_a_plugin_that_ends_the_program_does_not_end_the_host(site):
    site.install("quitter", "quitter_module", "import sys\n\nsys.exit(3)")
    assert broken_of(site) == {
        "quitter-entry": f"it ended the program when it was loaded ({site.folder}/quitter_module.py:3)"
    }


def test_a_raising_hook_is_named_with_its_line(site):
    code = """\
        from explore_bt import hookimpl

        @hookimpl
        def explore_bt_register():
            return 1 / 0
    """
    site.install("acme", "acme_hook", code)
    assert broken_of(site) == {
        "acme-entry": f"ZeroDivisionError: division by zero ({site.folder}/acme_hook.py:5)"
    }


def test_a_misspelt_hook_gets_a_suggestion(site):
    code = """
        from explore_bt import hookimpl

        @hookimpl
        def explore_bt_registr():
            return []
    """
    site.install("acme", "acme_misspelt", code)
    assert broken_of(site) == {
        "acme-entry": "there is no hook explore_bt_registr; did you mean explore_bt_register?"
    }


def test_a_hook_that_wants_arguments_is_refused(site):
    code = """
        from explore_bt import hookimpl

        @hookimpl
        def explore_bt_register(registry):
            return []
    """
    site.install("acme", "acme_greedy", code)
    assert "explore_bt_register" in broken_of(site)["acme-entry"]
    assert "registry" in broken_of(site)["acme-entry"]


def test_a_module_without_a_hook_is_told_how_to_write_one(site):
    site.install("acme", "acme_empty", "'''Nothing here.'''")
    assert broken_of(site) == {
        "acme-entry": "registers nothing: define explore_bt_register() and mark it with @explore_bt.hookimpl"
    }


def test_a_hook_that_returns_no_list_is_refused(site):
    code = """
        from explore_bt import hookimpl

        @hookimpl
        def explore_bt_register():
            return 7
    """
    site.install("acme", "acme_seven", code)
    assert broken_of(site) == {"acme-entry": "explore_bt_register returned 7; expected a list of classes"}


def test_the_second_owner_of_a_name_is_left_out(site):
    site.install_leaf("anna", "anna_leaves", "ready")
    site.install_leaf("berta", "berta_leaves", "ready")
    assert broken_of(site) == {
        "berta-entry": 'the behaviour "ready" has two owners: anna (anna_leaves) (Ready) and '
        "berta (berta_leaves) (Ready); rename one of them"
    }


def test_the_frameworks_own_distribution_comes_first_and_keeps_its_names(site):
    site.install_leaf("acme", "acme_leaves", "ready")
    site.install_leaf("explore-bt", "own_leaves", "ready")
    registry = Registry()
    load_entry_points(registry, site.entry_points)
    assert registry.entries()[0].origin == "explore-bt (own_leaves)"
    assert [each.name for each in registry.broken] == ["acme-entry"]
