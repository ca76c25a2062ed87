// Puts the page together: loads the run, follows a live one, moves through its ticks.

import { command, find, follow, getRun, getTick } from "./api.js";
import { initBoard } from "./board.js";
import { initDebug, order } from "./debug.js";
import { initGraph, seen } from "./graph.js";
import { foldIdle, initLanes, refreshLanes } from "./lanes.js";
import { initPanels } from "./panels.js";
import { initPicture } from "./picture.js";
import { change, onChange, store } from "./store.js";

const byId = (id) => document.getElementById(id);
const KEYS = {
  ArrowRight: () => go(store.tick + 1), ArrowLeft: () => go(store.tick - 1),
  Home: () => go(0), End: () => toEnd(), " ": () => play(),
  c: () => seek("change", 1), C: () => seek("change", -1),
  f: () => seek("failure", 1), F: () => seek("failure", -1),
  w: () => seek("write", 1), W: () => seek("write", -1),
  "/": () => byId("filter").focus(),
};

let loading = false;
let playing = null;
let lastLanes = 0;

async function start() {
  theme(localStorage.getItem("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light"));
  const run = await getRun();
  document.title = `${run.mission} · Cellwright`;
  byId("mission").textContent = run.mission;
  byId("about").textContent = [`seed ${run.seed}`, run.file, run.about].filter(Boolean).join(" · ");
  const last = Math.max(run.ticks - 1, 0);
  const asked = Number(new URLSearchParams(location.search).get("tick") ?? last);
  Object.assign(store, { run, from: 0, to: Math.max(last, 1), tick: Math.min(asked, last), following: !run.ended });
  initLanes();
  initBoard();
  initPicture();
  initGraph();
  initDebug(note);
  initPanels((tab) => { if (tab === "graph") seen(); });
  onChange((names) => { if (names.has("tick")) load(); });
  wire();
  showProgress();
  await load();
  follow(onProgress, () => note("the server is gone; trying again"));
}

// Loads the tick that is asked for; while one is on its way, only the latest wish counts.
async function load() {
  if (loading) return;
  loading = true;
  try {
    while (store.doc?.tick !== store.tick && store.run.ticks > 0) {
      const doc = await getTick(store.tick);
      if (doc.tick === store.tick) change({ doc });
    }
    byId("place").value =
      `tick ${store.tick} / ${Math.max(store.run.ticks - 1, 0)}   ${(store.doc?.time_s ?? 0).toFixed(2)} s`;
  } catch (error) {
    note(error.message);
  } finally {
    loading = false;
  }
}

function onProgress(progress) {
  const wasLast = store.to >= store.run.ticks - 1;
  Object.assign(store.run, progress);
  const last = Math.max(progress.ticks - 1, 0);
  showProgress();
  change({ state: progress.state });
  const values = {};
  if (wasLast && last > store.to) Object.assign(values, { to: last });
  if (store.following) values.tick = last;
  const now = performance.now();
  if (now - lastLanes > 250 || progress.complete) {
    lastLanes = now;
    change(values);
    if (!("to" in values)) refreshLanes();
  }
}

function showProgress() {
  const { report, ended, state } = store.run;
  const badge = byId("outcome");
  const live = state === null ? "killed" : state?.paused ? "paused" : "live";
  badge.textContent = ended ? report.outcome : live;
  badge.className = `badge ${badge.textContent}`;
  badge.title = report?.reason ?? state?.standing?.why ?? "";
  byId("commands").hidden = ended || !state;
  for (const button of document.querySelectorAll("[data-step], [data-command=resume]")) button.disabled = !state?.paused;
  document.querySelector("[data-command=pause]").disabled = Boolean(state?.paused);
}

function go(tick) {
  const last = store.run.ticks - 1;
  const to = Math.min(Math.max(tick, 0), last);
  const values = { tick: to, following: !store.run.ended && to === last };
  const span = store.to - store.from;
  if (to < store.from || to > store.to) {
    values.from = Math.max(0, Math.min(Math.round(to - span / 2), last - span));
    values.to = values.from + span;
  }
  change(values);
}

function toEnd() {
  go(store.run.ticks - 1);
}

function play() {
  clearInterval(playing);
  if (playing) {
    playing = null;
  } else {
    if (store.tick >= store.run.ticks - 1) go(0);
    const begun = performance.now();
    const first = store.tick;
    playing = setInterval(() => {
      const rate = store.run.tick_hz * Number(byId("speed").value);
      go(first + Math.round(((performance.now() - begun) / 1000) * rate));
      if (store.tick >= store.run.ticks - 1) play();
    }, 50);
  }
  byId("play").textContent = playing ? "❚❚" : "▶";
}

async function seek(kind, direction, more = {}) {
  try {
    const found = await find({
      kind, direction, from: store.tick, node: store.run.nodes[store.node].path, key: store.key ?? "", ...more,
    });
    note(found.tick === null ? "nothing further that way" : "");
    if (found.tick !== null) go(found.tick);
  } catch (error) {
    note(error.message);
  }
}

function wire() {
  byId("first").onclick = () => go(0);
  byId("back").onclick = () => go(store.tick - 1);
  byId("forward").onclick = () => go(store.tick + 1);
  byId("last").onclick = toEnd;
  byId("play").onclick = play;
  byId("fold").onclick = foldIdle;
  byId("unfold").onclick = () => change({ folded: new Set() });
  byId("filter").oninput = (event) => change({ filter: event.target.value.trim() });
  byId("theme").onclick = () => theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark");
  byId("search").onsubmit = (event) => {
    event.preventDefault();
    seek("where", event.submitter && event.shiftKey ? -1 : 1, { where: byId("expression").value });
  };
  byId("expression").onkeydown = (event) => {
    if (event.key !== "Enter" || !event.shiftKey) return;
    event.preventDefault();
    seek("where", -1, { where: byId("expression").value });
  };
  for (const button of document.querySelectorAll("[data-find]")) button.onclick = () => seek(button.dataset.find, 1);
  for (const button of document.querySelectorAll("[data-command]")) button.onclick = () => order(button.dataset.command);
  for (const button of document.querySelectorAll("[data-step]")) button.onclick = () => order("step", { step: button.dataset.step });
  document.addEventListener("keydown", (event) => {
    if (event.target.closest("input, select, textarea") || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = KEYS[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
}

function note(text) {
  byId("note").textContent = text;
}

function theme(name) {
  document.documentElement.dataset.theme = name;
  localStorage.setItem("theme", name);
  if (store.doc) change({ doc: store.doc });
}

start().catch((error) => note(error.message));
