"""A mission in an empty room that is over in a few seconds of mission time."""

WORLD = """
format: explore-bt-world/1
name: box
start: [1.0, 1.0, 0 deg]
rooms:
  - {name: room, box: [0.0, 0.0, 6.0, 3.0]}
"""

MISSION = """
format: explore-bt/1
name: box
robots:
  robot:
    driver: {use: sim2d, world: box.yaml, radius: 0.2 m}
    slam: {use: ground_truth}
    planner: {use: grid_astar}
    controller: {use: pursuit}
limits: {time: 60 s}
tree: main
trees:
  main:
    sequence:
      - wait: {duration: 1 s}
        name: first
        timeout: 10 s
        retry: 1
      - fallback:
          - invert: wait_until_localised
          - subtree: rest
      - name: meet
        parallel: {success: 1, children: [{wait: {duration: 0.2 s}}, {wait: {duration: 9 s}}]}
      - choose_place: {x: 2.0 m, y: 1.5 m}
      - drive_to: {goal: $goal}
  rest:
    repeat: {times: 2, child: {wait: {duration: 0.3 s}}}
"""
