// The bars above and below: figures at the moment shown, buttons as they stand, the clock.

import { byId, glyph, make } from "./dom.js";
import { clock, metres, percent, speed } from "./words.js";

/** Brings them up to date with the page's player and debugger. */
export function drawBars(page, state, time) {
  const { player, debug, live } = page, figures = state.newest.state;
  byId("clock").textContent = `${clock(time)} / ${clock(player.end, 0)}`;
  const line = byId("timeline");
  line.setAttribute("aria-valuenow", time.toFixed(1));
  line.setAttribute("aria-valuemax", player.end.toFixed(1));
  line.setAttribute("aria-valuetext", clock(time));
  setSign(byId("play"), player.playing ? "pause" : "running", player.playing ? "Hold" : "Play");
  byId("play").hidden = live && player.following;
  byId("speeds").hidden = live && player.following;
  setSign(byId("pause"), debug.paused ? "running" : "pause", debug.paused ? "Run" : "Pause");
  const held = debug.held.includes(page.robot);
  byId("hold").hidden = page.names.length < 2;
  setSign(byId("hold"), held ? "running" : "pause", page.robot);
  byId("hold").setAttribute("aria-pressed", String(held));
  for (const each of byId("robots").children) each.classList.toggle("held", debug.held.includes(each.dataset.name));
  byId("live").setAttribute("aria-pressed", String(player.following));
  document.body.classList.toggle("past", live && !player.following);
  for (const each of byId("run-controls").querySelectorAll("button")) each.disabled = debug.over;
  byId("why").textContent = live && !player.following ? "looking back" : debug.over ? `over: ${debug.why}` : live ? debug.why : "";
  if (!figures) return;
  const told = [["mapped", figures.coverage === null ? "–" : percent(figures.coverage)], ["driven", metres(figures.distance_m)], ["speed", speed(figures.speed_mps)]];
  if (figures.health !== "ok") told.push(["SLAM", figures.health]);
  if (figures.charge !== null && figures.charge !== undefined) told.push(["battery", percent(figures.charge)]);
  if (state.newest.gate?.braking) told.push(["held by", state.newest.gate.held_by ?? "the gate"]);
  const key = told.join();
  if (byId("figures").dataset.key === key) return;
  byId("figures").dataset.key = key;
  byId("figures").replaceChildren(...told.map(([name, value]) => make("div", { class: name === "SLAM" || name === "held by" || (name === "battery" && figures.charge < 0.2) ? "bad" : "" }, make("dt", {}, name), make("dd", {}, value))));
}

function setSign(button, name, words) {
  const sign = `${name} ${words}`;
  if (button.dataset.sign === sign) return;
  button.dataset.sign = sign;
  button.replaceChildren(glyph(name), make("span", {}, words));
}
