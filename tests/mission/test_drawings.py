from __future__ import annotations

from explore_bt.mission import show_dot, show_text

TEXT = """\
flat  A small flat.

params
  world   worlds/flat.yaml    what the simulator shows
  start   [1 m, 2 m, 90 deg]
  slam    icp
  stride  1.5 m

robot robot  driver sim · slam icp · planner lines · controller pursuit
  start  [1 m, 2 m, 90 deg]

explore  [sequence]
├─ until nothing is left  [fallback]
│  ├─ look  half_planes=all  stride=1.5 m  goal→$goal
│  └─ drive  goal=$goal  (timeout 60 s)  (retry 2)
│     └─ on_failure: reset
└─ go_home  [subtree]
   └─ sequence
      ├─ home
      └─ drive  goal=$goal
"""


def test_the_text_drawing_shows_parameters_ports_and_modifiers(load) -> None:
    assert show_text(load()) == TEXT


def test_conditions_settings_and_what_is_not_given_are_drawn(load, good) -> None:
    text = good.replace("sequence: [home,", "name: both\n    if: {invert: reset}\n    parallel: [home,")
    text = text.replace("retry: 2", "if: not $goal").replace("[1.0 m, 2.0 m, 90 deg]", "null")
    drawing = show_text(load(text))
    assert "  start   not given" in drawing
    assert "both  [parallel]  success all  failure 1\n" in drawing
    assert "├─ if: invert\n" in drawing
    assert "(timeout 60 s)  (if not $goal)\n" in drawing


def test_the_graph_has_a_node_for_each_and_an_edge_for_all_but_the_root(load) -> None:
    mission = load()
    graph = show_dot(mission)
    nodes = list(mission.robots[0].tree.walk())
    assert graph.startswith('digraph "flat" {')
    assert graph.count(" [label=") == len(nodes)
    assert graph.count(" -> ") == len(nodes) - 1
    assert '"robot:explore/go_home" -> "robot:explore/go_home/sequence";' in graph
    assert "[style=dashed label=" in graph


def test_quotes_in_names_do_not_break_the_graph(load, good) -> None:
    graph = show_dot(load(good.replace("name: until nothing is left", "name: 'a \"b\" c'")))
    assert r'"robot:explore/a \"b\" c"' in graph
