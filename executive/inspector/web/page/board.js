// The blackboard after a tick: what each key holds, who wrote it and when.

import { getHistory, getValue } from "./api.js";
import { change, onChange, store } from "./store.js";

const states = document.getElementById("states");
const value = document.getElementById("value");
const filter = document.getElementById("keys");

export function initBoard() {
  filter.addEventListener("input", drawStates);
  onChange((names) => {
    if (names.has("doc") || names.has("key")) drawStates();
    if (names.has("key") || (names.has("doc") && store.key)) drawValue();
  });
}

function drawStates() {
  if (!store.doc) return;
  const words = filter.value.toLowerCase();
  const rows = store.doc.board.filter((row) => row.key.toLowerCase().includes(words));
  states.replaceChildren(...rows.map((row) => {
    const line = document.createElement("tr");
    line.classList.toggle("fresh", row.fresh);
    line.classList.toggle("selected", row.key === store.key);
    for (const [text, title] of [
      [tail(row.key), row.key], [row.value, row.value],
      [row.writer ? tail(row.writer) : "input", row.writer], [row.tick, `written at tick ${row.tick}`],
    ]) {
      const cell = line.insertCell();
      cell.textContent = text;
      cell.title = title;
    }
    line.onclick = () => change({ key: row.key === store.key ? null : row.key });
    return line;
  }));
  document.getElementById("board-note").textContent =
    `${rows.length} of ${store.doc.board.length} keys; bold: written in this tick`;
}

async function drawValue() {
  value.hidden = !store.key;
  if (!store.key) return;
  const [key, tick] = [store.key, store.tick];
  try {
    const [found, history] = await Promise.all([getValue(key, tick), getHistory(key)]);
    if (key !== store.key || tick !== store.tick) return;
    const writes = history.writes.filter((write) => write.tick <= tick);
    const before = writes.length > 1 ? `\nbefore   ${writes.at(-2).value}  (tick ${writes.at(-2).tick})` : "";
    value.textContent =
      `${key}\nwritten  at tick ${found.tick} by ${found.writer || "the mission's input"}; ` +
      `${history.writes.length} writes in all${before}\n${JSON.stringify(found.value, null, 1)}`;
  } catch (error) {
    value.textContent = error.message;
  }
}

export function tail(path) {
  return path.slice(path.lastIndexOf("/") + 1);
}
