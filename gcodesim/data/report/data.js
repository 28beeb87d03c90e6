"use strict";
// Reads what the page carries: the index (JSON) and the block of arrays behind it.
const G = { runs: [], time: 0, listeners: [] };

G.unpack = async (id) => {
  const text = atob(document.getElementById(id).textContent);
  const packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
};

// The columns of an entry, each an array of n numbers; low bytes stand before high ones, values are differences.
G.columns = (entry) => {
  const { at, bytes, rows: n, columns: k } = entry, size = +entry.type.slice(1) / 8;
  const raw = new Uint8Array(G.block, at, bytes), count = n * k, found = [];
  for (let c = 0; c < k; c++) {
    const whole = size === 1 ? new Uint8Array(n) : size === 2 ? new Uint16Array(n) : new Uint32Array(n);
    let sum = 0;
    for (let i = 0; i < n; i++) {
      let difference = 0;
      for (let b = 0; b < size; b++) difference += raw[b * count + c * n + i] * 2 ** (8 * b);
      sum += difference;
      whole[i] = sum; // wraps around like the differences did
      sum = whole[i];
    }
    if (!entry.step) {
      found.push(entry.base ? Float64Array.from(whole, (v) => v + entry.base) : whole);
      continue;
    }
    const low = entry.low[c], step = entry.step[c], values = new Float32Array(n);
    for (let i = 0; i < n; i++) values[i] = low + whole[i] * step;
    found.push(values);
  }
  return found;
};
G.column = (entry) => G.columns(entry)[0] || [];
// Rows one after the other, as graphics take them.
G.rows = (entry, kind = Float32Array) => {
  const columns = G.columns(entry), k = columns.length, n = entry.rows, flat = new kind(n * k);
  for (let c = 0; c < k; c++) for (let i = 0; i < n; i++) flat[i * k + c] = columns[c][i];
  return flat;
};
G.text = (entry) => entry ? new TextDecoder().decode(new Uint8Array(G.block, entry.at, entry.bytes)) : "";

// The last index i with list[i] <= value, -1 before the first.
G.index = (list, value) => {
  let low = 0, high = list.length;
  while (low < high) { const middle = (low + high) >> 1; if (list[middle] <= value) low = middle + 1; else high = middle; }
  return low - 1;
};

// The set-ups of a job are shown one at a time: the one that the address names (`#setup=top`), else the last.
G.chosenSetup = (runs) => {
  const wish = new URLSearchParams(location.hash.slice(1)).get("setup");
  G.setupNames = runs.map((run) => run.name);
  return runs.find((run) => run.name === wish) || runs[runs.length - 1];
};
G.showSetup = (name) => { location.hash = new URLSearchParams({ setup: name }); location.reload(); };

G.load = async () => {
  const index = JSON.parse(new TextDecoder().decode(await G.unpack("index")));
  G.block = await G.unpack("blob");
  G.setups = index.setups || null;
  G.runs = (G.setups ? [G.chosenSetup(index.runs)] : index.runs).map((run) => {
    const scale = index.tick_s, seconds = (entry) => Float64Array.from(G.column(entry), (t) => t * scale);
    const blocks = { t: seconds(run.blocks.t), line: G.column(run.blocks.line), modal: G.column(run.blocks.modal) };
    const files = run.files.map((file) => ({ name: file.name, lines: G.text(file.text).split("\n"), first: new Map() }));
    for (let i = blocks.t.length - 1; i >= 0; i--) {
      const file = files[run.modals[blocks.modal[i]].file];
      if (file) file.first.set(blocks.line[i], blocks.t[i]);
    }
    const findings = run.findings.map((f) => ({ ...f, t: f.t === null ? null : f.t * scale }));
    return { ...run, end: run.end * scale, blocks, files, findings, seconds, scale };
  });
  G.comparison = index.compared || null;
  G.end = Math.max(...G.runs.map((run) => run.end), 1e-6);
};

// The block of a run at a time, and what is in force in it; {} before the first.
G.blockAt = (run, t) => {
  const i = G.index(run.blocks.t, t + 1e-9);
  return i < 0 ? {} : { i, line: run.blocks.line[i], modal: run.modals[run.blocks.modal[i]] };
};

// ---- time: one moment for the whole page
G.onTime = (listener) => G.listeners.push(listener);
G.seek = (t, quiet = false) => {
  G.time = Math.min(Math.max(t, 0), G.end);
  for (const listener of G.listeners) listener(G.time, quiet);
};

// ---- small helpers
G.make = (tag, name = "", text = "") => {
  const element = document.createElement(tag);
  if (name) element.className = name;
  if (text !== "") element.textContent = text;
  return element;
};
G.number = (value, digits = 1) => {
  if (value === null || value === undefined || !isFinite(value)) return "–";
  return value.toLocaleString("en-US", { minimumFractionDigits: digits, maximumFractionDigits: digits }).replaceAll(",", "\u202f");
};
G.short = (value) => {
  const size = Math.abs(value);
  return G.number(value, size >= 1000 ? 0 : size >= 100 ? 1 : size >= 1 ? 2 : 3);
};
G.clock = (t, digits = 1) => {
  const whole = Math.floor(t / 60), rest = (t - 60 * whole).toFixed(digits).padStart(digits ? 3 + digits : 2, "0");
  return whole >= 60 ? `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}:${rest}` : `${whole}:${rest}`;
};
