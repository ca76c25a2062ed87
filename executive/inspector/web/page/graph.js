// The tree as a graph, root at the left: drag to move, wheel to zoom, click to select.

import { make } from "./picture.js";
import { change, childrenOf, depths, MARKS, onChange, shownNodes, store } from "./store.js";

const WIDTH = 138, HEIGHT = 30, GAP_X = 30, GAP_Y = 7;
const panel = document.getElementById("graph");

let svg, stage, children, depth;
let view = null;    // the part of the drawing that is seen: { x, y, w, h }
let extent = { w: 1, h: 1 };
let steering = true; // whether the view goes where the tree is at work
let boxes = new Map();
let places = new Map();
let edges = new Map();

export function initGraph() {
  children = childrenOf(store.run.nodes);
  depth = depths(store.run.nodes);
  svg = make("svg", {});
  stage = make("g", {});
  svg.append(stage);
  const tools = document.createElement("div");
  tools.className = "tools";
  const acts = [["follow", centre], ["fit", fit], ["fold idle", foldIdle], ["unfold", () => change({ folded: new Set() })]];
  for (const [text, act] of acts) {
    const button = document.createElement("button");
    button.textContent = text;
    button.onclick = act;
    tools.append(button);
  }
  panel.replaceChildren(svg, tools);
  svg.addEventListener("wheel", zoom, { passive: false });
  svg.addEventListener("pointermove", (event) => { if (event.buttons) pan(event); });
  new ResizeObserver(() => { if (!panel.hidden) seen(); }).observe(panel);
  onChange((names) => {
    if (names.has("folded") || names.has("filter")) { layOut(); seen(); }
    if (names.has("doc") || names.has("node")) { mark(); if (steering) seen(); }
  });
  layOut();
}

// Shows what the panel is to show: it has been opened, or its size or the drawing has changed.
export function seen() {
  if (panel.hidden || !store.doc) return;
  steering || !view ? centre() : fit();
}

// Shows the deepest node that runs, or the last one that was asked, in its natural size.
function centre() {
  steering = true;
  const asked = store.doc.visited.filter((index) => places.has(index));
  const running = asked.filter((index) => store.doc.statuses[index] === "RUNNING");
  const deepest = [...(running.length ? running : asked)].sort((a, b) => depth[b] - depth[a])[0] ?? 0;
  const [x, y] = places.get(deepest) ?? [0, 0];
  const { clientWidth: w, clientHeight: h } = panel;
  const left = Math.min(Math.max(x - w * 0.66, -20), Math.max(extent.w - w + 20, -20));
  const top = extent.h < h ? (extent.h - h) / 2 : Math.min(Math.max(y - h / 2, -20), extent.h - h + 20);
  view = { x: left, y: top, w, h };
  show();
}

function fit() {
  steering = false;
  const box = panel.getBoundingClientRect();
  if (!box.width) return;
  const scale = Math.max(extent.w / box.width, extent.h / box.height, 0.7);
  const [w, h] = [box.width * scale, box.height * scale];
  view = { x: (extent.w - w) / 2, y: (extent.h - h) / 2, w, h };
  show();
}

// Folds every branch that was not asked in this tick.
function foldIdle() {
  const asked = new Set(store.doc.visited);
  change({ folded: new Set(children.flatMap((below, index) => (below.length && !asked.has(index) ? [index] : []))) });
}

// Leaves one below the other, parents in the middle of their children.
function layOut() {
  const { shown } = shownNodes();
  const visible = new Set(shown);
  const at = new Map();
  let next = 0;
  for (const index of [...shown].reverse()) {
    const below = children[index].filter((child) => visible.has(child));
    const y = below.length
      ? (at.get(below[0]) + at.get(below.at(-1))) / 2
      : -(next++) * (HEIGHT + GAP_Y);
    at.set(index, y);
  }
  const top = Math.min(...at.values());
  const place = (index) => [depth[index] * (WIDTH + GAP_X), at.get(index) - top];
  extent = {
    w: (Math.max(...shown.map((index) => depth[index])) + 1) * (WIDTH + GAP_X),
    h: next * (HEIGHT + GAP_Y),
  };
  edges = new Map();
  boxes = new Map();
  places = new Map(shown.map((index) => [index, place(index)]));
  for (const index of shown) {
    const { parent } = store.run.nodes[index];
    if (parent !== null && visible.has(parent)) edges.set(index, edge(place(parent), place(index)));
    boxes.set(index, box(index, place(index)));
  }
  stage.replaceChildren(...edges.values(), ...boxes.values());
  mark();
}

function edge([x1, y1], [x2, y2]) {
  const [left, right] = [x1 + WIDTH, x2];
  const middle = (left + right) / 2;
  const d = `M${left} ${y1 + HEIGHT / 2}C${middle} ${y1 + HEIGHT / 2} ${middle} ${y2 + HEIGHT / 2} ${right} ${y2 + HEIGHT / 2}`;
  return make("path", { d, class: "edge" });
}

function box(index, [x, y]) {
  const node = store.run.nodes[index];
  const group = make("g", { class: "box", transform: `translate(${x} ${y})` });
  group.append(make("rect", { width: WIDTH, height: HEIGHT }));
  group.append(text(7, 19, "", "status"), text(23, node.type === node.name ? 19 : 14, cut(node.name, 18), "name"));
  if (node.type !== node.name) group.append(text(23, 25, cut(node.type, 22), "sub"));
  const title = make("title", {});
  title.textContent = `${node.path}\n${node.kind} ${node.type}`;
  group.append(title);
  if (children[index].length) {
    const folded = store.folded.has(index);
    const twist = text(WIDTH - 14, 19, folded ? "▸" : "▾", "twist");
    twist.addEventListener("click", (event) => { event.stopPropagation(); toggle(index); });
    group.append(twist);
  }
  group.addEventListener("click", () => change({ node: index }));
  group.addEventListener("dblclick", () => toggle(index));
  return group;
}

function toggle(index) {
  const folded = new Set(store.folded);
  if (!folded.delete(index)) folded.add(index);
  change({ folded });
}

function mark() {
  if (!store.doc) return;
  const visited = new Set(store.doc.visited);
  for (const [index, group] of boxes) {
    const status = store.doc.statuses[index];
    const classes = ["box", visited.has(index) ? `s-${status}` : "idle", index === store.node ? "selected" : ""];
    group.setAttribute("class", classes.join(" "));
    const sign = group.querySelector(".status");
    sign.textContent = MARKS[status];
    sign.setAttribute("class", `status ${status}`);
    sign.style.fill = "currentColor";
  }
  for (const [index, path] of edges) path.classList.toggle("hot", visited.has(index));
}

function show() {
  svg.setAttribute("viewBox", `${view.x} ${view.y} ${view.w} ${view.h}`);
}

function zoom(event) {
  event.preventDefault();
  steering = false;
  const box = panel.getBoundingClientRect();
  const factor = event.deltaY > 0 ? 1.15 : 1 / 1.15;
  const [px, py] = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  view = {
    x: view.x + view.w * px * (1 - factor), y: view.y + view.h * py * (1 - factor),
    w: view.w * factor, h: view.h * factor,
  };
  show();
}

function pan(event) {
  steering = false;
  const scale = view.w / panel.clientWidth;
  view = { ...view, x: view.x - event.movementX * scale, y: view.y - event.movementY * scale };
  show();
}

function text(x, y, content, name) {
  const element = make("text", { x, y, class: name });
  element.textContent = content;
  return element;
}

function cut(words, length) {
  return words.length > length ? `${words.slice(0, length - 1)}…` : words;
}
