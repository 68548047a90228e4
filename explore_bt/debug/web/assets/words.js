// Numbers in words: times are human, figures carry units.

/** 3:07.4, or 1:03:07.4 */
export function clock(seconds, digits = 1) {
  const tenths = Math.round(seconds * 10 ** digits) / 10 ** digits;
  const hours = Math.floor(tenths / 3600), minutes = Math.floor(tenths / 60) % 60;
  const rest = (tenths % 60).toFixed(digits).padStart(digits ? 3 + digits : 2, "0");
  return hours ? `${hours}:${String(minutes).padStart(2, "0")}:${rest}` : `${minutes}:${rest}`;
}

export const percent = (share) => (share >= 1 ? "100 %" : `${Math.min(share * 100, 99.9).toFixed(1)} %`);
export const metres = (length) => `${length.toFixed(1)} m`;
export const speed = (mps) => `${Math.abs(mps).toFixed(2)} m/s`;

/** A recorded value in one line. */
export function brief(value, most = 160) {
  const text = told(value, 0);
  return text.length > most ? `${text.slice(0, most - 1)}…` : text;
}

function told(value, depth) {
  if (value === null || value === undefined) return "none";
  if (typeof value === "number") return Number.isInteger(value) ? String(value) : String(+value.toFixed(3));
  if (typeof value !== "object") return String(value);
  if (depth > 2) return "…";
  if (Array.isArray(value)) return `[${value.map((each) => told(each, depth + 1)).join(", ")}]`;
  return toldObject(value, depth);
}

function toldObject(value, depth) {
  if (value.class === "Pose2") return `(${told(value.x)}, ${told(value.y)}, ${(value.yaw_rad * 180 / Math.PI).toFixed(0)}°)`;
  if (value.class === "Waypoint") return `${told(value.pose, depth)}${value.reason ? ` ${value.reason}` : ""}`;
  if (value.class === "sequence") return `${value.length} items … ${told(value.last, depth + 1)}`;
  if (value.class === "ndarray") return `array ${value.shape.join(" × ")}`;
  const members = Object.entries(value).filter(([name]) => name !== "class");
  const inside = members.map(([name, each]) => `${name} ${told(each, depth + 1)}`).join(", ");
  return value.class ? `${value.class}${inside ? `(${inside})` : ""}` : `{${inside}}`;
}
