"use strict";
// The time bar: play, speed, and the whole run at a glance, with tools, work and findings.
G.bar = (place) => {
  const play = place.appendChild(G.make("button", "play", "▶")), clock = place.appendChild(G.make("div", "clock"));
  const now = clock.appendChild(G.make("b")), rest = clock.appendChild(G.make("span"));
  const speed = place.appendChild(G.make("select")), canvas = place.appendChild(G.make("canvas"));
  play.title = "play, pause: space; a second: ← →; ten: with shift; line by line: , .";
  speed.title = "speed";
  const natural = G.end / 40, speeds = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500];
  for (const factor of speeds) speed.appendChild(new Option(`× ${factor}`, factor));
  speed.value = String(speeds.reduce((best, factor) => Math.abs(Math.log(factor / natural)) < Math.abs(Math.log(best / natural)) ? factor : best));
  let running = false, before = 0;
  const start = (on) => {
    running = on;
    play.textContent = on ? "❚❚" : "▶";
    if (on && G.time >= G.end - 1e-9) G.seek(0);
    before = performance.now();
  };
  play.onclick = () => start(!running);
  G.tick = (at) => {
    if (!running) return;
    const t = G.time + ((at - before) / 1000) * +speed.value;
    before = at;
    G.seek(t);
    if (t >= G.end) start(false);
  };

  // ---- the strip is drawn once for its size; the moment is drawn over it
  let strip = null;
  const paint = () => {
    const ratio = Math.min(window.devicePixelRatio || 1, 2), width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    strip = document.createElement("canvas");
    strip.width = canvas.width;
    strip.height = canvas.height;
    const pen = strip.getContext("2d");
    pen.scale(ratio, ratio);
    const each = height / G.runs.length;
    G.runs.forEach((run, r) => G.strip(pen, run, width, r * each, each));
    show(G.time);
  };
  const show = (t) => {
    const pen = canvas.getContext("2d"), ratio = canvas.width / Math.max(canvas.clientWidth, 1);
    if (!strip) return;
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(strip, 0, 0);
    const x = (t / G.end) * canvas.width;
    pen.fillStyle = "#1768ac14";
    pen.fillRect(0, 0, x, canvas.height);
    pen.fillStyle = "#e8b400";
    pen.fillRect(x - ratio, 0, 2 * ratio, canvas.height);
    now.textContent = G.clock(t);
    const name = G.lineName(G.runs[0], t);
    rest.textContent = ` / ${G.clock(G.end)}${name ? `  line ${name}` : ""}`;
  };
  let held = false;
  const at = (event) => G.seek((event.offsetX / canvas.clientWidth) * G.end);
  canvas.addEventListener("pointerdown", (event) => { held = true; canvas.setPointerCapture(event.pointerId); at(event); });
  canvas.addEventListener("pointermove", (event) => { if (held) at(event); });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = false; });
  new ResizeObserver(paint).observe(canvas);
  G.onTime(show);
  const step = (way) => {
    const { t } = G.runs[0].blocks, i = G.index(t, G.time + 1e-9);
    G.seek(way > 0 ? t[Math.min(i + 1, t.length - 1)] : G.time > t[i] + 1e-3 ? t[i] : t[Math.max(i - 1, 0)]);
  };
  window.addEventListener("keydown", (event) => {
    if (/^(SELECT|INPUT)$/.test(event.target.tagName)) return;
    const seconds = event.shiftKey ? 10 : 1;
    const keys = { " ": () => start(!running), ArrowLeft: () => G.seek(G.time - seconds), ArrowRight: () => G.seek(G.time + seconds), Home: () => G.seek(0), End: () => G.seek(G.end), ",": () => step(-1), ".": () => step(1) };
    if (keys[event.key]) { event.preventDefault(); keys[event.key](); }
  });
};

G.TOOL_INKS = ["#dbe8f3", "#f7ead0", "#dcefe0", "#eadff3", "#fbe0dc", "#dff0f2"];
G.strip = (pen, run, width, top, height) => {
  const x = (t) => (t / G.end) * width, { blocks, modals } = run, edge = top + height;
  pen.fillStyle = "#f4f6f8";
  pen.fillRect(0, top + 1, width, height - 2);
  // which tool when
  const known = new Map();
  for (let i = 0; i < blocks.t.length;) {
    const tool = modals[blocks.modal[i]].tool;
    let j = i;
    while (j < blocks.t.length && modals[blocks.modal[j]].tool === tool) j++;
    const from = x(blocks.t[i]), to = x(j < blocks.t.length ? blocks.t[j] : run.end);
    if (!known.has(tool)) known.set(tool, G.TOOL_INKS[known.size % G.TOOL_INKS.length]);
    pen.fillStyle = known.get(tool);
    pen.fillRect(from, top + 1, to - from, height - 2);
    if (to - from > 26) {
      pen.fillStyle = "#5b6b7a";
      pen.font = "11px system-ui, 'DejaVu Sans', sans-serif";
      pen.fillText(tool ? `T${tool}` : "", from + 4, top + 13);
    }
    i = j;
  }
  // how hard it works: force, else feed
  const chart = run.charts.find((c) => c.what === "force") || run.charts.find((c) => c.what === "feed");
  if (chart) {
    const t = run.seconds(chart.t), values = G.columns(chart.values).at(-1), most = Math.max(1e-9, ...G.peaks(values));
    const room = height - 16, tops = new Float32Array(Math.ceil(width));
    for (let i = 0; i < t.length; i++) {
      const to = Math.min(Math.floor(x(t[i])), tops.length - 1), from = i ? Math.min(Math.floor(x(t[i - 1])) + 1, to) : to;
      for (let at = from; at <= to; at++) tops[at] = Math.max(tops[at], values[i] / most);
    }
    pen.fillStyle = "#1768ac88";
    tops.forEach((share, i) => pen.fillRect(i, edge - 1 - share * room, 1, share * room));
  }
  for (const finding of run.findings) {
    if (finding.t === null || finding.severity === "note") continue;
    pen.fillStyle = finding.severity === "error" ? "#c8374a" : "#e09f1f";
    const at = x(finding.t);
    pen.fillRect(at - 1, top + 1, 2, height - 2);
    pen.beginPath();
    pen.moveTo(at - 5, top + 1);
    pen.lineTo(at + 5, top + 1);
    pen.lineTo(at, top + 9);
    pen.fill();
  }
};
// Greatest values of stretches of a long list: few enough for Math.max.
G.peaks = (values) => {
  const found = [];
  for (let i = 0; i < values.length; i += 1000) {
    let most = -Infinity;
    for (let j = i; j < Math.min(i + 1000, values.length); j++) most = Math.max(most, values[j]);
    found.push(most);
  }
  return found;
};
