// The map: what the robot knew, saw and meant to do at the moment shown.

import { colours, fitted, watch } from "./dom.js";
import { after } from "./story.js";
import { flat } from "./run_state.js";
import { drawLayers } from "./map_layers.js";
import { frameOf, moved } from "./mate_frames.js";

const REACH = 12, MOST_WORDS = 4;

/** Decodes a Foxglove grid once. */
const grids = new WeakMap();
export function gridOf(message) {
  if (!message) return null;
  if (!grids.has(message)) {
    const text = atob(message.data), cells = new Int8Array(text.length);
    for (let i = 0; i < text.length; i++) cells[i] = text.charCodeAt(i);
    const cols = message.column_count, { x, y } = message.pose.position;
    grids.set(message, { cells, cols, rows: cells.length / cols, size: message.cell_size.x, x, y, revision: message.revision });
  }
  return grids.get(message);
}

/** Draws everything in `map` frame; metres to pixels by centre and scale. */
export class MapView {
  layers = new Set(["scan", "driven", "path", "waypoints", "sectors", "half-planes", "frontiers", "views", "people", "claims", "robots", "maps"]);
  follow = false;
  spots = [];

  #canvas;
  #view = null;
  #touched = false;
  #pictures = new Map();
  #palette;
  #pointers = new Map();
  #scene = null;

  constructor(canvas, onHover) {
    this.#canvas = canvas;
    this.onHover = onHover;
    this.#readColours();
    watch(canvas, () => { this.#readColours(); if (!this.#touched) this.#view = null; this.draw(); });
    canvas.addEventListener("wheel", (event) => this.#onWheel(event), { passive: false });
    for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel", "pointerleave"]) {
      canvas.addEventListener(type, (event) => this.#onPointer(type, event));
    }
  }

  /** `scene`: robots with name, colour, radius, state, story; `picked`: whose map and plans; `time`. */
  show(scene) {
    this.#scene = scene;
    this.draw();
  }

  /** Everything in view again. */
  fit() {
    this.#touched = false;
    this.#view = null;
    this.draw();
  }

  zoom(factor, x = this.#canvas.clientWidth / 2, y = this.#canvas.clientHeight / 2) {
    if (!this.#view) return;
    const [mx, my] = this.toMap(x, y);
    this.#view.scale = Math.min(Math.max(this.#view.scale * factor, 2), 800);
    const [nx, ny] = this.toMap(x, y);
    this.#view.x += mx - nx;
    this.#view.y += my - ny;
    this.#touched = true;
    this.draw();
  }

  /** What is said of a place on the screen: the nearest marks first, then what lies under it. */
  wordsAt(px, py) {
    const far = (each) => Math.hypot(each.x - px, each.y - py);
    const near = this.spots.filter((each) => far(each) < REACH).sort((a, b) => far(a) - far(b));
    const under = this.spots.filter((each) => far(each) >= REACH && each.covers?.(px, py));
    return [...new Set([...near, ...under].map((each) => each.words))].slice(0, MOST_WORDS);
  }

  toMap(px, py) {
    const { x, y, scale } = this.#view;
    return [x + (px - this.#canvas.clientWidth / 2) / scale, y - (py - this.#canvas.clientHeight / 2) / scale];
  }

  toScreen(x, y) {
    const view = this.#view;
    return [this.#canvas.clientWidth / 2 + (x - view.x) * view.scale, this.#canvas.clientHeight / 2 - (y - view.y) * view.scale];
  }

  draw() {
    const pen = fitted(this.#canvas), width = this.#canvas.clientWidth, height = this.#canvas.clientHeight;
    pen.fillStyle = this.#palette.unknown;
    pen.fillRect(0, 0, width, height);
    const scene = this.#scene, picked = scene?.robots.find((robot) => robot.name === scene.picked);
    if (!picked || !width) return;
    const grid = gridOf(picked.state.newest.map), pose = flat(picked.state.newest.pose?.pose);
    const others = this.layers.has("maps") ? scene.robots.filter((robot) => robot !== picked && gridOf(robot.state.newest.map) && frameOf(picked, robot).merged) : [];
    const drawn = [...others, ...(grid ? [picked] : [])].map((robot) => [robot.name, gridOf(robot.state.newest.map), frameOf(picked, robot).T]);
    this.#place(drawn, pose, width, height);
    if (!this.#view) return;
    for (const each of drawn) this.#drawGrid(pen, ...each);
    this.spots = [];
    drawLayers({
      pen, scene, picked, palette: this.#palette, layers: this.layers, spots: this.spots, time: scene.time, scale: this.#view.scale,
      at: (x, y) => this.toScreen(x, y), until: (robot) => after(robot.story.poses.stamps, scene.time),
    });
    this.#drawScale(pen, height);
  }

  /** All maps in view, until somebody has moved or zoomed. */
  #place(drawn, pose, width, height) {
    if (this.follow && pose && this.#view) Object.assign(this.#view, { x: pose.x, y: pose.y });
    if (this.#view && (this.#touched || !drawn.length)) return;
    if (!drawn.length) { if (pose) this.#view = { x: pose.x, y: pose.y, scale: 50 }; return; }
    const corners = drawn.flatMap(([, { x, y, cols, rows, size }, T]) => [[0, 0], [cols, 0], [cols, rows], [0, rows]].map(([i, j]) => moved(T, x + i * size, y + j * size)));
    const xs = corners.map(([x]) => x), ys = corners.map(([, y]) => y), left = Math.min(...xs), low = Math.min(...ys);
    const wide = Math.max(...xs) - left, high = Math.max(...ys) - low;
    this.#view = { x: left + wide / 2, y: low + high / 2, scale: 0.92 * Math.min(width / wide, height / high) };
  }

  #drawGrid(pen, name, grid, T) {
    let picture = this.#pictures.get(name);
    if (picture?.grid !== grid || picture.palette !== this.#palette) {
      picture = { grid, palette: this.#palette, canvas: picture?.canvas ?? document.createElement("canvas") };
      this.#paint(picture.canvas, grid);
      this.#pictures.set(name, picture);
    }
    const scale = this.#view.scale;
    pen.save();
    pen.translate(...this.toScreen(...moved(T, grid.x, grid.y + grid.rows * grid.size)));
    pen.rotate(-T.yaw);
    pen.imageSmoothingEnabled = scale * grid.size < 1;
    pen.drawImage(picture.canvas, 0, 0, grid.cols * grid.size * scale, grid.rows * grid.size * scale);
    pen.restore();
  }

  #paint(canvas, grid) {
    Object.assign(canvas, { width: grid.cols, height: grid.rows });
    const pen = canvas.getContext("2d"), image = pen.createImageData(grid.cols, grid.rows);
    const pixels = new Uint32Array(image.data.buffer);
    const [free, wall] = [this.#palette.free, this.#palette.wall].map(packed), unknown = 0;  // what lies beneath shows through
    for (let row = 0; row < grid.rows; row++) {
      const from = row * grid.cols, to = (grid.rows - 1 - row) * grid.cols;
      for (let col = 0; col < grid.cols; col++) {
        const cell = grid.cells[from + col];
        pixels[to + col] = cell < 0 ? unknown : cell === 0 ? free : wall;
      }
    }
    pen.putImageData(image, 0, 0);
  }

  #drawScale(pen, height) {
    const length = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100].find((each) => each * this.#view.scale >= 60) ?? 100;
    const wide = length * this.#view.scale, x = 14.5, y = height - 14.5;
    pen.strokeStyle = pen.fillStyle = this.#palette.soft;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x, y - 5); pen.lineTo(x, y); pen.lineTo(x + wide, y); pen.lineTo(x + wide, y - 5);
    pen.stroke();
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "left";
    pen.fillText(`${length} m`, x + 5, y - 5);
  }

  #readColours() {
    this.#palette = colours(
      "unknown", "free", "wall", "soft", "ink", "panel", "scan", "planned", "waypoint", "taken", "rejected", "open", "plane", "person", "failure",
      ...Array.from({ length: 6 }, (_, index) => `robot-${index}`),
    );
  }

  #onWheel(event) {
    event.preventDefault();
    this.zoom(Math.exp(-event.deltaY * (event.deltaMode ? 0.05 : 0.0015)), event.offsetX, event.offsetY);
  }

  #onPointer(type, event) {
    const here = { x: event.offsetX, y: event.offsetY }, before = this.#pointers.get(event.pointerId);
    if (type === "pointerdown") {
      this.#canvas.setPointerCapture(event.pointerId);
      this.#pointers.set(event.pointerId, here);
    } else if (type === "pointermove") {
      if (before && this.#view) this.#drag(event.pointerId, before, here);
      else if (this.#view) this.onHover(here, this.toMap(here.x, here.y));
    } else {
      this.#pointers.delete(event.pointerId);
      if (type === "pointerleave") this.onHover(null);
    }
  }

  #drag(id, before, here) {
    const other = [...this.#pointers].find(([each]) => each !== id)?.[1];
    this.#pointers.set(id, here);
    this.#touched = true;
    if (other) {
      const span = (point) => Math.hypot(point.x - other.x, point.y - other.y);
      this.zoom(span(here) / Math.max(span(before), 1), other.x, other.y);
      return;
    }
    this.#view.x -= (here.x - before.x) / this.#view.scale;
    this.#view.y += (here.y - before.y) / this.#view.scale;
    this.draw();
  }
}

function packed(hex) {
  const [red, green, blue] = [1, 3, 5].map((index) => parseInt(hex.slice(index, index + 2), 16));
  return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
}
