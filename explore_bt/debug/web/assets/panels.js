// The other panels: reasons, blackboard, breakpoints, parameters.

import { make } from "./dom.js";
import { after } from "./story.js";
import { brief, clock } from "./words.js";

const MOST_LINES = 400;

/** Everything that was said, up to the moment shown; a click goes there. */
export class ReasonsPanel {
  #box;
  #key = "";

  constructor(box, onJump) {
    this.#box = box;
    this.onJump = onJump;
  }

  show(lines, names, robot, time) {
    const several = names.length > 1;
    const heard = lines.filter((line) => !line.robot || line.robot === robot);
    const last = after(heard.map((line) => line.stamp), time);
    const key = `${robot}|${heard.length}|${last}`;
    if (key === this.#key) return;
    this.#key = key;
    const shown = heard.slice(Math.max(0, last - MOST_LINES), last).reverse();
    const rows = shown.map((line) => {
      const element = make(
        "button", { class: `line ${line.kind}` }, make("time", {}, clock(line.stamp)),
        make("span", { class: "source" }, line.source || line.nodeName || (line.kind === "visited" ? "waypoint" : several ? line.robot : "")),
        make("span", { class: "said" }, line.kind === "visited" ? line.words.replace(/^waypoint /, "") : line.words),
      );
      element.onclick = () => this.onJump(line);
      return element;
    });
    this.#box.replaceChildren(...(rows.length ? rows : [make("p", { class: "hint" }, "Nothing has been said yet.")]));
  }
}

/** All entries of a robot's blackboard. */
export function showBlackboard(box, board) {
  const names = Object.keys(board).sort();
  const rows = names.map((name) => {
    const inside = make("td", { class: "value", title: JSON.stringify(board[name], null, 1).slice(0, 4000) }, brief(board[name], 300));
    return make("tr", {}, make("th", { scope: "row" }, `$${name}`), inside);
  });
  box.replaceChildren(rows.length ? make("table", { class: "ports" }, make("tbody", {}, ...rows)) : make("p", { class: "hint" }, "The blackboard is empty."));
}

function option(value, words = value) { return make("option", { value }, words); }

/** Breakpoints: those that are set, and a form for one more. */
export class BreakpointsPanel {
  #list = make("div", {});
  #forced = make("div", {});
  #key = "";

  constructor(box, command) {
    this.command = command;
    this.path = make("input", { placeholder: "path or name, * for anything", "aria-label": "Node", required: true, spellcheck: false });
    this.path.setAttribute("list", "node-paths");
    this.moment = make("select", { "aria-label": "When" }, option("after"), option("before"));
    this.status = make("select", { "aria-label": "Status" }, option("", "any status"), option("success"), option("failure"), option("running"), option("idle"));
    this.condition = make("input", { placeholder: "and only if, for example $left_m < 2", "aria-label": "Condition", spellcheck: false });
    const form = make("form", { class: "adder" }, this.path, this.moment, this.status, this.condition, make("button", {}, "Add"));
    form.onsubmit = (event) => { event.preventDefault(); this.#add(); };
    box.replaceChildren(this.#list, form, this.#forced, make("datalist", { id: "node-paths" }));
  }

  /** Names that the form offers. */
  offer(nodes) {
    document.getElementById("node-paths").replaceChildren(...nodes.map((node) => option(node.path)));
  }

  show(debug) {
    const key = JSON.stringify([debug.breakpoints, debug.forced]);
    if (key === this.#key) return;
    this.#key = key;
    this.#list.replaceChildren(...debug.breakpoints.map((each) => this.#row(each)));
    if (!debug.breakpoints.length) this.#list.append(make("p", { class: "hint" }, "No breakpoints. Click a node's left margin, or add one here."));
    this.#forced.replaceChildren(...debug.forced.map((each) => this.#forcedRow(each)));
  }

  #row({ number, breakpoint, hits, fault, nodes }) {
    const { path, moment, status, condition, enabled } = breakpoint;
    const box = make("input", { type: "checkbox", checked: enabled, "aria-label": "Enabled" });
    box.onchange = () => this.command({ do: "EnableBreakpoint", number, enabled: box.checked });
    const words = `${moment} ${status ? `if ${status}` : ""}${condition ? ` and ${condition}` : ""}`;
    const counted = `${hits} ${hits === 1 ? "hit" : "hits"}${nodes === 1 ? "" : `, ${nodes} nodes`}`;
    return make(
      "div", { class: `item${fault ? " faulty" : ""}`, title: fault }, box, make("span", { class: "path", title: path }, tail(path)), make("span", { class: "hint" }, words),
      make("span", { class: "count" }, counted), remover(() => this.command({ do: "RemoveBreakpoint", number })),
    );
  }

  #forcedRow({ robot, path, status, answers }) {
    return make(
      "div", { class: "item" }, make("span", { class: `badge ${status}` }, `forced ${status}`), make("span", { class: "path", title: path }, tail(path)),
      make("span", { class: "count" }, `${answers} ${answers === 1 ? "answer" : "answers"}`), remover(() => this.command({ do: "Release", path, robot })),
    );
  }

  async #add() {
    const breakpoint = { path: this.path.value.trim(), moment: this.moment.value, status: this.status.value, condition: this.condition.value.trim() };
    if (await this.command({ do: "AddBreakpoint", breakpoint })) this.path.value = this.condition.value = "";
  }
}

/** The end of a path, which tells nodes apart. */
function tail(path) {
  const parts = path.split("/");
  return parts.length > 2 ? `…/${parts.slice(-2).join("/")}` : path;
}

function remover(action) {
  const element = make("button", { class: "quiet remove", title: "Remove", "aria-label": "Remove" }, "×");
  element.onclick = action;
  return element;
}

/** The mission's parameters; editable while the run is paused. */
export class ParametersPanel {
  #box;
  #key = "";

  constructor(box, command) {
    this.#box = box;
    this.command = command;
  }

  show(debug) {
    const key = JSON.stringify([debug.params, debug.paused]);
    if (key === this.#key) return;
    this.#key = key;
    const rows = debug.params.map((param) => this.#row(param, debug.paused));
    const hint = debug.paused ? "Enter sets a value; it is checked as --set does it." : "Pause the run to change a parameter.";
    this.#box.replaceChildren(make("p", { class: "hint" }, hint), make("table", { class: "ports" }, make("tbody", {}, ...rows)));
  }

  #row({ name, type, value, doc }, editable) {
    const input = make("input", { value, disabled: !editable, "aria-label": name, spellcheck: false });
    input.onkeydown = async (event) => {
      if (event.key === "Escape") { input.value = value; input.blur(); }
      if (event.key !== "Enter") return;
      const done = await this.command({ do: "SetParam", name, text: input.value });
      if (!done) input.select();
    };
    return make("tr", { title: doc }, make("th", { scope: "row" }, name), make("td", {}, input), make("td", { class: "hint" }, type));
  }
}
