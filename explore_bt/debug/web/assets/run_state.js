// Where a run is at one moment, built up from the messages of the recording.

/** One robot: the same parts as explore_bt.recording.RobotState. */
class RobotState {
  tick = -1;
  nodes = [];
  board = {};
  visited = [];
  newest = {};

  take(part, value) {
    if (part === "tree") {
      this.tick = value.tick;
      for (const node of value.nodes) this.nodes[node.id] = node;
    } else if (part === "blackboard") {
      this.board = value.key_frame ? { ...value.set } : { ...this.board, ...value.set };
      for (const name of value.removed) delete this.board[name];
    } else if (part === "visited") {
      this.visited = [...this.visited.slice(0, value.index), value];
    } else {
      this.newest[part] = value;
    }
  }
}

/** All robots at one moment. */
export class RunState {
  robots = new Map();

  constructor(names) {
    for (const name of names) this.robots.set(name, new RobotState());
  }

  /** Takes in one message. */
  take([topic, , value]) {
    const end = topic.lastIndexOf("/");
    this.robots.get(topic.slice(1, end))?.take(topic.slice(end + 1), value);
  }
}

/** x, y and heading of a Foxglove pose; null where it is not known. */
export function flat(pose) {
  if (!pose || pose.position.x === null) return null;
  return { x: pose.position.x, y: pose.position.y, yaw: 2 * Math.atan2(pose.orientation.z, pose.orientation.w) };
}
