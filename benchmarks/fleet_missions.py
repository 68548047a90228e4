"""The missions and the world of the fleets of real processes."""

__all__ = ["CORRIDOR", "MEET", "MISSION", "ROBOT", "STARTS"]

MISSION = """\
format: explore-bt/1
name: fleet
include: [trees/complete.yaml]
robots:
  ada: {start: ADA, ROBOT}
  bob: {start: BOB, ROBOT}
team: {use: zenoh, multicast: false, TEAM}
limits: {time: 20 min}
tree: complete
"""
ROBOT = (
    "driver: {use: sim2d, world: world.yaml, radius: 0.25 m, lidar_range: 5 m}, "
    "slam: ground_truth, planner: skeleton, controller: pursuit"
)
CORRIDOR = """\
format: explore-bt-world/1
rooms:
  - {name: west, box: [0, 0, 4, 4]}
  - {name: corridor, box: [4, 1.5, 12, 2.5]}
  - {name: east, box: [12, 0, 16, 4]}
doors: [{name: w, at: [4, 2], width: 0.9}, {name: e, at: [12, 2], width: 0.9}]
start: [2, 2, 0]
"""
MEET = """\
format: explore-bt/1
name: meet
include: [trees/shared.yaml]
robots:
  ada: {start: [2 m, 2 m, 0 deg], tree: to_east, map: known/slam, ROBOT}
  bob: {start: [14 m, 2 m, 180 deg], tree: to_west, map: known/slam, ROBOT}
team: {use: zenoh, multicast: false, connect: [$env.FLEET_CONNECT], listen: [$env.FLEET_LISTEN]}
limits: {time: 5 min}
trees:
  to_east: {sequence: [choose_place: {x: 14, y: 2}, subtree: reach_goal]}
  to_west: {sequence: [choose_place: {x: 2, y: 2}, subtree: reach_goal]}
"""
STARTS = {"ADA": "[3.3 m, 3.6 m, 0 deg]", "BOB": "[3.3 m, 2.6 m, 0 deg]"}
