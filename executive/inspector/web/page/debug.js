// Commands to a run that goes on: breakpoints, steps, forced answers.

import { command } from "./api.js";
import { change, onChange, store } from "./store.js";

const panel = document.getElementById("debug");
const tab = document.querySelector("[data-tab=debug]");

let note = () => {};
let drawn = "";
let stoodAt = "";

export function initDebug(noted) {
  note = noted;
  onChange((names) => {
    if (!names.has("state") && !names.has("node")) return;
    tab.hidden = !store.state;
    if (names.has("state")) selectStanding(store.state?.standing);
    draw();
  });
}

// Selects the node that the run has just come to stand at.
function selectStanding(place) {
  const stood = `${place?.tick} ${place?.node}`;
  if (place?.node && stood !== stoodAt) change({ node: store.run.nodes.findIndex((node) => node.path === place.node) });
  stoodAt = stood;
}

// Sends a command; the answer is the state after it.
export async function order(name, values = {}) {
  try {
    const state = await command(name, values);
    store.run.state = state;
    change({ state });
    note("");
  } catch (error) {
    note(error.message);
  }
}

function draw() {
  const { state } = store;
  const identity = JSON.stringify([state, store.node]);
  if (!state || identity === drawn) return;
  drawn = identity;
  const { path, name } = store.run.nodes[store.node];
  panel.replaceChildren(
    line("p", "answer", standing(state)),
    line("h3", "", "Breakpoints"),
    adding(path.split("/").slice(-2).join("/")),
    list(state.breakpoints.map((one) => [
      `${one.text}   hit ${one.hits}×`, "remove", () => order("unbreak", { number: one.number }),
    ])),
    line("h3", "", `Answers of ${name}`),
    forcing(path),
    list(Object.entries(state.forced).map(([path, answer]) => [
      `${path} = ${answer}`, "release", () => order("unforce", { nodes: path }),
    ])),
  );
}

function standing({ standing: place }) {
  if (!place) return "The mission is running.";
  const where = place.node ? `${place.answered ? "after" : "before"} ${place.node}` : "between two ticks";
  return `Paused at tick ${place.tick}, ${where}: ${place.why}`;
}

function adding(name) {
  const form = document.createElement("form");
  const input = document.createElement("input");
  input.value = name;
  input.placeholder = "NODE [on EVENT] [when EXPRESSION]";
  const button = line("button", "", "break");
  form.append(input, button);
  form.onsubmit = (event) => {
    event.preventDefault();
    order("break", { text: input.value });
  };
  return form;
}

function forcing(name) {
  const row = line("p", "group", "");
  for (const answer of ["success", "failure", "running"]) {
    const button = line("button", "", answer);
    button.title = `Answer ${answer} in its place, until released`;
    button.onclick = () => order("force", { nodes: name, answer });
    row.append(button);
  }
  return row;
}

function list(items) {
  const all = document.createElement("ul");
  all.append(...items.map(([text, label, act]) => {
    const item = document.createElement("li");
    const button = line("button", "", label);
    button.onclick = act;
    item.append(line("code", "", text), button);
    return item;
  }));
  return all;
}

function line(tag, name, text) {
  const element = document.createElement(tag);
  element.className = name;
  element.textContent = text;
  return element;
}
