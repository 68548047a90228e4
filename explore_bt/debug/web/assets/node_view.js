// The node that was picked: status, reason, ports with values, its lines in the mission.

import { glyph, make } from "./dom.js";
import { brief, clock } from "./words.js";

const LINES_BEFORE = 2, LINES_AFTER = 3;

/** `act(name, ...)` does what the buttons say; null while a run can only be looked at. */
export class NodeView {
  #box;
  #parts = null;
  #node = null;

  constructor(box, sources, act) {
    this.#box = box;
    this.sources = sources;
    this.act = act;
  }

  /** `now`: {status, message}; `told`: since when, from the story; `board`; `forced`: status or "". */
  show(node, now, told, board, forced, isLive) {
    if (!node) {
      this.#node = null;
      this.#box.replaceChildren(make("p", { class: "hint" }, "Pick a node to see its ports, its lines and its last reason."));
      return;
    }
    if (node !== this.#node) this.#build(node, isLive);
    const { status, message, since, ports } = this.#parts;
    status.replaceChildren(glyph(now.status), now.status);
    status.dataset.status = now.status;
    message.textContent = now.message || "no reason given";
    message.classList.toggle("hint", !now.message);
    since.textContent = told ? `since ${clock(told.since)}` : "";
    node.ports?.forEach((port, index) => {
      const entry = port.bound.startsWith("$") ? port.bound.slice(1) : null;
      const value = entry === null ? "" : entry in board ? brief(board[entry]) : "not written yet";
      if (ports[index].textContent !== value) { ports[index].textContent = value; ports[index].title = entry in board ? JSON.stringify(board[entry], null, 1) : ""; }
    });
    if (this.#parts.release) this.#parts.release.hidden = !forced;
    if (this.#parts.forced) this.#parts.forced.textContent = forced ? `answered for: ${forced}` : "";
  }

  #build(node, isLive) {
    this.#node = node;
    const status = make("span", { class: "state" }), since = make("span", { class: "hint" });
    const message = make("p", { class: "message" });
    const ports = (node.ports ?? []).map(() => make("td", { class: "value" }));
    const rows = (node.ports ?? []).map((port, index) => make(
      "tr", {}, make("th", { scope: "row" }, port.name),
      make("td", { class: "bound", title: port.is_output ? "writes" : "reads" }, `${port.is_output ? "→ " : ""}${port.bound}`), ports[index],
    ));
    this.#parts = { status, message, since, ports };
    this.#box.replaceChildren(
      make("h2", {}, node.name, make("span", {}, node.type === node.name ? "" : node.type)),
      make("p", { class: "now" }, status, since), message,
      ...(isLive ? [this.#commands(node)] : []),
      ...(rows.length ? [make("table", { class: "ports" }, make("tbody", {}, ...rows))] : []),
      ...this.#lines(node),
      make("p", { class: "path", title: "its path, for breakpoints" }, node.path),
    );
  }

  #commands(node) {
    const button = (words, title, ...what) => {
      const element = make("button", { title }, words);
      element.onclick = () => this.act(...what, node);
      return element;
    };
    this.#parts.forced = make("span", { class: "hint" });
    this.#parts.release = button("Release", "Let it be ticked again", "release");
    return make(
      "p", { class: "acts" }, button("Break here", "Pause after each tick of this node", "break"),
      button("Force success", "Answer success in its place from now on", "force", "success"),
      button("Force failure", "Answer failure in its place from now on", "force", "failure"), this.#parts.release, this.#parts.forced,
    );
  }

  #lines(node) {
    const [, file, line] = /^(.*?):(\d+)(?::\d+)?$/.exec(node.place) ?? [];
    const text = this.sources[file];
    const head = make("p", { class: "place" }, node.place);
    if (text === undefined) return [head];
    const lines = text.split("\n"), at = Number(line) - 1;
    const from = Math.max(0, at - LINES_BEFORE), shown = lines.slice(from, at + LINES_AFTER + 1);
    const code = shown.map((each, index) => {
      const marked = from + index === at;
      return make("div", marked ? { class: "marked", "aria-current": "true" } : {}, make("i", {}, String(from + index + 1)), each || " ");
    });
    return [head, make("pre", { class: "yaml" }, ...code)];
  }
}
