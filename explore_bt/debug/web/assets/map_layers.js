// What is drawn over the grid, one function a layer.

import { frameOf, moved, turned } from "./mate_frames.js";
import { flat } from "./run_state.js";

export const LAYERS = {
  scan: "Scan", driven: "Driven path", path: "Planned path", waypoints: "Waypoints", sectors: "Free sectors",
  "half-planes": "Half-planes", frontiers: "Frontiers", views: "Views", people: "People", claims: "Claims", robots: "Other robots", maps: "Their maps", truth: "True pose",
};

const MOST_POSES = 4000;
const HALF_M = 1.2;  // of a half-plane's line, to either side

/** Draws what is switched on, the farthest back first. */
export function drawLayers(map) {
  const { scene, picked, layers } = map;
  const drawing = picked.state.newest.drawing?.layers ?? {};
  if (layers.has("scan")) scan(map, picked.state.newest.scan);
  if (layers.has("sectors")) (drawing.sectors ?? []).forEach((each) => sector(map, each));
  if (layers.has("half-planes")) (drawing.half_planes ?? []).forEach((each) => halfPlane(map, each));
  const there = scene.robots.filter((robot) => robot === picked || layers.has("robots")).map((robot) => [robot, frameOf(picked, robot).T]);
  const shown = there.filter(([, T]) => T).map(([robot, T]) => [robot, { ...map, at: (x, y) => map.at(...moved(T, x, y)) }, T]);
  if (layers.has("driven")) shown.forEach(([robot, its]) => driven(its, robot));
  if (layers.has("frontiers")) (drawing.frontiers ?? []).forEach((each) => frontier(map, each));
  if (layers.has("views")) (drawing.views ?? []).forEach((each) => view(map, each));
  if (layers.has("path")) planned(map, picked.state.newest.path);
  if (layers.has("waypoints")) waypoints(map, picked.state);
  if (layers.has("claims")) shown.forEach(([robot, its]) => (robot.state.newest.team?.claims ?? []).forEach((each) => claim(its, robot, each)));
  if (layers.has("people")) (picked.state.newest.moving?.things ?? []).forEach((each) => person(map, each));
  if (layers.has("truth")) shown.forEach(([robot, , T]) => body(map, robot, turned(T, flat(robot.state.newest.truth?.pose)), true));
  shown.forEach(([robot, , T]) => body(map, robot, turned(T, flat(robot.state.newest.pose?.pose)), false));
}

function scan({ pen, at, palette }, message) {
  const pose = flat(message?.pose);
  if (!pose) return;
  const { ranges, start_angle: start, end_angle: end, range_max: far } = message;
  const step = ranges.length > 1 ? (end - start) / (ranges.length - 1) : 0;
  const [ox, oy] = at(pose.x, pose.y);
  pen.beginPath();
  pen.moveTo(ox, oy);
  const hits = [];
  ranges.forEach((range, index) => {
    if (range === null) return;
    const angle = pose.yaw + start + index * step, length = Number.isFinite(range) ? range : far ?? 0;
    const spot = at(pose.x + length * Math.cos(angle), pose.y + length * Math.sin(angle));
    pen.lineTo(...spot);
    if (Number.isFinite(range)) hits.push(spot);
  });
  pen.closePath();
  pen.fillStyle = palette.scan;
  pen.globalAlpha = 0.09;
  pen.fill();
  pen.globalAlpha = 1;
  for (const [x, y] of hits) pen.fillRect(x - 1, y - 1, 2, 2);
}

function driven({ pen, at, until, palette }, robot) {
  const { x, y } = robot.story.poses, count = until(robot);
  if (count < 2) return;
  pen.beginPath();
  const every = Math.ceil(count / MOST_POSES);
  for (let i = 0; i < count; i += every) pen.lineTo(...at(x[i], y[i]));
  pen.lineTo(...at(x[count - 1], y[count - 1]));
  pen.strokeStyle = palette[robot.colour];
  pen.globalAlpha = 0.75;
  pen.lineWidth = 1.6;
  pen.lineJoin = "round";
  pen.stroke();
  pen.globalAlpha = 1;
}

function planned({ pen, at, palette }, message) {
  const poses = message?.poses ?? [];
  if (poses.length < 2) return;
  pen.beginPath();
  for (const { position } of poses) pen.lineTo(...at(position.x, position.y));
  pen.strokeStyle = palette.planned;
  pen.lineWidth = 2.4;
  pen.setLineDash([7, 5]);
  pen.stroke();
  pen.setLineDash([]);
}

function waypoints({ pen, at, palette, spots }, state) {
  state.visited.forEach((visited, index) => {
    const pose = flat(visited.pose);
    if (!pose) return;
    const [x, y] = at(pose.x, pose.y);
    pen.fillStyle = palette.panel;
    pen.strokeStyle = palette.waypoint;
    pen.lineWidth = 1.4;
    pen.beginPath();
    pen.moveTo(x, y);
    pen.lineTo(x + 9 * Math.cos(pose.yaw), y - 9 * Math.sin(pose.yaw));
    pen.stroke();
    disc(pen, x, y, 3.2);
    spots.push({ x, y, words: `waypoint ${index}: ${visited.reason}` });
  });
  const goal = state.newest.waypoint, pose = flat(goal?.pose);
  if (!pose || !state.board.goal) return;
  const [x, y] = at(pose.x, pose.y);
  pen.strokeStyle = pen.fillStyle = palette.planned;
  pen.lineWidth = 2.2;
  pen.beginPath();
  pen.arc(x, y, 7, 0, 2 * Math.PI);
  pen.moveTo(x + 7 * Math.cos(pose.yaw), y - 7 * Math.sin(pose.yaw));
  pen.lineTo(x + 15 * Math.cos(pose.yaw), y - 15 * Math.sin(pose.yaw));
  pen.stroke();
  spots.push({ x, y, words: `goal: ${goal.reason}` });
}

function sector({ pen, at, scale, palette, spots }, each) {
  const [x, y] = at(each.x, each.y), radius = (each.range_m ?? 5) * scale, colour = palette[each.state] ?? palette.open;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.arc(x, y, radius, -each.from_rad, -each.to_rad, true);
  pen.closePath();
  pen.fillStyle = pen.strokeStyle = colour;
  pen.globalAlpha = each.state === "taken" ? 0.24 : 0.1;
  pen.fill();
  pen.globalAlpha = 0.9;
  pen.lineWidth = each.state === "taken" ? 1.8 : 1;
  pen.setLineDash(each.state === "rejected" ? [3, 3] : []);
  pen.stroke();
  pen.setLineDash([]);
  pen.globalAlpha = 1;
  const middle = (each.from_rad + each.to_rad) / 2;
  spots.push({ x: x + 0.7 * radius * Math.cos(middle), y: y - 0.7 * radius * Math.sin(middle), words: judged(each, "sector"), covers: (px, py) => within(each, radius, px - x, y - py) });
}

/** Whether a place, in pixels from the robot and upwards, lies in a sector. */
function within({ from_rad: from, to_rad: to }, radius, dx, dy) {
  const turn = 2 * Math.PI, beyond = ((Math.atan2(dy, dx) - from) % turn + turn) % turn;
  return Math.hypot(dx, dy) < radius && beyond <= to - from;
}

/** The line, hatched on the side that lies behind. */
function halfPlane({ pen, at, palette, spots }, { x, y, normal_x: nx, normal_y: ny }) {
  const along = (far, back) => at(x - far * ny - back * nx, y + far * nx - back * ny);
  pen.strokeStyle = palette.plane;
  pen.lineWidth = 1.6;
  pen.beginPath();
  pen.moveTo(...along(-HALF_M, 0));
  pen.lineTo(...along(HALF_M, 0));
  pen.stroke();
  pen.lineWidth = 1;
  pen.beginPath();
  for (let far = -HALF_M; far <= HALF_M + 1e-6; far += HALF_M / 8) {
    pen.moveTo(...along(far, 0));
    pen.lineTo(...along(far - 0.08, 0.11));
  }
  pen.stroke();
  for (const far of [-1, -0.5, 0.5, 1]) {
    const [sx, sy] = along(far * HALF_M, 0);
    spots.push({ x: sx, y: sy, words: "half-plane: what lies on the hatched side is behind" });
  }
}

function frontier({ pen, at, palette, spots }, each) {
  const [x, y] = at(each.x, each.y), size = each.state === "taken" ? 7 : 5;
  pen.beginPath();
  pen.moveTo(x, y - size); pen.lineTo(x + size, y); pen.lineTo(x, y + size); pen.lineTo(x - size, y);
  pen.closePath();
  pen.fillStyle = each.state === "rejected" ? palette.panel : palette[each.state] ?? palette.open;
  pen.strokeStyle = each.state === "rejected" ? palette.rejected : palette.panel;
  pen.lineWidth = each.state === "rejected" ? 1.6 : 1;
  pen.fill();
  pen.stroke();
  spots.push({ x, y, words: judged(each, `frontier${each.size_m ? `, ${each.size_m.toFixed(1)} m` : ""}`) });
}

/** A place with what can be seen from it: a dot, and a wedge that opens that way. */
function view({ pen, at, palette, spots }, each) {
  if (each.x === null || each.y === null) return;
  const [x, y] = at(each.x, each.y), yaw = each.yaw_rad ?? 0, far = each.state === "taken" ? 20 : 14;
  pen.fillStyle = pen.strokeStyle = palette[each.state] ?? palette.open;
  pen.beginPath();
  pen.moveTo(x, y);
  pen.arc(x, y, far, -yaw - 0.5, -yaw + 0.5);
  pen.closePath();
  pen.globalAlpha = 0.3;
  pen.fill();
  pen.globalAlpha = 1;
  pen.lineWidth = each.state === "taken" ? 1.6 : 1;
  if (each.state === "taken") pen.stroke();
  pen.beginPath();
  pen.arc(x, y, 3, 0, 2 * Math.PI);
  if (each.state === "rejected") pen.stroke(); else pen.fill();
  spots.push({ x, y, words: judged(each, `view${each.gain_m2 ? `, ${each.gain_m2.toFixed(1)} m² to see` : ""}`) });
}

/** Where a robot goes to look: a ring in its colour, as its team knows it. */
function claim({ pen, at, palette, spots }, robot, place) {
  const [x, y] = at(...place);
  pen.strokeStyle = palette[robot.colour];
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(x, y, 8, 0, 2 * Math.PI);
  pen.stroke();
  spots.push({ x, y, words: `claimed by ${robot.name}` });
}

/** What was decided about a mark, and why. */
function judged({ state, reason }, what) { return `${state} ${what}${reason ? `: ${reason}` : ""}`; }

/** A disc where it was seen, an arrow to where it is in a second if it goes on so. */
function person({ pen, at, scale, time, palette, spots }, each) {
  const [x, y] = at(each.x, each.y), [tx, ty] = at(each.x + each.vx_mps, each.y + each.vy_mps), radius = Math.max(each.radius_m * scale, 5);
  pen.fillStyle = pen.strokeStyle = palette.person;
  pen.lineWidth = 2;
  pen.globalAlpha = 0.3;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
  pen.globalAlpha = 1;
  pen.stroke();
  const speed = Math.hypot(each.vx_mps, each.vy_mps), ago = time - each.seen_s;
  if (speed > 0.05) {
    const way = Math.atan2(ty - y, tx - x);
    pen.beginPath();
    pen.moveTo(x, y); pen.lineTo(tx, ty);
    pen.moveTo(tx - 7 * Math.cos(way - 0.5), ty - 7 * Math.sin(way - 0.5)); pen.lineTo(tx, ty);
    pen.lineTo(tx - 7 * Math.cos(way + 0.5), ty - 7 * Math.sin(way + 0.5));
    pen.stroke();
  }
  spots.push({ x, y, words: `somebody, ${speed > 0.05 ? `${speed.toFixed(1)} m/s` : "standing"}${ago > 0.5 ? `, seen ${ago.toFixed(1)} s ago` : ""}`, covers: (px, py) => Math.hypot(px - x, py - y) < radius });
}

function body({ pen, at, scale, palette, spots }, robot, pose, ghost) {
  if (!pose) return;
  const [x, y] = at(pose.x, pose.y), radius = Math.max(robot.radius * scale, 4), braking = robot.state.newest.gate?.braking;
  pen.lineWidth = braking ? 3 : 2;
  pen.strokeStyle = braking ? palette.failure : palette[robot.colour];
  pen.fillStyle = palette[robot.colour];
  pen.globalAlpha = ghost ? 0.4 : 1;
  if (ghost) pen.setLineDash([3, 3]);
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  if (!ghost) { pen.globalAlpha = 0.28; pen.fill(); pen.globalAlpha = 1; }
  pen.stroke();
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(x + radius * Math.cos(pose.yaw), y - radius * Math.sin(pose.yaw));
  pen.stroke();
  pen.setLineDash([]);
  pen.globalAlpha = 1;
  if (!ghost) spots.push({ x, y, words: braking ? `${robot.name} brakes: ${robot.state.newest.gate.reason}` : robot.name });
}

function disc(pen, x, y, radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
  pen.stroke();
}
