// The blackboard after a tick: what each key holds, who wrote it and when.

import { getWho } from "./api.js";
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

// Who wrote the selected key, what it was before, who has read it since, and all of its value.
async function drawValue() {
  value.hidden = !store.key;
  if (!store.key) return;
  const [key, tick] = [store.key, store.tick];
  try {
    const found = await getWho(key, tick);
    if (key !== store.key || tick !== store.tick) return;
    const by = (write) => `${write.writer ? tail(write.writer) : "an input of the mission"}, tick ${write.tick}`;
    const readers = found.readers.filter((reader) => reader.ticks.length);
    const lines = [
      key,
      `written by ${by(found)}; kept until ${found.until_tick ?? "the end"}`,
      found.previous ? `before: ${JSON.stringify(found.previous.value)?.slice(0, 200)} by ${by(found.previous)}` : "it had no value before",
      readers.length
        ? `read by ${readers.map((reader) => `${tail(reader.path)} @${reader.ticks.slice(0, 4).join(" @")}`).join(", ")}`
        : "nothing has read it since",
      JSON.stringify(found.value, null, 1),
    ];
    value.textContent = lines.join("\n");
  } catch (error) {
    value.textContent = error.message;
  }
}

export function tail(path) {
  return path.slice(path.lastIndexOf("/") + 1);
}
