"""What ``explore-bt new-plugin`` writes: one working module per kind, and one test for it.

The modules are real code, checked and tested like all other; only the names ``MyPlugin`` and
``my_plugin`` are replaced.
"""
