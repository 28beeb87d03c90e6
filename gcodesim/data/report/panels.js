"use strict";
// The head of the page, the program, findings and tables.
G.head = (place) => {
  const one = G.runs[0], add = (text, value) => {
    const figure = place.appendChild(G.make("span", "figure"));
    figure.append(G.make("b", "", value), " ", G.make("span", "", text));
  };
  place.appendChild(G.make("h1", "", [...new Set(G.runs.map((run) => run.program))].join(" / ")));
  if (G.setups) {
    const tabs = place.appendChild(G.make("span", "setups"));
    for (const name of G.setupNames) {
      const tab = tabs.appendChild(G.make("button", name === one.name ? "on" : "", name));
      tab.onclick = () => G.showSetup(name);
    }
  }
  for (const run of G.runs) {
    if (G.runs.length > 1) place.appendChild(G.make("b", "", run.name));
    const label = { ok: "clean", findings: "findings", failed: run.complete ? "failed" : "incomplete" }[run.status] || run.status;
    place.appendChild(G.make("span", `status ${run.status}`, label));
    if (run.damaged) place.appendChild(G.make("span", "status failed", "log damaged"));
    if (run.stopped_at) place.appendChild(G.make("span", "where", `stopped at ${run.stopped_at.file}:${run.stopped_at.line}`));
  }
  place.appendChild(G.make("span", "where", [...new Set(G.runs.map((run) => `${run.cell} · ${run.world} world`))].join(" / ")));
  if (G.runs.length === 1) {
    const { results } = one, stocks = Object.values(results.stocks || {}), tools = results.tools || [];
    add("time", G.clock(one.end));
    if (results.distance) add("mm at feed", G.number(results.distance.feed_mm, 0));
    const removed = stocks.reduce((sum, s) => sum + s.removed_mm3, 0), added = stocks.reduce((sum, s) => sum + s.deposited_mm3, 0);
    if (removed) add("mm³ removed", G.number(removed, 0));
    if (added) add("mm³ deposited", G.number(added, 0));
    const force = Math.max(0, ...tools.map((tool) => tool.max_force_N)), power = Math.max(0, ...tools.map((tool) => tool.max_power_W));
    if (force) add("N at most", G.number(force, 0));
    if (power) add("W at most", G.number(power, 0));
  }
  place.appendChild(G.make("span", "brand", `gcodesim ${one.version}`));
};

// ---- program text: only the lines in sight are in the page, so a long program scrolls like a short one
G.ROW = 19;
G.program = (place) => {
  const panel = place.appendChild(G.make("div", "panel program")), tabs = panel.appendChild(G.make("div", "tabs"));
  const modals = panel.appendChild(G.make("div", "modals"));
  const box = panel.appendChild(G.make("div", "lines")), inside = box.appendChild(G.make("div"));
  const views = [];
  let shown = null, drawn = new Map(), now = 0, touched = -Infinity;
  G.runs.forEach((run, r) => run.files.forEach((file, f) => {
    const worst = new Map();
    for (const finding of run.findings) {
      if (finding.file === file.name && finding.severity !== "note" && worst.get(finding.line) !== "error") worst.set(finding.line, finding.severity);
    }
    const tab = tabs.appendChild(G.make("button", "", G.runs.length > 1 ? `${run.name}: ${file.name}` : file.name));
    const view = { run, r, f, file, tab, worst };
    tab.onclick = () => { touched = performance.now(); choose(view); };
    views.push(view);
  }));
  const choose = (view) => {
    if (shown === view || !view) return;
    if (shown) shown.tab.classList.remove("on");
    shown = view;
    view.tab.classList.add("on");
    inside.replaceChildren();
    drawn = new Map();
    inside.style.height = `${view.file.lines.length * G.ROW}px`;
    inside.style.position = "relative";
    draw();
  };
  const draw = () => {
    if (!shown) return;
    const from = Math.max(Math.floor(box.scrollTop / G.ROW) - 10, 0), to = Math.min(Math.ceil((box.scrollTop + box.clientHeight) / G.ROW) + 10, shown.file.lines.length);
    for (const [i, row] of drawn) if (i < from || i >= to) { row.remove(); drawn.delete(i); }
    for (let i = from; i < to; i++) {
      if (!drawn.has(i)) drawn.set(i, inside.appendChild(G.programRow(shown, i)));
      drawn.get(i).classList.toggle("now", i + 1 === now);
    }
  };
  box.addEventListener("scroll", draw);
  for (const name of ["wheel", "pointerdown"]) box.addEventListener(name, () => { touched = performance.now(); });
  new ResizeObserver(draw).observe(box);
  if (views.length) choose(views[0]);
  G.onTime((t) => {
    const run = shown ? shown.run : G.runs[0], { line, modal, i } = G.blockAt(run, t);
    if (performance.now() - touched > 2500 && modal && modal.file >= 0) choose(views.find((v) => v.run === run && v.f === modal.file));
    now = shown && modal && modal.file === shown.f ? line : 0;
    modals.replaceChildren(...G.modalsAt(run, line, modal, i).map(([text, title]) => Object.assign(G.make("span", "", text), { title })));
    const top = (now - 1) * G.ROW;
    if (now && performance.now() - touched > 2500 && (top < box.scrollTop + 2 * G.ROW || top > box.scrollTop + box.clientHeight - 4 * G.ROW)) {
      box.scrollTop = top - 0.4 * box.clientHeight;
    }
    draw();
  });
};

// What holds at a line: words of the program with what they mean.
G.MEANINGS = {
  G0: "rapid", G1: "straight feed", G2: "clockwise arc", G3: "counterclockwise arc", G17: "plane XY", G18: "plane ZX", G19: "plane YZ",
  G20: "inches", G21: "millimetres", G90: "absolute positions", G91: "positions from where it stands",
};
// The feed in force at a block [mm/min]. The log has 0 for a block that begins with a rapid: then it is the word F of its
// line, or what came before.
G.feedAt = (run, i) => {
  for (let at = i; at >= Math.max(i - 500, 0); at--) {
    const modal = run.modals[run.blocks.modal[at]], file = run.files[modal.file], line = run.blocks.line[at];
    if (modal.feed > 0) return modal.feed;
    const said = file && (file.lines[line - 1] || "").replace(/\([^)]*\)?|;.*/g, "").match(/F\s*(\d+\.?\d*)/i);
    if (said && !G.modesAt(run, line, modal).includes("G20")) return +said[1];
  }
  return 0;
};
G.modesAt = (run, line, modal) => {
  const changes = run.modes[modal.file] || [], i = G.index(changes.map(([first]) => first), line);
  return i < 0 ? [] : changes[i][1];
};
G.modalsAt = (run, line, modal, i) => {
  if (!modal) return [];
  const words = [modal.motion, modal.wcs, ...G.modesAt(run, line, modal)].filter(Boolean);
  const found = words.map((word) => [word, G.MEANINGS[word] || (word === modal.wcs ? "work coordinates" : "motion")]);
  found.push([`F ${G.number(G.feedAt(run, i), 0)}`, "programmed feed, mm/min"], [`S ${G.number(modal.spindle, 0)}`, "programmed speed, rpm"]);
  found.push([`T${modal.tool}`, modal.tool ? modal.tool_name : "no tool"]);
  return found;
};

G.programRow = ({ run, file, worst }, i) => {
  const row = G.make("div", "row"), line = i + 1;
  row.style.top = `${i * G.ROW}px`;
  row.appendChild(G.make("s", "", `${line}`));
  // comments, then words that switch something, then the rest
  for (const [part] of file.lines[i].matchAll(/\([^)]*\)?|;.*|[GM]\s*[0-9.]+|T\s*[0-9]+|[^(;GMT]+|./gi)) {
    const kind = /^[(;]/.test(part) ? "c" : /^[GM]\s*[0-9]/i.test(part) ? "w" : /^T\s*[0-9]/i.test(part) ? "t" : "";
    row.append(kind ? G.make("span", kind, part) : part);
  }
  if (worst.has(line)) row.classList.add(worst.get(line));
  if (file.first.has(line)) row.onclick = () => G.seek(file.first.get(line) + 1e-6);
  else row.classList.add("never");
  return row;
};

// ---- findings
G.findings = (place) => {
  const panel = place.appendChild(G.make("div", "panel")), heading = panel.appendChild(G.make("h2", "", "Findings"));
  const all = G.runs.flatMap((run, r) => run.findings.map((finding) => ({ ...finding, run, r })));
  const key = (f) => `${f.code} ${f.message} ${f.file}`;
  const both = G.runs.length > 1 ? G.runs.map((run) => new Set(run.findings.map(key))) : [];
  heading.appendChild(G.make("small", "", ["error", "warning", "note"].map((s) => {
    const count = all.filter((f) => f.severity === s).length;
    return `${count || "no"} ${s}${count === 1 ? "" : "s"}`;
  }).join(", ")));
  if (!all.length) panel.appendChild(G.make("div", "empty", "Nothing was found wrong."));
  const list = panel.appendChild(G.make("div", "scroll"));
  const order = { error: 0, warning: 1, note: 2 };
  all.sort((a, b) => order[a.severity] - order[b.severity] || (a.t ?? 1e12) - (b.t ?? 1e12));
  for (const finding of all) {
    const row = list.appendChild(G.make("div", `finding ${finding.severity}${finding.t === null ? "" : " go"}`));
    row.append(G.make("i"), G.make("b", "", finding.code));
    const text = row.appendChild(G.make("div", "", finding.message + (finding.count > 1 ? ` (${finding.count} times)` : "")));
    if (finding.hint) text.appendChild(G.make("div", "hint", finding.hint));
    const place = [finding.line ? `${finding.file}:${finding.line}` : finding.file, finding.t === null ? "" : G.clock(finding.t)].filter(Boolean).join("  ");
    const side = row.appendChild(G.make("div", "place", place));
    if (both.length) {
      const known = both[1 - finding.r].has(key(finding));
      side.prepend(`${finding.run.name}${known ? "" : finding.r ? " new" : " gone"}  `);
    }
    if (finding.t !== null) row.onclick = () => G.seek(finding.t);
  }
};

// All set-ups of a job in numbers; a click shows one.
G.setupTable = (place) => {
  const sum = G.setups.reduce((total, one) => total + one.time_s, 0), gap = (one) => one.deviation_mm ? one.deviation_mm.map((d) => `${d < 0 ? "−" : "+"}${G.number(Math.abs(d), 3)}`).join(" … ") : "–";
  G.table(place, "Set-ups", "each begins with the stock that it is left", [["set-up", "l"], ["", "l"], ["time"], ["removed mm³"], ["remaining mm³"], ["deviation mm"], ["errors"], ["warnings"]],
    G.setups.map((one) => ({
      cells: [one.name, { ok: "clean" }[one.status] || one.status, G.clock(one.time_s), G.number(one.removed_mm3, 0), G.number(one.remaining_mm3, 0), gap(one), `${one.errors}`, `${one.warnings}`],
      go: G.setupNames.includes(one.name) ? () => G.showSetup(one.name) : null,
    })), ["total", "", G.clock(sum), "", "", "", "", ""]);
};

// ---- tables
G.table = (place, title, remark, head, rows, sum) => {
  const panel = place.appendChild(G.make("div", "panel")), heading = panel.appendChild(G.make("h2", "", title));
  if (remark) heading.appendChild(G.make("small", "", remark));
  const table = panel.appendChild(G.make("div", "scroll")).appendChild(G.make("table"));
  const top = table.createTHead().insertRow();
  for (const [text, kind] of head) top.appendChild(G.make("th", kind || "", text));
  const body = table.createTBody();
  for (const { cells, t, go, total } of sum ? [...rows, { cells: sum, total: true }] : rows) {
    const row = body.insertRow();
    cells.forEach((cell, i) => {
      const place = row.insertCell();
      place.className = (head[i] && head[i][1]) || "";
      if (cell instanceof Node) place.appendChild(cell);
      else if (Array.isArray(cell)) { place.textContent = cell[0]; place.classList.add(cell[1]); }
      else place.textContent = cell;
      if (place.className.includes("code")) place.title = place.textContent;
    });
    if (total) row.classList.add("sum");
    if (go) { row.classList.add("go"); row.onclick = go; }
    else if (t !== undefined && t !== null) { row.classList.add("go"); row.onclick = () => G.seek(t); }
  }
};

// A name of results.json in words, its unit as one writes it.
G.heading = (key) => key.replace(/_mm_min$/, "_mm/min").replace(/_Nm$/, "_N·m").replace(/_mm2$/, "_mm²").replace(/_mm3$/, "_mm³").replaceAll("_", " ");

// Removed volume as it is, material that was laid with a plus.
G.volume = (value) => value < -0.5 ? `+${G.number(-value, 0)}` : G.number(Math.max(value, 0), 0);

G.share = (part, whole) => {
  const bar = G.make("span", "share");
  bar.style.width = `${Math.max(0, Math.min(1, whole > 0 ? part / whole : 0)) * 90}px`;
  return bar;
};

G.firstOf = (run, file, line) => {
  const found = run.files.find((f) => f.name === file);
  return found ? found.first.get(line) ?? null : null;
};

// What a comparison found to differ: each entry leads to its line, in the new run where it is there.
G.differences = (place, { summary, differences }) => {
  const panel = place.appendChild(G.make("div", "panel differences")), heading = panel.appendChild(G.make("h2", "", "What differs"));
  heading.appendChild(G.make("small", "", summary));
  const list = panel.appendChild(G.make("div", "scroll"));
  let kind = "";
  for (const one of differences) {
    if (one.kind !== kind) list.appendChild(G.make("div", "kind", kind = one.kind));
    const row = list.appendChild(G.make("div", "difference"));
    for (const line of one.lines) row.appendChild(G.make("div", line.startsWith("− ") ? "less" : line.startsWith("+ ") ? "more" : "", line));
    const [old, now] = [one.old, one.new].map((at, r) => at && G.firstOf(G.runs[r], ...at)), t = now ?? old;
    if (t !== null && t !== undefined) { row.classList.add("go"); row.onclick = () => G.seek(t); }
  }
};

G.tables = (place) => {
  if (G.setups) G.setupTable(place);
  if (G.comparison) G.differences(place, G.comparison);
  for (const run of G.runs) {
    G.targetTable(place, run);
    G.scallopTable(place, run);
  }
  G.findings(place);
  if (G.runs.length > 1) G.compared(place);
  for (const run of G.runs) {
    const { times, results } = run, name = G.runs.length > 1 ? `${run.name}: ` : "", total = times.total_s;
    const toolRow = (number) => (results.tools || []).find((tool) => tool.number === number) || {};
    const usual = ["number", "name", "time_s", "feed_mm", "removed_mm3", "max_force_N", "max_torque_Nm", "max_power_W", "line_of_max_force"];
    const own = [...new Set((results.tools || []).flatMap(Object.keys))].filter((key) => !usual.includes(key));
    if (times.tools.length) {
      G.table(place, `${name}Time by tool`, "all moves, dwells and its change", [["tool", "l"], ["time"], [""], ["in material"], ["volume mm³"], ["force N"], ["power W"], ...own.map((key) => [G.heading(key)])],
        times.tools.map((tool) => ({
          cells: [tool.number ? `T${tool.number}${tool.name !== `T${tool.number}` ? ` ${tool.name}` : ""}` : "no tool", G.clock(tool.time_s), G.share(tool.time_s, total), G.clock(tool.engaged_s),
            G.volume(tool.removed_mm3), G.number(toolRow(tool.number).max_force_N ?? tool.max_force_N, 1), G.number(toolRow(tool.number).max_power_W ?? tool.max_power_W, 0),
            ...own.map((key) => G.short(toolRow(tool.number)[key] ?? 0))],
          t: (() => { const i = run.blocks.modal.findIndex((m) => run.modals[m].tool === tool.number); return i < 0 ? null : run.blocks.t[i]; })(),
        })), ["total", G.clock(times.tools.reduce((sum, tool) => sum + tool.time_s, 0)), "", "", "", "", "", ...own.map(() => "")]);
    }
    if ((results.operations || []).length) {
      G.table(place, `${name}Time by operation`, "from one tool change, or one comment that stands alone, to the next",
        [["operation", "l"], ["tool"], ["lines"], ["time"], [""], ["mm³"], ["at feed mm"], ["rapid mm"], ["mean mm/min"], ["least mm/min"], ["share at the feed"], ["in the air"]],
        results.operations.map((one) => ({
          cells: [one.name, `T${one.tool}`, `${one.first_line}–${one.last_line}`, G.clock(one.time_s), G.share(one.time_s, total), one.removed_mm3 == null ? "" : G.volume(one.removed_mm3), G.number(one.feed_mm, 0), G.number(one.rapid_mm, 0),
            G.number(one.mean_feed_mm_min, 0), G.number(one.least_feed_mm_min, 0), G.share(one.share_at_feed, 1), one.air_share == null ? "" : G.share(one.air_share, 1)],
          t: G.firstOf(run, run.program, one.first_line),
        })));
    }
    if (results.time) {
      const parts = [["feed", "feed_s"], ["rapid", "rapid_s"], ["dwell", "dwell_s"], ["tool change", "tool_change_s"], ["spindle", "spindle_s"], ["devices", "devices_s"]];
      G.table(place, `${name}Time by kind`, "", [["kind", "l"], ["time"], [""]],
        parts.filter(([, key]) => results.time[key]).map(([text, key]) => ({ cells: [text, G.clock(results.time[key]), G.share(results.time[key], results.time.total_s)] })),
        ["total", G.clock(results.time.total_s), ""]);
    }
    if (times.layers.length > 1) {
      G.table(place, `${name}Time by layer`, `${times.layers.length} layers; with the moves between them`, [["Z mm"], ["time"], [""], ["at work"], ["mm³"]],
        times.layers.map((layer) => ({ cells: [G.number(layer.z_mm, 3), G.clock(layer.time_s), G.share(layer.time_s, Math.max(...times.layers.map((l) => l.time_s))), G.clock(layer.engaged_s), G.volume(layer.removed_mm3)] })),
        ["total", G.clock(times.layers.reduce((sum, layer) => sum + layer.time_s, 0)), "", "", ""]);
    }
    if (times.lines.length) {
      G.table(place, `${name}Slowest lines`, `${times.lines.length} of ${times.line_count}`, [["line"], ["program", "l code"], ["time"], ["runs"], ["mm³"], ["force N"]],
        times.lines.map((line) => ({
          cells: [run.files.length > 1 && line.file !== run.program ? `${line.file}:${line.line}` : `${line.line}`, line.text, `${G.number(line.time_s, 2)} s`, `${line.count}`, G.volume(line.removed_mm3), G.number(line.max_force_N, 1)],
          t: G.firstOf(run, line.file, line.line),
        })));
    }
    if ((results.joints || []).length) {
      G.table(place, `${name}Joints`, "margin: to the nearer limit", [["joint", "l"], ["least"], ["most"], ["margin"], ["at line"], ["speed /s"], ["effort"], [""]],
        results.joints.map((joint) => ({
          cells: [joint.name, G.number(joint.least, 1), G.number(joint.most, 1), joint.margin !== null && joint.margin < 0 ? [G.number(joint.margin, 1), "more"] : G.number(joint.margin, 1), joint.line_of_margin ?? "–", G.number(joint.max_speed, 1), G.short(joint.max_effort), joint.unit === "deg" ? "°, N·m" : "mm, N"],
          t: joint.line_of_margin ? G.firstOf(run, run.program, joint.line_of_margin) : null,
        })));
    }
    if (results.not_simulated) {
      const words = results.not_simulated;
      G.table(place, `${name}Not simulated`, words.length ? "" : "every word was", [["word", "l"], ["times"], ["first line"]],
        words.map((word) => ({ cells: [word.word, `${word.count}`, `${word.first_line}`], t: G.firstOf(run, run.program, word.first_line) })));
    }
  }
};

// Two runs in numbers: old, new, difference.
G.compared = (place) => {
  const [a, b] = G.runs, rows = [], add = (text, unit, x, y, digits) => {
    if (x === undefined && y === undefined) return;
    const gap = (y ?? 0) - (x ?? 0), small = Math.abs(gap) < 0.5 * 10 ** -digits;
    rows.push({ cells: [text, G.number(x, digits), G.number(y, digits), small ? "=" : [`${gap > 0 ? "+" : "−"}${G.number(Math.abs(gap), digits)}`, gap > 0 ? "more" : "less"], unit] });
  };
  for (const [text, key] of [["time", "total_s"], ["feed", "feed_s"], ["rapid", "rapid_s"], ["in material", "engaged_s"]]) add(text, "s", a.results.time?.[key], b.results.time?.[key], 2);
  add("way at feed", "mm", a.results.distance?.feed_mm, b.results.distance?.feed_mm, 2);
  add("way at rapid", "mm", a.results.distance?.rapid_mm, b.results.distance?.rapid_mm, 2);
  for (const name of new Set([...Object.keys(a.results.stocks || {}), ...Object.keys(b.results.stocks || {})])) {
    for (const key of ["removed", "deposited", "remaining"]) add(`${name} ${key}`, "mm³", a.results.stocks?.[name]?.[`${key}_mm3`], b.results.stocks?.[name]?.[`${key}_mm3`], 1);
  }
  const tools = new Map();
  for (const run of G.runs) for (const tool of run.results.tools || []) tools.set(tool.number, [...(tools.get(tool.number) || []), [run, tool]]);
  for (const [number, found] of tools) {
    const of = (run, key) => found.find(([r]) => r === run)?.[1][key];
    add(`T${number} time`, "s", of(a, "time_s"), of(b, "time_s"), 2);
    add(`T${number} greatest force`, "N", of(a, "max_force_N"), of(b, "max_force_N"), 1);
    add(`T${number} greatest power`, "W", of(a, "max_power_W"), of(b, "max_power_W"), 0);
  }
  G.table(place, "Compared", "", [["", "l"], [a.name], [b.name], ["difference"], ["", "l"]], rows);
};
