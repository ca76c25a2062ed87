// What the server answers. Every failure becomes an Error with the server's own words.

async function checked(response) {
  if (response.ok) return response;
  let text = response.statusText;
  try { text = (await response.json()).error ?? text; } catch { /* the status has to do */ }
  throw new Error(text);
}

async function json(path) {
  return (await checked(await fetch(path))).json();
}

const query = (values) => new URLSearchParams(values).toString();

export const getRun = () => json("api/run");
export const getTick = (number) => json(`api/tick/${number}`);
export const getWho = (key, tick) => json(`api/who?${query({ key, tick })}`);
export const getHistory = (key) => json(`api/history?${query({ key })}`);
export const getReport = () => json("api/report");
export const ask = (node, tick) => json(`api/ask?${query({ node, tick })}`);
export const find = (values) => json(`api/find?${query(values)}`);

export async function getLanes(from, to, columns) {
  const response = await checked(await fetch(`api/lanes?${query({ from, to, columns })}`));
  const width = Number(response.headers.get("x-columns"));
  return { from, to, width, codes: new Uint8Array(await response.arrayBuffer()) };
}

export async function command(name, values = {}) {
  const response = await fetch("api/command", {
    method: "POST",
    headers: { "content-type": "application/json" },
    body: JSON.stringify({ command: name, ...values }),
  });
  return (await (await checked(response)).json()).answer;
}

// Calls `told` with the progress of the run at once and whenever it has changed. A server that
// comes back after a while is heard again; one whose run has ended closes the connection.
export function follow(told, lost) {
  const address = new URL("api/live", location.href);
  address.protocol = address.protocol.replace("http", "ws");
  let ended = false;
  const connect = () => {
    const socket = new WebSocket(address);
    socket.onmessage = (event) => {
      const progress = JSON.parse(event.data);
      ended = progress.ended;
      told(progress);
    };
    socket.onclose = () => {
      if (ended) return;
      lost();
      setTimeout(connect, 1000);
    };
  };
  connect();
}
