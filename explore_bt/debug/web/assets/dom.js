// Small helpers for building the page; foreign text only ever becomes text.

export const byId = (id) => document.getElementById(id);

/** An element with properties and children; strings become text nodes. */
export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "class") element.className = value;
    else if (name.includes("-")) element.setAttribute(name, value);
    else element[name] = value;
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const SVG = "http://www.w3.org/2000/svg";

/** An SVG element. */
export function draw(tag, attributes = {}, ...children) {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

const GLYPHS = {
  running: ["M3 1.5 12.5 7 3 12.5Z", "filled"],
  success: ["M2 7.5 5.6 11 12 3.4", "drawn"],
  failure: ["M2.8 2.8 11.2 11.2M11.2 2.8 2.8 11.2", "drawn"],
  idle: ["M7 3.2a3.8 3.8 0 1 0 0 7.6a3.8 3.8 0 1 0 0-7.6", "thin"],
  pause: ["M3.5 2h2.6v10H3.5ZM8 2h2.6v10H8Z", "filled"],
};

/** The sign of a status: its shape says as much as its colour. */
export function glyph(name) {
  const [path, kind] = GLYPHS[name] ?? GLYPHS.idle;
  return draw("svg", { viewBox: "0 0 14 14", class: `glyph ${kind} ${name}`, "aria-hidden": "true" }, draw("path", { d: path }));
}

/** Values of custom properties, for canvases. */
export function colours(...names) {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(names.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Calls back when the theme or the size of the element changes. */
export function watch(element, callback) {
  new ResizeObserver(callback).observe(element);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", callback);
}

/** Makes a canvas as fine as the screen; returns its context in CSS pixels. */
export function fitted(canvas) {
  const scale = window.devicePixelRatio || 1;
  const width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const pen = canvas.getContext("2d");
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  return pen;
}
