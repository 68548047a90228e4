// What happened when: the items of the timeline, by robot and by kind.

/** Index of the first stamp after `time`. */
export function after(stamps, time) {
  let low = 0, high = stamps.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (stamps[middle] <= time + 1e-6) low = middle + 1; else high = middle;
  }
  return low;
}

class RobotStory {
  poses = { stamps: [], x: [], y: [], yaw: [] };
  figures = { stamps: [], coverage: [], speed: [], distance: [] };
  nodes = new Map();
  changes = { stamps: [], ids: [] };
  braking = { stamps: [], on: [] };
}

/** Grows as the run goes on. */
export class Story {
  count = 0;
  robots = new Map();
  lines = [];

  constructor(names) {
    for (const name of names) this.robots.set(name, new RobotStory());
  }

  take(item) {
    const [kind, name, stamp, ...rest] = item;
    const robot = this.robots.get(name);
    this.count += 1;
    this[`_${kind}`]?.(robot, stamp, rest, name);
  }

  _pose(robot, stamp, [x, y, yaw]) {
    robot.poses.stamps.push(stamp); robot.poses.x.push(x); robot.poses.y.push(y); robot.poses.yaw.push(yaw);
  }
  _figures(robot, stamp, [coverage, speed, distance]) {
    const { figures } = robot;
    figures.stamps.push(stamp); figures.coverage.push(coverage); figures.speed.push(speed); figures.distance.push(distance);
  }
  _node(robot, stamp, [id, status, words], name) {
    if (!robot.nodes.has(id)) robot.nodes.set(id, { stamps: [], status: [], words: [] });
    const lane = robot.nodes.get(id), before = lane.status.at(-1) ?? "idle";
    lane.stamps.push(stamp); lane.status.push(status); lane.words.push(words);
    if (before !== status) { robot.changes.stamps.push(stamp); robot.changes.ids.push(id); }
    if (words && (status === "failure" || status === "success")) this._line(stamp, name, status, words, id);
  }
  _gate(robot, stamp, [braking]) {
    robot.braking.stamps.push(stamp); robot.braking.on.push(braking);  // in words it is an event
  }
  _visited(robot, stamp, [index, reason], name) { this._line(stamp, name, "visited", `waypoint ${index}: ${reason}`); }
  _health(robot, stamp, [health, reason], name) { this._line(stamp, name, health === "ok" ? "info" : "warning", `SLAM ${health}${reason ? `: ${reason}` : ""}`); }
  _event(robot, stamp, [level, source, message], name) { this._line(stamp, name, level, message, null, source); }

  /** What several say at once (a leaf, the nodes above it, an event) is said once, by the leaf. */
  _line(stamp, robot, kind, words, id = null, source = "") {
    for (let i = this.lines.length - 1; i >= 0 && this.lines[i].stamp === stamp; i--) {
      const said = this.lines[i];
      if (said.robot !== robot || said.words !== words) continue;
      if (id !== null) said.id = id;
      return;
    }
    this.lines.push({ stamp, robot, kind, words, id, source });
  }

  /** Status and reason of a node at a time, with when that began. */
  nodeAt(name, id, time) {
    const lane = this.robots.get(name)?.nodes.get(id);
    const index = lane ? after(lane.stamps, time) - 1 : -1;
    return index < 0 ? null : { status: lane.status[index], words: lane.words[index], since: lane.stamps[index] };
  }

  /** The next or the previous moment at which a node's status changed; null where there is none. */
  changeFrom(name, time, forward) {
    const { stamps } = this.robots.get(name).changes;
    if (forward) return stamps[after(stamps, time)] ?? null;
    let index = after(stamps, time) - 1;
    while (index >= 0 && stamps[index] >= time - 1e-3) index -= 1;
    return stamps[index] ?? null;
  }
}
