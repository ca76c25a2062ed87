// The panels of text, and the 3-D scene.

import { ask, getReport } from "./api.js";
import { change, MARKS, onChange, store } from "./store.js";

const panel = (name) => document.getElementById(name);

let open = "picture";
let framed = false;

export function initPanels(opened) {
  for (const tab of document.querySelectorAll("[data-tab]")) tab.onclick = () => openTab(tab.dataset.tab, opened);
  onChange((names) => {
    if (names.has("doc") || names.has("node")) refresh();
  });
  openTab("picture", opened);
}

export function openTab(name, opened = () => {}) {
  open = name;
  for (const tab of document.querySelectorAll("[data-tab]")) {
    const chosen = tab.dataset.tab === name;
    tab.setAttribute("aria-selected", String(chosen));
    panel(tab.dataset.tab).hidden = !chosen;
  }
  refresh();
  opened(name);
}

function refresh() {
  if (!store.doc) return;
  if (open === "why") drawAnswers();
  if (open === "source") drawSource();
  if (open === "report") drawReport();
  if (open === "scene") drawScene();
}

async function drawAnswers() {
  const [node, tick] = [store.node, store.tick];
  const { path } = store.run.nodes[node];
  const shown = [line("p", "quiet", `${path} at tick ${tick}`)];
  shown.push(...store.doc.faults.map((fault) => block(`${fault.path || "cell"}: ${fault.message}`, fault.traceback)));
  try {
    const { answers } = await ask(path, tick);
    shown.push(...answers.map(told));
  } catch (error) {
    shown.push(line("p", "quiet", error.message));
  }
  if (node === store.node && tick === store.tick) panel("why").replaceChildren(...shown);
}

// The headline, then the way from the root down; each step leads to its node and tick.
function told(answer) {
  const section = document.createElement("section");
  section.append(line("p", "answer", answer.answer), ...answer.notes.map((note) => line("p", "quiet", note)));
  for (const { title, steps } of answer.sections) {
    const list = document.createElement("ul");
    list.className = "chain";
    list.append(...steps.map(step));
    section.append(line("p", "quiet", `${title}:`), list);
  }
  return section;
}

function step({ path, text, status, file, line: number, tick }) {
  const item = line("li", "", "");
  if (path === null) {
    item.append(line("b", "", "the runner "), text);
    return item;
  }
  const node = store.run.nodes.findIndex((one) => one.path === path);
  const name = line("a", status, `${MARKS[status]} ${path.slice(path.lastIndexOf("/") + 1)}`);
  name.href = "#";
  name.onclick = (event) => { event.preventDefault(); change({ node, tick }); };
  item.append(name, ` ${text} `, line("span", "quiet", `${file.slice(file.lastIndexOf("/") + 1)}:${number}`));
  return item;
}

function block(title, text) {
  const section = document.createElement("section");
  section.append(line("p", "answer FAILURE", title), line("pre", "", text));
  return section;
}

function drawSource() {
  const node = store.run.nodes[store.node];
  const source = store.run.sources.find((one) => one.file === node.file);
  if (!source) {
    panel("source").replaceChildren(line("p", "quiet", `${node.file} is not in the recording`));
    return;
  }
  const lines = source.text.split("\n").map((text, index) => {
    const row = line("div", "source-line", "");
    row.append(line("span", "no", index + 1), line("span", "", text));
    row.classList.toggle("at", index + 1 === node.line);
    return row;
  });
  panel("source").replaceChildren(line("p", "quiet", node.file), ...lines);
  lines[node.line - 1]?.scrollIntoView({ block: "center" });
}

async function drawReport() {
  try {
    const report = await getReport();
    panel("report").innerHTML = `<div class="report">${report.html}</div>`;
  } catch (error) {
    panel("report").replaceChildren(line("p", "quiet", error.message));
  }
}

// The replay is one page of its own; it is told where in time to stand.
function drawScene() {
  if (!framed) {
    framed = true;
    const frame = document.createElement("iframe");
    frame.src = "scene";
    frame.title = "3-D scene";
    frame.onload = () => place();
    panel("scene").replaceChildren(frame);
  }
  place();
}

function place() {
  const frame = panel("scene").querySelector("iframe");
  frame?.contentWindow?.postMessage({ seek_s: store.doc.time_s }, location.origin);
}

function line(tag, name, text) {
  const element = document.createElement(tag);
  element.className = name;
  element.textContent = text;
  return element;
}
