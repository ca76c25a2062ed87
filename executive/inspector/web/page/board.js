// The blackboard after a tick: what each key holds, who wrote it and when.

import { getHistory, getWho } from "./api.js";
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
    const [scope, name] = tail(row.key).split(":");
    const first = line.insertCell();
    first.title = row.key;
    first.append(name, " ", quiet(scope));
    for (const [text, title] of [
      [row.value, row.value],
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
    const [found, history] = await Promise.all([getWho(key, tick), getHistory(key)]);
    if (key !== store.key || tick !== store.tick) return;
    const by = (write) => `${write.writer ? tail(write.writer) : "an input of the mission"} @${write.tick}`;
    const place = history.writes.findIndex((write) => write.tick === found.tick);
    const before = history.writes[place - 1];
    const readers = found.readers.filter((reader) => reader.ticks.length);
    const lines = [
      key,
      `written by ${by(found)}, kept until ${found.until_tick === null ? "the end" : `@${found.until_tick}`}`,
      before ? `before: ${before.value}  by ${by(before)}` : "it had no value before",
      readers.length
        ? `read by ${readers.map((reader) => `${tail(reader.path)} @${reader.ticks.slice(0, 4).join(" @")}`).join(", ")}`
        : "nothing has read it since",
    ];
    value.replaceChildren(`${lines.join("\n")}\n`, ...ticksOf(history.writes, place),
      `\n\n${JSON.stringify(found.value, null, 1)}`);
  } catch (error) {
    value.textContent = error.message;
  }
}

// The ticks in which the key was written, near the one that counts; each leads there.
function ticksOf(writes, place) {
  const near = writes.slice(Math.max(0, place - 5), place + 6);
  const links = near.map((write) => {
    const link = document.createElement("a");
    link.href = "#";
    link.textContent = `@${write.tick}`;
    link.title = write.value;
    if (write === writes[place]) link.className = "here";
    link.onclick = (event) => { event.preventDefault(); change({ tick: write.tick, following: false }); };
    return link;
  });
  return [`${writes.length} writes: `, ...links.flatMap((link) => [link, " "])];
}

function quiet(text) {
  const element = document.createElement("span");
  element.className = "quiet";
  element.textContent = text;
  return element;
}

export function tail(path) {
  return path.slice(path.lastIndexOf("/") + 1);
}
