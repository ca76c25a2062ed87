// The latest camera image of a tick, with what was believed about it laid over it.

import { onChange, store } from "./store.js";

const SVG = "http://www.w3.org/2000/svg";
const COLOURS = { good: "#41d18a", doubtful: "#ffc13d", bad: "#ff5c5c", hand: "#35c3ff", end: "#ff7ef2" };
const panel = document.getElementById("picture");

let drawn = "";      // what is on the panel, so that a tick without news costs nothing
let layers = true;

export function initPicture() {
  onChange((names) => { if (names.has("doc")) draw(); });
  panel.addEventListener("mouseover", (event) => hint(event.target.dataset?.about));
}

function draw() {
  const picture = store.doc?.picture;
  const identity = JSON.stringify([picture, layers]);
  if (identity === drawn) return hint();
  drawn = identity;
  if (!picture) {
    panel.innerHTML = '<p class="empty">No image has been written to the blackboard yet.</p>';
    return;
  }
  const [width, height] = picture.size_px;
  const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  svg.append(make("image", { href: `api/image/${picture.image}.png`, width, height }));
  if (layers) for (const shape of picture.shapes) svg.append(...drawShape(shape, width));
  const note = document.createElement("div");
  note.className = "hint";
  const toggle = document.createElement("button");
  toggle.className = "layers";
  toggle.textContent = layers ? "hide beliefs" : "show beliefs";
  toggle.onclick = () => { layers = !layers; draw(); };
  panel.replaceChildren(svg, note, toggle);
  hint();
}

function hint(text) {
  const note = panel.querySelector(".hint");
  const picture = store.doc?.picture;
  if (note && picture) note.textContent = text ?? `image ${picture.image}, written at tick ${picture.tick}${age(picture)}`;
}

function age(picture) {
  const seconds = store.doc.time_s - picture.time_s;
  return seconds > 0 ? `, ${seconds.toFixed(1)} s before` : "";
}

function drawShape(shape, width) {
  const size = width / 1000;
  const [x, y] = shape.points[0] ?? [0, 0];
  const colour = COLOURS[shape.colour];
  const about = { "data-about": shape.about };
  const parts = [];
  if (shape.kind === "line") parts.push(...rainbow(shape.points, size, about));
  if (shape.kind === "dot") parts.push(make("circle", { cx: x, cy: y, r: 5 * size, fill: colour, stroke: "#000", "stroke-width": size, ...about }));
  if (shape.kind === "ring") parts.push(make("circle", { cx: x, cy: y, r: 11 * size, fill: "transparent", stroke: colour, "stroke-width": 2.5 * size, ...about }));
  if (shape.kind === "arrow") {
    const [u, v] = shape.points[1];
    parts.push(make("line", { x1: x, y1: y, x2: u, y2: v, stroke: colour, "stroke-width": 2.5 * size, ...about }));
  }
  if (shape.label) {
    const text = make("text", { x: x + 12 * size, y: y - 9 * size, fill: colour, "font-size": 15 * size,
      "font-weight": 600, stroke: "#000", "stroke-width": 3 * size, "paint-order": "stroke" });
    text.textContent = shape.label;
    parts.push(text);
  }
  return parts;
}

function rainbow(points, size, about) {
  const lines = [];
  const step = Math.max(1, Math.floor(points.length / 160));
  for (let i = 0; i + 1 < points.length; i += step) {
    const part = points.slice(i, i + step + 1).map((point) => point.join(",")).join(" ");
    lines.push(make("polyline", {
      points: part, fill: "none", stroke: `hsl(${(300 * i) / points.length} 95% 58%)`,
      "stroke-width": 3 * size, "stroke-linecap": "round", ...about,
    }));
  }
  return lines;
}

export function make(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) if (value !== "") element.setAttribute(key, value);
  return element;
}
