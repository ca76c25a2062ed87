// What the page shows: one place, and everything that draws is told when it changes.

export const store = {
  run: null,        // what api/run answered
  tick: 0,          // number of the tick that is shown
  doc: null,        // everything about that tick
  node: 0,          // index of the selected node
  key: null,        // selected key of the blackboard
  folded: new Set(),
  filter: "",
  from: 0, to: 1,   // ticks that the lanes span
  following: false, // whether the last tick of a live run is shown
  state: undefined, // what the debugger of a live run says; null where nothing runs it
};

const listeners = [];

export function onChange(listener) {
  listeners.push(listener);
}

// Tells everybody what has changed: a set of the store's field names.
export function change(values) {
  Object.assign(store, values);
  const names = new Set(Object.keys(values));
  for (const listener of listeners) listener(names);
}

export const MARKS = { SUCCESS: "✓", FAILURE: "✗", RUNNING: "▶", INVALID: "·" };

export function childrenOf(nodes) {
  const children = nodes.map(() => []);
  nodes.forEach((node, index) => { if (node.parent !== null) children[node.parent].push(index); });
  return children;
}

// Nodes that the filter asks for, with the way down to each; all of them without a filter.
export function shownNodes() {
  const { nodes } = store.run;
  const words = store.filter.toLowerCase();
  const hits = nodes.map((node) => words !== "" && `${node.path} ${node.type}`.toLowerCase().includes(words));
  const kept = hits.slice();
  for (let index = nodes.length - 1; index > 0; index--) if (kept[index]) kept[nodes[index].parent] = true;
  const hidden = nodes.map(() => false);
  const shown = [];
  nodes.forEach((node, index) => {
    const parent = node.parent;
    hidden[index] = parent !== null && (hidden[parent] || (words === "" && store.folded.has(parent)));
    if (!hidden[index] && (words === "" || kept[index])) shown.push(index);
  });
  return { shown, hits };
}

export function depths(nodes) {
  const depth = [];
  for (const node of nodes) depth.push(node.parent === null ? 0 : depth[node.parent] + 1);
  return depth;
}
