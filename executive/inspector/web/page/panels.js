// The panels of text, and the 3-D scene.

import { ask, getReport } from "./api.js";
import { onChange, store } from "./store.js";

const QUESTIONS = ["why", "why-not", "why-halted"];
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
  const answers = await Promise.all(QUESTIONS.map((question) => ask(question, path, tick).catch((error) => ({ error }))));
  if (node !== store.node || tick !== store.tick) return;
  const faults = store.doc.faults.map((fault) => block(`${fault.path || "cell"}: ${fault.message}`, fault.traceback));
  panel("why").replaceChildren(line("p", "quiet", `${path} at tick ${tick}`), ...faults,
    ...answers.filter((answer) => !answer.error).map((answer) => told(answer.lines)));
  const said = answers.find((answer) => answer.error);
  if (answers.every((answer) => answer.error)) panel("why").append(line("p", "quiet", said.error.message));
}

function told([first, ...rest]) {
  const section = document.createElement("section");
  section.append(line("p", "answer", first));
  const list = document.createElement("ul");
  list.className = "chain";
  list.append(...rest.map((text) => line("li", "", text)));
  section.append(list);
  return section;
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
