// The tree as an outline, and beside each node what it did in every tick.

import { getLanes } from "./api.js";
import { change, childrenOf, depths, MARKS, onChange, shownNodes, store } from "./store.js";

const ROW = 21;
const COLOURS = ["", "--success", "--running", "--halted", "--failure"];
const lanes = document.getElementById("lanes");
const names = document.getElementById("names");
const codes = document.getElementById("codes");
const axis = document.getElementById("axis");

let data = null;   // what the lanes show: { from, to, width, codes }
let shown = [];
let children = [];
let depth = [];
let wanted = 0;

export function initLanes() {
  children = childrenOf(store.run.nodes);
  depth = depths(store.run.nodes);
  onChange((names) => {
    if (names.has("folded") || names.has("filter")) drawNames();
    if (names.has("from") || names.has("to")) refreshLanes();
    if (names.has("doc") || names.has("node")) markNames();
    if (names.has("node")) document.querySelector(".row.selected")?.scrollIntoView({ block: "nearest" });
    draw();
  });
  lanes.addEventListener("scroll", draw);
  new ResizeObserver(() => { refreshLanes(); draw(); }).observe(lanes);
  for (const surface of [codes, axis]) scrubWith(surface);
  lanes.addEventListener("wheel", zoom, { passive: false });
  drawNames();
}

// Asks for the lanes of the span anew; answers that come too late are dropped.
export async function refreshLanes() {
  const mine = ++wanted;
  const columns = Math.max(1, Math.floor(laneWidth() * devicePixelRatio));
  const answer = await getLanes(store.from, store.to, columns);
  if (mine !== wanted) return;
  data = answer;
  draw();
}

export function foldIdle() {
  const ran = new Set();
  const { nodes } = store.run;
  for (let index = nodes.length - 1; index >= 0; index--) {
    const row = data.codes.subarray(index * data.width, (index + 1) * data.width);
    if (row.some((code) => code > 0) || ran.has(index)) { ran.add(index); ran.add(nodes[index].parent); }
  }
  change({ folded: new Set(nodes.map((_, index) => index).filter((i) => !ran.has(i) && children[i].length)) });
}

function laneWidth() {
  return Math.max(40, lanes.clientWidth - names.offsetWidth);
}

function drawNames() {
  const { nodes } = store.run;
  const found = shownNodes();
  shown = found.shown;
  names.replaceChildren(...shown.map((index) => {
    const node = nodes[index];
    const row = document.createElement("div");
    row.className = "row";
    row.classList.toggle("hit", found.hits[index]);
    row.dataset.node = index;
    row.style.paddingLeft = `${4 + depth[index] * 12}px`;
    row.title = `${node.path}\n${node.kind} ${node.type}  ${node.file}:${node.line}`;
    const twist = element("span", "twist", children[index].length ? (store.folded.has(index) ? "▸" : "▾") : "");
    twist.onclick = (event) => { event.stopPropagation(); toggle(index); };
    row.append(twist, element("span", "mark", ""), element("span", "name", node.name));
    if (node.type !== node.name) row.append(element("span", "kind", node.type));
    row.onclick = () => change({ node: index });
    row.ondblclick = () => toggle(index);
    return row;
  }));
  markNames();
}

function toggle(index) {
  if (!children[index].length) return;
  const folded = new Set(store.folded);
  if (!folded.delete(index)) folded.add(index);
  change({ folded });
}

function markNames() {
  if (!store.doc) return;
  const visited = new Set(store.doc.visited);
  for (const row of names.children) {
    const index = Number(row.dataset.node);
    const status = store.doc.statuses[index];
    const mark = row.children[1];
    mark.textContent = MARKS[status];
    mark.className = `mark ${status}`;
    row.classList.toggle("idle", !visited.has(index));
    row.classList.toggle("selected", index === store.node);
  }
}

function draw() {
  const width = laneWidth();
  const top = lanes.scrollTop;
  const height = Math.min(lanes.clientHeight, shown.length * ROW - top + 40);
  codes.style.left = `${names.offsetWidth}px`;
  codes.style.top = `${top}px`;
  const context = sized(codes, width, Math.max(1, height));
  const style = getComputedStyle(document.documentElement);
  if (data) drawCodes(context, style, width, top, height);
  drawHead(context, style, width, height);
  drawAxis(style, width);
}

function drawCodes(context, style, width, top, height) {
  const colours = COLOURS.map((name) => (name ? style.getPropertyValue(name) : ""));
  const scale = width / ((store.to - store.from + 1) || 1);
  const column = (data.to - data.from + 1) / data.width;
  const first = Math.floor(top / ROW);
  for (let i = first; i < shown.length && i * ROW - top < height; i++) {
    const base = shown[i] * data.width;
    const y = i * ROW - top;
    if (shown[i] === store.node) {
      context.fillStyle = style.getPropertyValue("--select");
      context.fillRect(0, y, width, ROW);
    }
    for (let start = 0; start < data.width;) {
      const code = data.codes[base + start];
      let end = start + 1;
      while (end < data.width && data.codes[base + end] === code) end++;
      if (code) {
        const left = (data.from + start * column - store.from) * scale;
        context.fillStyle = colours[code];
        context.fillRect(left, y + 4, Math.max(1, (end - start) * column * scale), ROW - 8);
      }
      start = end;
    }
  }
}

function drawHead(context, style, width, height) {
  const x = ((store.tick + 0.5 - store.from) / (store.to - store.from + 1)) * width;
  context.fillStyle = style.getPropertyValue("--accent");
  context.fillRect(Math.round(x), 0, 1.5, height);
}

function drawAxis(style, width) {
  const context = sized(axis, width, 33);
  context.font = "11px system-ui, sans-serif";
  context.fillStyle = style.getPropertyValue("--quiet");
  const span = store.to - store.from + 1;
  const step = niceStep(span / Math.max(1, width / 80));
  for (let tick = Math.ceil(store.from / step) * step; tick <= store.to; tick += step) {
    const x = ((tick + 0.5 - store.from) / span) * width;
    context.fillRect(x, 26, 1, 7);
    context.fillText(String(tick), x + 3, 29);
  }
  const x = ((store.tick + 0.5 - store.from) / span) * width;
  context.fillStyle = style.getPropertyValue("--accent");
  context.beginPath();
  context.moveTo(x - 5, 2); context.lineTo(x + 6, 2); context.lineTo(x + 0.5, 12);
  context.fill();
  context.fillRect(Math.round(x), 2, 1.5, 31);
}

function niceStep(least) {
  for (let power = 1; ; power *= 10) for (const digit of [1, 2, 5]) if (digit * power >= least) return digit * power;
}

function sized(canvas, width, height) {
  canvas.width = Math.round(width * devicePixelRatio);
  canvas.height = Math.round(height * devicePixelRatio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  const context = canvas.getContext("2d");
  context.scale(devicePixelRatio, devicePixelRatio);
  return context;
}

function scrubWith(surface) {
  const tickAt = (event) => {
    const box = surface.getBoundingClientRect();
    const part = (event.clientX - box.left) / box.width;
    const tick = Math.floor(store.from + part * (store.to - store.from + 1));
    return Math.min(Math.max(tick, 0), store.run.ticks - 1);
  };
  surface.addEventListener("pointerdown", (event) => {
    surface.setPointerCapture(event.pointerId);
    const row = Math.floor((event.clientY - codes.getBoundingClientRect().top + lanes.scrollTop) / ROW);
    const values = { tick: tickAt(event), following: false };
    if (surface === codes && shown[row] !== undefined) values.node = shown[row];
    change(values);
  });
  surface.addEventListener("pointermove", (event) => {
    if (event.buttons) change({ tick: tickAt(event), following: false });
  });
  surface.addEventListener("dblclick", () => change({ from: 0, to: Math.max(1, store.run.ticks - 1) }));
}

function zoom(event) {
  if (!event.ctrlKey && !event.shiftKey && !event.altKey) return;
  event.preventDefault();
  const last = Math.max(1, store.run.ticks - 1);
  const span = store.to - store.from + 1;
  const amount = event.deltaY || event.deltaX;
  if (event.shiftKey) {
    const by = Math.round(Math.min(Math.max(-store.from, Math.sign(amount) * span * 0.15), last - store.to));
    change({ from: store.from + by, to: store.to + by });
    return;
  }
  const box = codes.getBoundingClientRect();
  const part = Math.min(Math.max((event.clientX - box.left) / box.width, 0), 1);
  const grown = Math.min(Math.max(span * (amount > 0 ? 1.3 : 1 / 1.3), 10), last + 1);
  const from = Math.round(Math.min(Math.max(store.from + part * (span - grown), 0), last + 1 - grown));
  change({ from, to: Math.min(last, Math.round(from + grown - 1)) });
}

function element(tag, name, text) {
  const made = document.createElement(tag);
  made.className = name;
  made.textContent = text;
  return made;
}
