// The timeline: events, curves, and when each leaf ran; dragged to scrub, wheeled to zoom.

import { colours, fitted, watch } from "./dom.js";
import { after } from "./story.js";
import { clock } from "./words.js";

const TOP = 18, CURVES = 44, LANE = 13, AXIS = 18;
const GROWS_EVERY_MS = 400;  // while a run goes on: all of it is drawn anew then
const LEVELS = { warning: "warn", error: "failure" };

/** Draws one robot's story; `onSeek(time)` while it is dragged. */
export class TimelineView {
  lanes = [];

  #canvas;
  #palette;
  #scene = null;
  #window = null;
  #dragging = false;
  #drawn = { key: "", at: -Infinity, end: 0, count: 0, later: 0, canvas: document.createElement("canvas") };

  constructor(canvas, onSeek) {
    this.#canvas = canvas;
    this.onSeek = onSeek;
    this.#readColours();
    watch(canvas, () => { this.#readColours(); this.draw(); });
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); this.#dragging = true; this.#seekTo(event); });
    canvas.addEventListener("pointermove", (event) => { if (this.#dragging) this.#seekTo(event); });
    for (const type of ["pointerup", "pointercancel"]) canvas.addEventListener(type, () => { this.#dragging = false; });
    canvas.addEventListener("wheel", (event) => this.#onWheel(event), { passive: false });
    canvas.addEventListener("dblclick", () => { this.#window = null; this.draw(); });
  }

  /** `scene`: begin, end, time, robot {name, story, nodes, parents}, picked node, lines, count of the story. */
  show(scene) {
    const drawn = this.#drawn, wait = drawn.at + GROWS_EVERY_MS - performance.now();
    clearTimeout(drawn.later);
    if (wait > 0 && scene.count !== drawn.count && scene.robot.name === this.#scene?.robot.name) {
      const whole = scene;
      drawn.later = setTimeout(() => this.show(whole), wait);
      scene = { ...scene, end: drawn.end, count: drawn.count, time: Math.min(scene.time, drawn.end) };
    }
    this.#scene = scene;
    this.draw();
  }

  get #gutter() { return this.#canvas.clientWidth < 620 ? 0 : 138; }

  get #span() {
    const { begin, end } = this.#scene;
    return this.#window ?? [begin, Math.max(end, begin + 1)];
  }

  #x(time) {
    const [from, to] = this.#span, left = this.#gutter + 8;
    return left + (time - from) / (to - from) * (this.#canvas.clientWidth - left - 12);
  }

  #time(x) {
    const [from, to] = this.#span, left = this.#gutter + 8;
    return from + (x - left) / (this.#canvas.clientWidth - left - 12) * (to - from);
  }

  #seekTo(event) {
    if (!this.#scene) return;
    const near = event.offsetY < TOP && this.#scene.lines.find((line) => line.kind in LEVELS && Math.abs(this.#x(line.stamp) - event.offsetX) < 4);
    const time = near ? near.stamp : this.#time(event.offsetX);
    this.onSeek(Math.min(Math.max(time, this.#scene.begin), this.#scene.end));
  }

  #onWheel(event) {
    event.preventDefault();
    const { begin, end } = this.#scene, [from, to] = this.#span, here = this.#time(event.offsetX);
    const factor = Math.exp(event.deltaY * 0.0015), size = Math.min(Math.max((to - from) * factor, 2), end - begin);
    if (size >= end - begin - 1e-6) { this.#window = null; return this.draw(); }
    const first = Math.min(Math.max(here - (here - from) / (to - from) * size, begin), end - size);
    this.#window = [first, first + size];
    this.draw();
  }

  draw() {
    const scene = this.#scene, width = this.#canvas.clientWidth, height = this.#canvas.clientHeight;
    if (!scene || !width) return;
    this.#keepInSight();
    const pen = fitted(this.#canvas), { begin, end, picked, robot, count } = scene;
    const key = [width, height, this.#canvas.width, ...this.#span, begin, end, picked, robot.name, count, this.#palette.ink].join();
    if (key !== this.#drawn.key) this.#drawBehind(key, width, height);
    pen.clearRect(0, 0, width, height);
    pen.drawImage(this.#drawn.canvas, 0, 0, width, height);
    this.#drawHead(pen, height);
  }

  /** All but the head, which alone moves while a recording is scrubbed. */
  #drawBehind(key, width, height) {
    const { canvas } = this.#drawn;
    Object.assign(canvas, { width: this.#canvas.width, height: this.#canvas.height });
    Object.assign(this.#drawn, { key, at: performance.now(), end: this.#scene.end, count: this.#scene.count });
    const pen = canvas.getContext("2d");
    pen.scale(canvas.width / width, canvas.height / height);
    pen.font = "11px system-ui, sans-serif";
    pen.textBaseline = "middle";
    this.#drawAxis(pen, width, height);
    this.#drawMarks(pen);
    this.#drawCurves(pen, width);
    this.#drawLanes(pen, width, height);
  }

  #keepInSight() {
    if (!this.#window) return;
    const [from, to] = this.#window, { time, end } = this.#scene;
    if (time >= from && time <= to) return;
    const size = to - from, first = Math.max(this.#scene.begin, Math.min(time - size * (time > to ? 0.8 : 0.2), end - size));
    this.#window = [first, first + size];
  }

  #drawAxis(pen, width, height) {
    const [from, to] = this.#span, room = (width - this.#gutter) / 90;
    const step = [0.1, 0.5, 1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 1800, 3600].find((each) => (to - from) / each <= room) ?? 7200;
    pen.strokeStyle = this.#palette.line;
    pen.fillStyle = this.#palette.soft;
    pen.lineWidth = 1;
    pen.textAlign = "center";
    for (let time = Math.ceil(from / step) * step; time <= to; time += step) {
      const x = Math.round(this.#x(time)) + 0.5;
      pen.beginPath(); pen.moveTo(x, TOP); pen.lineTo(x, height - AXIS); pen.stroke();
      pen.fillText(clock(time, step < 1 ? 1 : 0), Math.min(Math.max(x, 16), width - 18), height - AXIS / 2);
    }
  }

  #drawMarks(pen) {
    const { robot, lines } = this.#scene, [from, to] = this.#span;
    const { stamps, on } = robot.story.braking;
    pen.fillStyle = this.#palette.failure;
    pen.globalAlpha = 0.22;
    for (let i = 0; i < stamps.length; i++) {
      if (!on[i] || (i && on[i - 1] && stamps[i] < from)) continue;
      const x = this.#x(stamps[i]), wide = Math.max(this.#x(stamps[i + 1] ?? this.#scene.end) - x, 1.5);
      if (x + wide > this.#gutter + 8) pen.fillRect(x, TOP - 4, wide, CURVES + 6);
    }
    pen.globalAlpha = 1;
    for (const { stamp, kind, robot: name } of lines) {
      if (stamp < from || stamp > to || (name && name !== robot.name)) continue;
      const x = this.#x(stamp);
      if (kind === "visited") { pen.fillStyle = this.#palette.waypoint; pen.fillRect(x - 0.5, 9, 1, 6); }
      if (!(kind in LEVELS)) continue;
      pen.fillStyle = this.#palette[LEVELS[kind]];
      pen.beginPath();
      if (kind === "error") pen.rect(x - 3, 4, 6, 9); else { pen.moveTo(x - 4, 4); pen.lineTo(x + 4, 4); pen.lineTo(x, 13); }
      pen.fill();
    }
    this.#label(pen, "events", 9);
  }

  #drawCurves(pen, width) {
    const { stamps, coverage, speed } = this.#scene.robot.story.figures, base = TOP + CURVES, high = CURVES - 4;
    const [from, to] = this.#span, first = Math.max(after(stamps, from) - 1, 0), last = Math.min(after(stamps, to) + 1, stamps.length);
    const every = Math.max(1, Math.floor((last - first) / (2 * width)));
    pen.save();
    pen.beginPath();
    pen.rect(this.#gutter + 8, 0, width, base + 1);
    pen.clip();
    pen.beginPath();
    for (let i = first; i < last; i += every) pen.lineTo(this.#x(stamps[i]), base - high * (coverage[i] ?? 0));
    pen.strokeStyle = this.#palette.accent;
    pen.lineWidth = 1.6;
    pen.stroke();
    pen.lineTo(this.#x(stamps[last - 1] ?? 0), base);
    pen.lineTo(this.#x(stamps[first] ?? 0), base);
    pen.fillStyle = this.#palette.accent;
    pen.globalAlpha = 0.12;
    pen.fill();
    pen.globalAlpha = 1;
    const fastest = Math.max(0.1, ...speed.slice(first, last).map(Math.abs));
    pen.beginPath();
    for (let i = first; i < last; i += every) pen.lineTo(this.#x(stamps[i]), base - 0.5 * high * Math.abs(speed[i]) / fastest);
    pen.strokeStyle = this.#palette.scan;
    pen.lineWidth = 1;
    pen.stroke();
    pen.restore();
    this.#label(pen, "coverage", TOP + 12, this.#palette.accent);
    this.#label(pen, "speed", TOP + 30, this.#palette.scan);
  }

  #drawLanes(pen, width, height) {
    const { robot, picked } = this.#scene, top = TOP + CURVES + 8;
    const room = Math.max(0, Math.floor((height - AXIS - top) / LANE));
    this.lanes = interesting(robot, picked, room);
    this.lanes.forEach((id, index) => {
      const y = top + index * LANE;
      this.#label(pen, robot.nodes[id].name, y + LANE / 2, id === picked ? this.#palette.ink : this.#palette.soft, id === picked);
      this.#drawLane(pen, robot.story.nodes.get(id), y, width);
    });
  }

  #drawLane(pen, lane, y, width) {
    if (!lane) return;
    const [from, to] = this.#span, left = this.#gutter + 8;
    let busy = -1;
    for (let i = Math.max(after(lane.stamps, from) - 1, 0); i < lane.stamps.length && lane.stamps[i] <= to; i++) {
      const status = lane.status[i], x = Math.max(this.#x(lane.stamps[i]), left);
      const end = Math.min(this.#x(lane.stamps[i + 1] ?? this.#scene.end), width - 12);
      if (end < left || status === "idle") continue;
      pen.fillStyle = this.#palette[status];
      if (status === "running") pen.fillRect(x, y + 4, Math.max(end - x, 1), LANE - 8);
      else if (x - busy > 1.5 || status === "failure") {
        if (lane.stamps[i] >= from) pen.fillRect(x - 1, status === "failure" ? y + 1 : y + 3, 2, status === "failure" ? LANE - 2 : LANE - 6);
        busy = x;
      }
    }
  }

  #drawHead(pen, height) {
    const x = Math.round(this.#x(this.#scene.time)) + 0.5;
    pen.strokeStyle = pen.fillStyle = this.#palette.ink;
    pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(x, 0); pen.lineTo(x, height - AXIS + 2); pen.stroke();
    pen.beginPath(); pen.moveTo(x - 5, 0); pen.lineTo(x + 5, 0); pen.lineTo(x, 7); pen.fill();
  }

  #label(pen, text, y, colour = this.#palette.soft, bold = false) {
    if (!this.#gutter) return;
    pen.font = `${bold ? "600 " : ""}11px system-ui, sans-serif`;
    pen.fillStyle = colour;
    pen.textAlign = "right";
    pen.fillText(shortened(pen, text, this.#gutter - 12), this.#gutter - 2, y);
  }

  #readColours() {
    this.#palette = colours("line", "soft", "ink", "accent", "scan", "running", "success", "failure", "warn", "waypoint", "panel");
  }
}

/** The picked node, then the leaves that were busiest, in the tree's order. */
function interesting(robot, picked, room) {
  const leaves = robot.nodes.filter((node) => robot.story.nodes.has(node.id) && !robot.parents.has(node.id) && node.id !== picked);
  const busiest = leaves.map((node) => [node.id, robot.story.nodes.get(node.id).stamps.length]).sort((a, b) => b[1] - a[1]);
  const first = picked === null || !robot.story.nodes.has(picked) ? [] : [picked];
  return [...first, ...busiest.filter(([, count]) => count > 1).slice(0, Math.max(0, room - first.length)).map(([id]) => id).sort((a, b) => a - b)];
}

function shortened(pen, text, width) {
  if (pen.measureText(text).width <= width) return text;
  let kept = text.length;
  while (kept > 1 && pen.measureText(`${text.slice(0, kept)}…`).width > width) kept -= 1;
  return `${text.slice(0, kept)}…`;
}
