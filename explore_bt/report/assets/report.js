"use strict";
(function () {
  const data = JSON.parse(document.getElementById("data").textContent);
  const canvas = document.getElementById("map");
  if (!data) { canvas.parentElement.hidden = true; return; }
  const byId = (id) => document.getElementById(id);
  const play = byId("play"), slider = byId("time"), clock = byId("clock"), speed = byId("speed"), now = byId("now");
  const map = data.map, end = Math.max(data.end_s, 1e-6);
  const context = canvas.getContext("2d");
  const picture = document.createElement("canvas");
  picture.width = map.cols; picture.height = map.rows;
  const pen = picture.getContext("2d");
  let cells = null, seen = null, shown = -1, time = data.end_s, playing = false, last = 0, colours = null;

  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  const stops = data.clearance.stops.map(rgb);
  function ramp(clearance) {
    if (clearance === null) return colours.soft;
    const share = (clearance - data.clearance.low) / (data.clearance.high - data.clearance.low);
    const place = Math.min(Math.max(share, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(place), stops.length - 2);
    return "rgb(" + stops[k].map((c, i) => Math.round(c + (stops[k + 1][i] - c) * (place - k))) + ")";
  }
  function readColours() {
    const style = getComputedStyle(document.documentElement);
    const of = (name) => style.getPropertyValue("--" + name).trim();
    colours = { unknown: of("unknown"), free: of("free"), wall: of("wall"), soft: of("soft"), ink: of("ink"), card: of("card") };
    shown = -1;
  }
  const words = (s) => Math.floor(s / 60) + ":" + String(Math.floor(s % 60)).padStart(2, "0");

  // grey pictures become values per cell; colours come later, because they follow the theme
  function load(uri) {
    return new Promise((done) => {
      const image = new Image();
      image.onload = () => {
        const sheet = document.createElement("canvas");
        sheet.width = map.cols; sheet.height = map.rows;
        const brush = sheet.getContext("2d", { willReadFrequently: true });
        brush.drawImage(image, 0, 0);
        const pixels = brush.getImageData(0, 0, map.cols, map.rows).data;
        done(Uint8Array.from({ length: map.cols * map.rows }, (_, i) => pixels[4 * i]));
      };
      image.src = uri;
    });
  }
  function paintMap() {
    const age = time >= data.end_s ? 255 : Math.floor(time / end * 254);
    if (age === shown) return;
    shown = age;
    const free = rgb(colours.free), wall = rgb(colours.wall), unknown = rgb(colours.unknown);
    const image = pen.createImageData(map.cols, map.rows);
    for (let i = 0; i < cells.length; i++) {
      const known = cells[i] > 60 && seen[i] <= age;
      const colour = !known ? unknown : cells[i] > 190 ? free : wall;
      image.data.set(colour, 4 * i);
      image.data[4 * i + 3] = 255;
    }
    pen.putImageData(image, 0, 0);
  }

  let scale = 1, left = 0, top = 0;
  function fit() {
    const width = canvas.clientWidth, metresX = map.cols * map.resolution, metresY = map.rows * map.resolution;
    const height = Math.max(200, Math.min(width * metresY / metresX, window.innerHeight * 0.78, 760));
    const dots = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * dots); canvas.height = Math.round(height * dots);
    canvas.style.height = height + "px";
    context.setTransform(dots, 0, 0, dots, 0, 0);
    scale = Math.min(width / metresX, height / metresY);
    left = (width - metresX * scale) / 2; top = (height - metresY * scale) / 2;
  }
  const toX = (x) => left + (x - map.origin[0]) * scale;
  const toY = (y) => top + (map.rows * map.resolution - (y - map.origin[1])) * scale;

  function indexAt(stamps, t) {
    let low = 0, high = stamps.length - 1;
    while (low < high) { const middle = (low + high + 1) >> 1; if (stamps[middle] <= t) low = middle; else high = middle - 1; }
    return low;
  }
  function drawPath(robot, upTo) {
    const coloured = byId("by-clearance").checked;
    context.lineCap = context.lineJoin = "round";
    context.lineWidth = Math.max(2, Math.min(4, 0.06 * scale));
    let i = 0;
    while (i < upTo) {  // one stroke as long as the colour stays the same
      const colour = coloured ? ramp(robot.clearance[i + 1]) : robot.colour;
      context.strokeStyle = colour;
      context.beginPath();
      context.moveTo(toX(robot.x[i]), toY(robot.y[i]));
      do { i++; context.lineTo(toX(robot.x[i]), toY(robot.y[i])); }
      while (i < upTo && (coloured ? ramp(robot.clearance[i + 1]) : robot.colour) === colour);
      context.stroke();
    }
  }
  function drawWaypoint(x, y, yaw, colour) {
    const size = Math.max(5, Math.min(9, 0.13 * scale));
    context.save();
    context.translate(toX(x), toY(y)); context.rotate(-yaw);
    context.beginPath();
    context.moveTo(size * 1.5, 0); context.lineTo(-size * 0.7, size * 0.75);
    context.lineTo(-size * 0.3, 0); context.lineTo(-size * 0.7, -size * 0.75); context.closePath();
    context.fillStyle = colour; context.strokeStyle = colours.card; context.lineWidth = 1.5;
    context.stroke(); context.fill();
    context.restore();
  }
  const ringRadius = (robot) => 1.3 * Math.max(6, robot.radius * scale);
  function drawStart(robot) {
    context.beginPath();
    context.arc(toX(robot.x[0]), toY(robot.y[0]), ringRadius(robot), 0, 7);
    context.strokeStyle = robot.colour; context.lineWidth = 2; context.setLineDash([4, 3]); context.stroke(); context.setLineDash([]);
  }
  function nameStart(robot) {
    const x = toX(robot.x[0]), y = toY(robot.y[0]) + ringRadius(robot) + 14;
    context.font = "600 12px system-ui, sans-serif"; context.textAlign = "center";
    context.strokeStyle = colours.free; context.lineWidth = 3; context.strokeText("start", x, y);
    context.fillStyle = colours.ink; context.fillText("start", x, y);
  }
  function drawRobot(robot, i) {
    const x = toX(robot.x[i]), y = toY(robot.y[i]), radius = Math.max(6, robot.radius * scale), yaw = -robot.yaw[i];
    context.beginPath(); context.arc(x, y, radius, 0, 7);
    context.globalAlpha = .88; context.fillStyle = robot.colour; context.fill(); context.globalAlpha = 1;
    context.strokeStyle = "#fff"; context.lineWidth = 2; context.stroke();
    context.beginPath(); context.moveTo(x, y);
    context.lineTo(x + radius * Math.cos(yaw), y + radius * Math.sin(yaw)); context.stroke();
  }
  function draw() {
    if (!cells) return;
    paintMap();
    context.fillStyle = colours.unknown;
    context.fillRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    context.imageSmoothingEnabled = false;
    context.drawImage(picture, left, top, map.cols * map.resolution * scale, map.rows * map.resolution * scale);
    const robots = data.robots.filter((robot) => robot.t.length), at = robots.map((robot) => indexAt(robot.t, time));
    robots.forEach((robot, k) => drawPath(robot, at[k]));
    robots.forEach((robot) => {
      drawStart(robot);
      if (!byId("show-waypoints").checked) return;
      for (const [stamp, x, y, yaw] of robot.waypoints)
        if (stamp <= time) drawWaypoint(x, y, yaw, data.robots.length > 1 ? robot.colour : colours.ink);
    });
    robots.forEach((robot, k) => drawRobot(robot, at[k]));
    robots.forEach(nameStart);
    clock.textContent = words(time);
    slider.value = Math.round(time / end * 1000);
    if (robots.length === 1) {
      const near = robots[0].clearance[at[0]], fast = robots[0].speed[at[0]];
      now.textContent = (near === null ? "" : near.toFixed(2) + " m clear · ") + fast.toFixed(2) + " m/s";
    }
    for (const cursor of document.querySelectorAll(".cursor")) {
      const from = Number(cursor.dataset.left), x = from + time / end * (Number(cursor.dataset.right) - from);
      cursor.setAttribute("x1", x); cursor.setAttribute("x2", x);
    }
  }
  function step(stamp) {
    if (!playing) return;
    time = Math.min(data.end_s, time + (stamp - last) / 1000 * Number(speed.value));
    last = stamp;
    draw();
    if (time >= data.end_s) setPlaying(false); else requestAnimationFrame(step);
  }
  function setPlaying(on) {
    playing = on;
    play.textContent = on ? "❚❚" : "▶";
    play.setAttribute("aria-label", on ? "Pause" : "Play the drive");
    if (!on) return;
    if (time >= data.end_s) time = 0;
    last = performance.now();
    requestAnimationFrame(step);
  }

  byId("ramp-low").textContent = "≤ " + data.clearance.low.toFixed(2) + " m";
  byId("ramp-high").textContent = data.clearance.high.toFixed(2) + " m";
  byId("ramp").querySelector("b").style.background = "linear-gradient(90deg," + data.clearance.stops + ")";
  byId("by-clearance").checked = data.robots.length === 1;
  const wanted = data.end_s / 20;
  speed.value = [1, 5, 10, 30, 100].reduce((best, s) => Math.abs(Math.log(s / wanted)) < Math.abs(Math.log(best / wanted)) ? s : best);
  play.addEventListener("click", () => setPlaying(!playing));
  slider.addEventListener("input", () => { setPlaying(false); time = slider.value >= 1000 ? data.end_s : slider.value / 1000 * end; draw(); });
  for (const id of ["by-clearance", "show-waypoints"]) byId(id).addEventListener("change", draw);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { readColours(); draw(); });
  window.addEventListener("resize", () => { fit(); draw(); });
  readColours();
  // report.html#t=42 opens at 42 seconds of mission time
  function readHash() {
    const found = /^#t=([\d.]+)$/.exec(location.hash);
    if (found) { setPlaying(false); time = Math.min(Number(found[1]), data.end_s); draw(); }
  }
  window.addEventListener("hashchange", readHash);
  readHash();
  Promise.all([load(map.cells), load(map.seen)]).then((loaded) => { [cells, seen] = loaded; fit(); draw(); });
})();
