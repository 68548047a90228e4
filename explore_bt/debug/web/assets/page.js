// The page: puts the views together over one run, recorded or going on.

import { drawBars } from "./bars.js";
import { byId, make } from "./dom.js";
import { fillHelp, listen } from "./keys.js";
import { Link } from "./link.js";
import { LAYERS } from "./map_layers.js";
import { MapView } from "./map_view.js";
import { NodeView } from "./node_view.js";
import { BreakpointsPanel, ParametersPanel, ReasonsPanel, showBlackboard } from "./panels.js";
import { Player } from "./player.js";
import { RunState } from "./run_state.js";
import { after, Story } from "./story.js";
import { TimelineView } from "./timeline_view.js";
import { TreeView } from "./tree_view.js";

const COLOURS = 6;
const RATES = [1, 4, 16];
const NOTHING = { paused: false, over: false, held: [], path: "", moment: "", breakpoints: [], forced: [], params: [], why: "" };

class Page {
  run = null;
  debug = NOTHING;
  robot = "";
  picked = null;
  tab = "node";
  player = null;
  story = new Story([]);

  #names = [];
  #colours = new Map();
  #drawn = false;
  #catching = false;
  #looked = null;
  #noticeEnds = 0;

  constructor() {
    this.tree = new TreeView(byId("tree"), (id) => this.pick(id), (id) => this.toggleBreakpoint(id));
    this.map = new MapView(byId("map"), (here, spot) => this.#hover(here, spot));
    this.timeline = new TimelineView(byId("timeline"), (time) => this.seek(time));
    this.reasons = new ReasonsPanel(byId("reasons"), (line) => { this.seek(line.stamp); if (line.id !== null) this.pick(line.id); });
    this.breakpoints = new BreakpointsPanel(byId("breakpoints"), (command) => this.command(command));
    this.parameters = new ParametersPanel(byId("parameters"), (command) => this.command(command));
    this.#wire();
    this.link = new Link((news) => this.#hear(news), (open) => this.#onLink(open));
  }

  get names() { return this.#names; }
  get live() { return this.player?.live ?? false; }
  get nodes() { return this.run.trees[this.robot]; }

  /** The robot at the moment shown. */
  get state() {
    const state = this.player.state.robots.get(this.robot), now = this.#looked?.robots.get(this.robot);
    return this.player.following && now?.nodes.length ? { ...state, nodes: now.nodes, board: now.board } : state;
  }

  // --- the server ---------------------------------------------------------------------------------------

  #onLink(open) {
    if (open) { this.notice(""); if (this.player) this.#catchUp(); return; }
    if (!this.link.wasOpen) return this.notice("The server does not admit this page: open the address that it printed, with all behind its #.", true);
    this.notice(this.debug.over ? "The run is over and explore-bt has ended; what is loaded stays." : "The connection is lost; trying again …", true);
  }

  async #hear(news) {
    this.debug = news.debug ?? NOTHING;
    if (!this.run) return news.ready ? this.#begin(news) : this.#draw();
    const { player } = this;
    this.#catchUp();
    if (this.debug.over && player.live) { player.live = false; player.following = false; player.end = news.end_s; player.seek(news.end_s); }
    player.extend(news.end_s);
    this.#look();
  }

  async #begin(news) {
    const { run, begin_s, end_s, damage } = await this.link.ask("run");
    if (this.run) return;
    this.run = run;
    this.#names = Object.keys(run.trees);
    this.#names.forEach((name, index) => this.#colours.set(name, `robot-${index % COLOURS}`));
    this.story = new Story(this.#names);
    this.player = new Player(this.link, this.#names, () => this.#draw());
    Object.assign(this.player, { begin: begin_s, end: end_s, live: news.live && !this.debug.over });
    this.node = new NodeView(byId("node"), { [run.mission]: run.mission_text, ...run.sources }, (...what) => this.#act(...what));
    byId("mission").textContent = run.mission;
    byId("about").textContent = `seed ${run.seed}`;
    document.title = `${run.mission} – explore-bt`;
    if (damage) this.notice(`This recording is ${damage}`, true);
    byId("run-controls").hidden = !news.live;
    byId("live").hidden = !news.live;
    for (const each of document.querySelectorAll("[data-live]")) each.hidden = !news.live;
    this.#showRobots();
    this.choose(this.#names[0]);
    this.#catchUp();
    if (this.player.live) this.player.toNow(); else this.player.seek(this.#asked() ?? begin_s);
    this.#look();
  }

  /** `#t=42` opens a recording there. */
  #asked() {
    const asked = Number(new URLSearchParams(location.hash.slice(1)).get("t") ?? NaN);
    return Number.isFinite(asked) ? asked : null;
  }

  async #catchUp() {
    if (this.#catching) return;
    this.#catching = true;
    try {
      for (let more = true; more;) {
        const answer = await this.link.ask("timeline", { begin: this.story.count });
        for (const item of answer.items) this.story.take(item);
        more = answer.more;
      }
      this.#draw();
    } catch { /* the link says so itself */ } finally { this.#catching = false; }
  }

  /** In the middle of a tick the tree is ahead of what was recorded. */
  async #look() {
    if (!this.debug.paused || !this.debug.path) {
      if (this.#looked) { this.#looked = null; this.#draw(); }
      return;
    }
    try {
      const { messages } = await this.link.ask("look", { robot: this.debug.robot });
      this.#looked = new RunState(this.#names);
      for (const message of messages) this.#looked.take(message);
    } catch { this.#looked = null; }
    this.#draw();
  }

  /** Has the debugger do something; false where it would not. */
  async command(command) {
    try {
      const { answer } = await this.link.ask("command", { command });
      if (typeof answer === "string") this.notice(answer);
      return true;
    } catch (fault) {
      this.notice(fault.message);
      return false;
    }
  }

  // --- what people do -----------------------------------------------------------------------------------

  choose(name) {
    this.robot = name;
    this.picked = null;
    this.tree.show(this.nodes);
    this.breakpoints.offer(this.nodes);
    for (const each of byId("robots").children) each.setAttribute("aria-checked", String(each.dataset.name === name));
    this.#draw();
  }

  pick(id) {
    this.picked = id;
    this.tree.pick(id);
    this.showTab("node");
  }

  seek(time) {
    this.player.playing = false;
    this.player.seek(time);
  }

  showTab(name) {
    this.tab = name;
    for (const each of byId("tabs").children) each.setAttribute("aria-selected", String(each.dataset.tab === name));
    for (const each of document.querySelectorAll(".tab")) each.hidden = each.id !== name;
    this.#draw();
  }

  showPane(name) {
    document.body.dataset.pane = name;
    for (const each of document.querySelectorAll(".panes button")) each.setAttribute("aria-selected", String(each.dataset.pane === name));
    this.#draw();
  }

  toggleBreakpoint(id) {
    if (!this.live) return this.notice("Breakpoints need a run that goes on: explore-bt debug MISSION", false);
    const { path } = this.nodes[id], set = this.debug.breakpoints.find((each) => each.breakpoint.path === path);
    if (set) this.command({ do: "RemoveBreakpoint", number: set.number });
    else this.command({ do: "AddBreakpoint", breakpoint: { path, moment: "after", robot: this.#only() } });
  }

  #act(what, ...rest) {
    const { path } = rest.at(-1);
    if (what === "break") this.toggleBreakpoint(rest.at(-1).id);
    else if (what === "force") this.command({ do: "Force", path, status: rest[0], robot: this.robot });
    else this.command({ do: "Release", path, robot: this.robot });
  }

  #only() { return this.#names.length > 1 ? this.robot : "*"; }

  /** Space: the run itself while it is followed, else the recording of it. */
  pause() {
    if (!this.live || !this.player.following) return this.player.play(!this.player.playing);
    this.command({ do: this.debug.paused ? "Resume" : "Pause" });
  }

  /** One robot of several stands, and the others go on. */
  hold() {
    if (!this.live || this.#names.length < 2) return;
    this.command({ do: this.debug.held.includes(this.robot) ? "Resume" : "Pause", robot: this.robot });
  }

  step(kind) {
    if (this.live) {
      if (!this.player.following) this.player.toNow();
      const alone = this.debug.held.includes(this.robot) && !this.debug.paused;
      return this.command({ do: "Step", kind, robot: alone ? this.robot : "*" });
    }
    if (kind === "tick") this.seek(this.#tickFrom(true));
    else { const next = this.story.changeFrom(this.robot, this.player.time, true); if (next !== null) this.seek(next); }
  }

  back(kind) {
    const time = kind === "tick" ? this.#tickFrom(false) : this.story.changeFrom(this.robot, this.player.time, false);
    if (time !== null) this.seek(time);
  }

  /** A pose is recorded with every tick while the robot moves; else ticks are a tenth of a second apart. */
  #tickFrom(forward) {
    const { stamps } = this.story.robots.get(this.robot).poses, { time } = this.player, index = after(stamps, time);
    const next = forward ? stamps[index] : stamps[stamps[index - 1] < time - 1e-3 ? index - 1 : index - 2];
    const tick = forward ? time + 0.1 : time - 0.1;
    return next === undefined || Math.abs(next - time) > 0.5 ? tick : next;
  }

  notice(words, stays = false) {
    const box = byId("notice");
    clearTimeout(this.#noticeEnds);
    box.textContent = words;
    box.hidden = !words;
    if (words && !stays) this.#noticeEnds = setTimeout(() => { box.hidden = true; }, 6000);
  }

  // --- drawing ------------------------------------------------------------------------------------------

  #draw() {
    if (this.#drawn) return;
    this.#drawn = true;
    requestAnimationFrame(() => { this.#drawn = false; this.#drawNow(); });
  }

  #drawNow() {
    if (!this.player) return void (byId("clock").textContent = this.debug.why || "");
    const { player, state } = this, time = player.time;
    this.tree.update(state.nodes, this.#marks());
    this.map.show({
      picked: this.robot, time, robots: this.#names.map((name) => ({
        name, colour: this.#colours.get(name), radius: this.run.footprint_radius_m[name] ?? 0.2,
        state: name === this.robot ? state : player.state.robots.get(name), story: this.story.robots.get(name),
      })),
    });
    this.timeline.show({
      begin: player.begin, end: player.end, time, picked: this.picked, lines: this.story.lines, count: this.story.count,
      robot: { name: this.robot, nodes: this.nodes, story: this.story.robots.get(this.robot), parents: this.#parents() },
    });
    this.#drawTab(state, time);
    drawBars(this, state, time);
  }

  #parents() { return new Set(this.nodes.map((node) => node.parent)); }

  #marks() {
    const ids = new Map(this.nodes.map((node) => [node.path, node.id]));
    const here = this.live && this.player.following && this.debug.paused && (!this.debug.robot || this.debug.robot === this.robot);
    const breaks = new Map();
    for (const { breakpoint } of this.debug.breakpoints) {
      for (const node of this.nodes) if (matches(breakpoint.path, node)) breaks.set(node.id, breakpoint.enabled ? "on" : "off");
    }
    const forced = new Map(this.debug.forced.filter((each) => each.robot === this.robot).map((each) => [ids.get(each.path), each.status]));
    return { path: here ? this.debug.path : "", moment: here ? this.debug.moment : "", breaks, forced };
  }

  #drawTab(state, time) {
    if (this.tab === "node") {
      const node = this.picked === null ? null : this.nodes[this.picked], now = state.nodes[this.picked] ?? { status: "idle", message: "" };
      const forced = this.debug.forced.find((each) => each.robot === this.robot && each.path === node?.path)?.status ?? "";
      this.node.show(node, now, node && this.story.nodeAt(this.robot, node.id, time), state.board, forced, this.live);
    } else if (this.tab === "reasons") this.#drawReasons(time);
    else if (this.tab === "blackboard") showBlackboard(byId("blackboard"), state.board);
    else if (this.tab === "breakpoints") this.breakpoints.show(this.debug);
    else this.parameters.show(this.debug);
  }

  #drawReasons(time) {
    for (const line of this.story.lines) if (line.id !== null && !line.nodeName) line.nodeName = this.run.trees[line.robot][line.id].name;
    this.reasons.show(this.story.lines, this.#names, this.robot, time);
  }

  #showRobots() {
    const box = byId("robots");
    box.hidden = this.#names.length < 2;
    box.replaceChildren(...this.#names.map((name) => {
      const dot = make("i", {}), button = make("button", { role: "radio" }, dot, name);
      dot.style.background = `var(--${this.#colours.get(name)})`;
      button.dataset.name = name;
      button.onclick = () => this.choose(name);
      return button;
    }));
  }

  #hover(here, spot) {
    byId("map-note").textContent = spot ? `x ${spot[0].toFixed(2)}  y ${spot[1].toFixed(2)} m` : "";
    const words = here ? this.map.wordsAt(here.x, here.y) : [], hint = byId("map-hint");
    hint.hidden = !words.length;
    if (!words.length) return;
    hint.textContent = words.join("\n");
    hint.style.left = `${Math.min(here.x + 14, byId("map").clientWidth - 240)}px`;
    hint.style.top = `${Math.min(here.y + 14, byId("map").clientHeight - hint.offsetHeight - 8)}px`;
  }

  // --- wiring -------------------------------------------------------------------------------------------

  #wire() {
    const on = (id, action) => { byId(id).onclick = action; };
    on("pause", () => { if (!this.player.following) this.player.toNow(); this.command({ do: this.debug.paused ? "Resume" : "Pause" }); });
    on("hold", () => this.hold());
    on("step-tick", () => this.step("tick"));
    on("step-node", () => this.step("node"));
    on("step-change", () => this.step("change"));
    on("stop", () => this.command({ do: "Quit" }));
    on("play", () => this.player?.play(!this.player.playing));
    on("live", () => this.player?.toNow());
    on("fold", () => this.tree.fold(true));
    on("unfold", () => this.tree.fold(false));
    on("zoom-in", () => this.map.zoom(1.3));
    on("zoom-out", () => this.map.zoom(1 / 1.3));
    on("fit", () => this.map.fit());
    on("follow", () => this.#toggleFollow());
    on("help-button", () => byId("help").showModal());
    byId("search").oninput = () => this.tree.search(byId("search").value);
    for (const each of byId("tabs").children) each.onclick = () => this.showTab(each.dataset.tab);
    for (const each of document.querySelectorAll(".panes button")) each.onclick = () => this.showPane(each.dataset.pane);
    this.#wireLayers();
    this.#wireRates();
    fillHelp(byId("help"));
    listen(this.#keys());
    this.showTab("node");
    this.showPane("map");
  }

  #wireLayers() {
    byId("layer-list").replaceChildren(...Object.entries(LAYERS).map(([name, words]) => {
      const box = make("input", { type: "checkbox", checked: this.map.layers.has(name), value: name });
      box.onchange = () => { if (box.checked) this.map.layers.add(name); else this.map.layers.delete(name); this.map.draw(); };
      return make("label", {}, box, words);
    }));
  }

  #wireRates() {
    byId("speeds").replaceChildren(...RATES.map((rate) => {
      const button = make("button", { role: "radio", "aria-checked": String(rate === 1), title: `Play at ${rate} times the speed` }, `${rate}×`);
      button.onclick = () => this.#setRate(rate);
      return button;
    }));
  }

  #setRate(rate) {
    if (this.player) this.player.rate = rate;
    RATES.forEach((each, index) => byId("speeds").children[index].setAttribute("aria-checked", String(each === rate)));
  }

  #toggleFollow() {
    this.map.follow = !this.map.follow;
    byId("follow").setAttribute("aria-pressed", String(this.map.follow));
    this.#draw();
  }

  #keys() {
    const by = (seconds) => () => this.player && this.seek(this.player.time + seconds);
    const ready = (action) => () => this.player && action();
    return {
      " ": ready(() => this.pause()), p: ready(() => this.hold()), n: ready(() => this.step("tick")), N: ready(() => this.step("node")), c: ready(() => this.step("change")),
      b: ready(() => this.back("tick")), C: ready(() => this.back("change")),
      ArrowLeft: by(-1), ArrowRight: by(1), ShiftArrowLeft: by(-10), ShiftArrowRight: by(10),
      Home: ready(() => this.seek(this.player.begin)), End: ready(() => this.player.toNow()),
      1: () => this.#setRate(1), 2: () => this.#setRate(4), 3: () => this.#setRate(16),
      "/": () => { this.showPane("tree"); byId("search").focus(); }, f: ready(() => this.tree.fold(true)), u: ready(() => this.tree.fold(false)),
      "+": () => this.map.zoom(1.3), "-": () => this.map.zoom(1 / 1.3), 0: () => this.map.fit(),
      r: () => this.#toggleFollow(), l: () => { byId("layers").open = !byId("layers").open; },
      "?": () => byId("help").showModal(), Escape: () => { byId("layers").open = false; },
    };
  }
}

/** As explore_bt.debug.Breakpoint reads a path: `*` is anything, a name means every node of that name. */
function matches(pattern, node) {
  const expression = pattern.split("*").map((part) => part.replace(/[.+?^${}()|[\]\\]/g, "\\$&")).join(".*");
  return new RegExp(`^(?:.*/)?${expression}$`).test(node.path);
}

window.page = new Page();
