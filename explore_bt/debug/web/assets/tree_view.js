// The behaviour tree: a row a node, subtrees that fold, the running path in front.

import { glyph, make } from "./dom.js";

const SIGNS = {
  sequence: "→", reactive_sequence: "⇢", fallback: "?", reactive_fallback: "¿", parallel: "⇉", repeat: "↻", retry: "↻",
  invert: "¬", force_success: "✓", force_failure: "✗", subtree: "▤", timeout: "◷", if: "if", on_failure: "!", entry: "$",
};

const LEFT_ALONE_MS = 8000;

/** One robot's tree; `onPick(id)`, `onBreak(id)` when its margin is clicked. */
export class TreeView {
  #box;
  #rows = [];
  #nodes = [];
  #folded = new Set();
  #picked = null;
  #found = "";
  #leaf = null;
  #touched = 0;

  constructor(box, onPick, onBreak) {
    this.#box = box;
    this.onPick = onPick;
    this.onBreak = onBreak;
    box.addEventListener("keydown", (event) => this.#onKey(event));
    for (const type of ["wheel", "pointerdown", "keydown"]) box.addEventListener(type, () => { this.#touched = performance.now(); }, { passive: true });
  }

  /** Another robot's nodes. */
  show(nodes) {
    this.#nodes = nodes.map((node) => ({ ...node, children: [], depth: 0 }));
    for (const node of this.#nodes) {
      if (node.parent === null) continue;
      this.#nodes[node.parent].children.push(node.id);
      node.depth = this.#nodes[node.parent].depth + 1;
    }
    this.#rows = this.#nodes.map((node) => this.#row(node));
    this.#folded.clear();
    this.#picked = this.#leaf = null;
    this.#box.replaceChildren(...this.#rows.map((row) => row.element));
  }

  /** Draws statuses; `marks`: paused at {path, moment}, breakpoints and forced nodes by id. */
  update(states, marks) {
    this.#nodes.forEach((node, id) => {
      const { status = "idle", message = "" } = states[id] ?? {};
      const row = this.#rows[id];
      const active = status === "running" && (node.parent === null || this.#rows[node.parent].active);
      const paused = marks.path === node.path ? marks.moment : "";
      const key = `${status}|${message}|${active}|${paused}|${marks.breaks.get(id) ?? ""}|${marks.forced.get(id) ?? ""}`;
      row.active = active;
      row.status = status;
      if (row.key === key) return;
      row.key = key;
      const { element } = row;
      element.dataset.status = status;
      element.classList.toggle("active", active);
      element.dataset.paused = paused;
      element.dataset.breaks = marks.breaks.get(id) ?? "";
      element.dataset.forced = marks.forced.get(id) ?? "";
      row.status_sign.replaceChildren(glyph(status));
      row.status_sign.title = status;
      row.words.textContent = message;
      row.words.title = message;
      element.setAttribute("aria-label", `${node.name}, ${status}${message ? `, ${message}` : ""}`);
    });
    this.#keepInSight();
  }

  /** Brings the leaf that runs into sight, unless somebody has just looked for something else. */
  #keepInSight() {
    const leaf = this.#rows.findLastIndex((row, id) => row.active && !this.#nodes[id].children.length);
    if (leaf < 0 || leaf === this.#leaf) return;
    this.#leaf = leaf;
    if (performance.now() - this.#touched > LEFT_ALONE_MS) this.#rows[leaf].element.scrollIntoView({ block: "nearest" });
  }

  /** Marks a node as the one that details are about. */
  pick(id, scroll = true) {
    if (this.#picked !== null) this.#rows[this.#picked]?.element.removeAttribute("aria-selected");
    this.#picked = id;
    this.#touched = performance.now();
    if (id === null || !this.#rows[id]) return;
    for (let up = this.#nodes[id].parent; up !== null; up = this.#nodes[up].parent) this.#folded.delete(up);
    this.#layout();
    const { element } = this.#rows[id];
    element.setAttribute("aria-selected", "true");
    if (scroll) element.scrollIntoView({ block: "nearest" });
  }

  /** Shows only what is found, with all above it. */
  search(text) {
    this.#found = text.trim().toLowerCase();
    this.#layout();
    if (!this.#found) return;
    const first = this.#nodes.find((node) => this.#matches(node));
    if (first) this.#rows[first.id].element.scrollIntoView({ block: "nearest" });
  }

  /** Folds every topmost subtree in which nothing runs; `false` unfolds everything. */
  fold(on) {
    this.#folded.clear();
    if (on) for (const node of this.#nodes) if (node.children.length && this.#rows[node.id].status !== "running") this.#folded.add(node.id);
    this.#layout();
  }

  #matches(node) { return `${node.path} ${node.type}`.toLowerCase().includes(this.#found); }

  #layout() {
    const shown = new Set();
    if (this.#found) {
      for (const node of this.#nodes) {
        if (this.#matches(node)) for (let id = node.id; id !== null && !shown.has(id); id = this.#nodes[id].parent) shown.add(id);
      }
    }
    for (const node of this.#nodes) {
      const above = node.parent === null ? null : this.#rows[node.parent];
      const row = this.#rows[node.id];
      row.hidden = this.#found ? !shown.has(node.id) : Boolean(above && (above.hidden || this.#folded.has(node.parent)));
      row.element.hidden = row.hidden;
      row.element.classList.toggle("found", Boolean(this.#found) && this.#matches(node));
      if (node.children.length) row.element.setAttribute("aria-expanded", String(!this.#folded.has(node.id)));
    }
  }

  #toggle(id) {
    if (!this.#folded.delete(id)) this.#folded.add(id);
    this.#layout();
  }

  #row(node) {
    const sign = SIGNS[node.type];
    const margin = make("button", { class: "margin", tabIndex: -1, title: "Breakpoint after this node", "aria-label": "Breakpoint" });
    margin.onclick = (event) => { event.stopPropagation(); this.onBreak(node.id); };
    const twist = make("span", { class: "twist" });
    twist.onclick = (event) => { event.stopPropagation(); if (node.children.length) this.#toggle(node.id); };
    const status_sign = make("span", { class: "status" }, glyph("idle"));
    const words = make("span", { class: "words" });
    const element = make(
      "div", { class: `row${node.children.length ? "" : " leaf"}`, role: "treeitem", "aria-level": node.depth + 1, title: "" },
      margin, this.#indent(node), twist, status_sign,
      sign ? make("span", { class: "sign", title: node.type }, sign) : null,
      make("span", { class: "name", title: `${node.path}\n${node.type}` }, node.name), words,
    );
    element.dataset.id = node.id;
    if (node.children.length) element.setAttribute("aria-expanded", "true");
    element.onclick = () => this.onPick(node.id);
    element.ondblclick = () => { if (node.children.length) this.#toggle(node.id); };
    return { element, status_sign, words, key: "", hidden: false, active: false, status: "idle" };
  }

  #indent(node) {
    const element = make("span", { class: "indent" });
    element.style.width = `${node.depth * 13}px`;
    return element;
  }

  #onKey(event) {
    const steps = { ArrowDown: 1, ArrowUp: -1 };
    const seen = this.#nodes.filter((node) => !this.#rows[node.id].hidden);
    const at = seen.findIndex((node) => node.id === this.#picked);
    if (event.key in steps) this.onPick(seen[Math.min(Math.max(at + steps[event.key], 0), seen.length - 1)].id);
    else if (event.key === "Enter" && this.#picked !== null) this.#toggle(this.#picked);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}
