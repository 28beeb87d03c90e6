"use strict";
// Charts over time, with the program lines along the top; the bar's moment is a line in each of them.
G.INKS = ["#1768ac", "#d1495b", "#2e933c", "#e09f1f", "#7b4fb5", "#00798c", "#8d5524", "#667585"];

G.charts = (place) => {
  const sync = uPlot.sync("time"), made = [];
  // charts of the same quantity of two runs are drawn into one
  const groups = new Map();
  G.runs.forEach((run, r) => run.charts.forEach((chart) => {
    const key = `${chart.title} ${chart.unit}`;
    if (!groups.has(key)) groups.set(key, []);
    groups.get(key).push({ run, r, chart });
  }));
  let first = true;
  for (const parts of groups.values()) {
    const box = place.appendChild(G.make("div", "panel chart"));
    const heading = box.appendChild(G.make("h2", "", parts[0].chart.title));
    heading.appendChild(G.make("small", "", parts[0].chart.unit));
    made.push(G.chart(box, parts, sync, first));
    first = false;
  }
  const redraw = (t) => {
    for (const { plot, mark } of made) {
      const x = plot.valToPos(t, "x");
      mark.style.display = x >= 0 && x <= plot.over.clientWidth ? "" : "none";
      mark.style.left = `${x}px`;
    }
  };
  G.onTime(redraw);
  new ResizeObserver(() => {
    for (const { plot, box } of made) plot.setSize({ width: box.clientWidth - 8, height: plot.height });
    redraw(G.time);
  }).observe(place);
  G.chartsRedraw = () => redraw(G.time);
  return made;
};

// The line of the first run that is in force at a time, for the axis.
G.lineName = (run, t) => {
  const { line, modal } = G.blockAt(run, t);
  if (!line) return "";
  return modal.file > 0 ? `${run.files[modal.file].name}:${line}` : `${line}`;
};

// The greatest feed outside of rapids, where rapids are much faster: they do not set the scale; else null.
G.workingFeed = (tables) => {
  let most = 0, whole = 0;
  for (const [run, [t, ...columns]] of tables) {
    for (let i = 0; i < t.length; i++) {
      const { modal } = G.blockAt(run, t[i] - 1e-6), rapid = !modal || /^(G0|G28|G30)?$/.test(modal.motion) || /^G(73|8[1-9])$/.test(modal.motion);
      for (const column of columns) {
        whole = Math.max(whole, column[i]);
        if (!rapid) most = Math.max(most, column[i]);
      }
    }
  }
  return most > 0 && whole > 1.5 * most ? 1.1 * most : null;
};

G.chart = (box, parts, sync, withLines) => {
  const tables = [], series = [{ label: "time", value: (_, t) => t === null ? "–" : `${t.toFixed(3)} s` }];
  let ink = 0;
  for (const { run, r, chart } of parts) {
    const columns = G.columns(chart.values), t = run.seconds(chart.t);
    tables.push([t, ...columns.map((column) => Array.from(column))]);
    let own = 0;
    for (const curve of chart.curves) {
      // a second run has a colour of its own where each has one curve, else the colours of the first, dashed
      const single = chart.curves.filter((c) => !c.faint).length === 1;
      const colour = curve.faint ? (r ? "#ecd3bd" : "#b4c0cb") : r && single ? "#d9731a" : G.INKS[(r ? own : ink) % G.INKS.length];
      if (!curve.faint) { own++; if (!r) ink++; }
      const alone = chart.curves.length === 1 && !r;
      series.push({
        label: G.runs.length > 1 ? `${run.name} ${curve.label}` : curve.label, stroke: colour, width: 1.1, dash: r && !single ? [5, 3] : undefined,
        fill: alone ? `${colour}1c` : undefined, points: { show: false }, value: (_, v) => v === null || v === undefined ? "–" : G.short(v), spanGaps: true,
      });
    }
  }
  const cap = parts[0].chart.what === "feed" ? G.workingFeed(parts.map(({ run }, r) => [run, tables[r]])) : null;
  if (cap !== null) box.querySelector("small").textContent += ` · rapids go off the top`;
  const data = tables.length > 1 ? uPlot.join(tables) : tables[0];
  const run = parts[0].run, grid = { stroke: "#e9edf1", width: 1 }, font = "11px system-ui, 'DejaVu Sans', sans-serif";
  const axes = [
    { stroke: "#667585", font, grid, ticks: grid, size: 26, values: (_, splits) => splits.map((t) => `${+t.toFixed(6)} s`) },
    { stroke: "#667585", font, grid, ticks: grid, size: 52, values: (_, splits) => splits.map((v) => Math.abs(v) >= 1e4 ? `${+(v / 1e3).toFixed(6)}k` : `${+v.toFixed(6)}`) },
  ];
  if (withLines) {
    axes.push({ scale: "x", side: 0, stroke: "#667585", font, grid: { show: false }, ticks: { stroke: "#cfd8e0", width: 1, size: 4 }, size: 34,
      label: "program line", labelFont: font, labelSize: 14, space: 60, values: (_, splits) => splits.map((t) => G.lineName(run, t)) });
  }
  const options = {
    width: Math.max(box.clientWidth - 8, 300), height: withLines ? 196 : 158, series, axes,
    scales: { x: { time: false, range: (_, low, high) => low === null ? [0, G.end] : [Math.max(low, 0), Math.min(high, G.end)] },
      y: { range: (_, low, high) => { if (cap !== null) high = Math.min(high, cap); const room = 0.06 * (high - low) || Math.abs(high) * 0.1 || 1; return [low >= 0 ? 0 : low - room, high + room]; } } },
    cursor: { sync: { key: sync.key, setSeries: false }, drag: { x: true, y: false }, points: { size: 6 } },
    legend: { live: true }, padding: [withLines ? 2 : 8, 14, 0, 0],
  };
  const plot = new uPlot(options, data, box), mark = plot.over.appendChild(G.make("div", "now-line"));
  let down = null;
  plot.over.addEventListener("mousedown", (event) => { down = event.clientX; });
  plot.over.addEventListener("mouseup", (event) => {
    if (down !== null && Math.abs(event.clientX - down) < 4) G.seek(plot.posToVal(event.offsetX, "x"));
    down = null;
  });
  // all charts show the same stretch of time
  plot.hooks.setScale = [(self, key) => {
    if (key !== "x" || G.scaling) return;
    G.scaling = true;
    const { min, max } = self.scales.x;
    for (const other of G.plots || []) if (other.plot !== self && other.plot.scales.x.min !== undefined) other.plot.setScale("x", { min, max });
    G.scaling = false;
    if (G.chartsRedraw) G.chartsRedraw();
  }];
  return { plot, mark, box };
};
