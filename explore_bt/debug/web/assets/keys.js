// Keyboard shortcuts, and the list of them.

import { make } from "./dom.js";

export const KEYS = [
  ["space", "pause or run; in a recording, play or hold"],
  ["p", "pause or run the chosen robot alone, of several"],
  ["n", "to the next tick"], ["N", "to the end of the next node (in a recording, the next change)"],
  ["c", "to the next change of a status"], ["b", "a tick back"], ["C", "to the change before"],
  ["← →", "a second back or on; with shift, ten"],
  ["Home End", "to the beginning; to the end, or back to now"],
  ["1 2 3", "play at 1 ×, 4 ×, 16 ×"],
  ["/", "find a node"], ["f u", "fold what is idle; unfold everything"],
  ["↑ ↓ Enter", "in the tree: up, down, fold"],
  ["+ - 0", "map: zoom in, zoom out, show everything"], ["r", "follow the robot"], ["l", "layers"],
  ["?", "this list"],
];

/** `actions`: key -> what it does; typing in a field is left alone. */
export function listen(actions) {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector("dialog[open]")) return;
    const typing = event.target.closest("input, select, textarea");
    if (typing) { if (event.key === "Escape") typing.blur(); return; }
    if (event.key === " " && event.target.closest("button, summary")) event.target.blur();
    const name = event.shiftKey && event.key.startsWith("Arrow") ? `Shift${event.key}` : event.key;
    const action = actions[name];
    if (!action) return;
    event.preventDefault();
    action();
  });
}

/** Fills the dialog with the list. */
export function fillHelp(dialog) {
  const rows = KEYS.map(([key, words]) => make("tr", {}, make("th", {}, ...key.split(" ").map((each) => make("kbd", {}, each))), make("td", {}, words)));
  const close = make("button", {}, "Close");
  close.onclick = () => dialog.close();
  dialog.replaceChildren(
    make("h2", {}, "Keyboard"), make("table", {}, make("tbody", {}, ...rows)),
    make("p", { class: "hint" }, "Timeline: drag to move in time, wheel to zoom, double-click for all of it. Map: drag, wheel, pinch."), close,
  );
}
