"use strict";
// The rows of a sweep: filtered, sorted, drawn. All texts are put in as text, never as markup.
const P = { sort: 0, down: false, page: 0, chosen: null, filters: new Map() };
const A_PAGE = 200;

const element = (name, content = "", attributes = {}) => {
  const made = document.createElement(name);
  if (content !== "") made.textContent = content;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
};
const drawn = (name, attributes, text = "") => {
  const made = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== "") made.textContent = text;
  return made;
};
const shown = (value) => value === null ? "" : typeof value === "number" ? String(+value.toPrecision(6)) : value;
const numeric = (column) => column.kind !== "text";
const at = (name) => P.data.columns.findIndex((column) => column.name === name);

const rows = () => P.data.rows.filter((row) => [...P.filters].every(([place, test]) => test(row[place])));

// Least and greatest of numbers, never equal, so that something can be drawn between them.
const ends = (values) => {
  let low = Infinity, high = -Infinity;
  for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
  if (low === high) { const room = Math.abs(low) * 0.05 || 0.5; return [low - room, high + room]; }
  return [low, high];
};

// Texts count as their place among all texts of the column.
const scale = (place, list) => {
  const column = P.data.columns[place];
  if (numeric(column)) return { of: (value) => value, ticks: null, range: ends(list.map((row) => row[place]).filter((v) => v !== null)) };
  const texts = [...new Set(P.data.rows.map((row) => row[place]))];
  return { of: (value) => texts.indexOf(value), ticks: texts, range: ends(texts.map((_, i) => i)) };
};

const plot = (x, y, list, width, height, mean) => {
  const left = 58, right = 10, top = 8, bottom = 34;
  const svg = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${P.data.columns[y].name} over ${P.data.columns[x].name}` });
  const points = list.filter((row) => row[x] !== null && row[y] !== null);
  const across = scale(x, points), up = scale(y, points);
  const px = (value) => left + (across.of(value) - across.range[0]) / (across.range[1] - across.range[0]) * (width - left - right);
  const py = (value) => height - bottom - (up.of(value) - up.range[0]) / (up.range[1] - up.range[0]) * (height - top - bottom);
  for (let i = 0; i <= 4; i++) {
    const level = top + (height - top - bottom) * i / 4, value = up.range[1] - (up.range[1] - up.range[0]) * i / 4;
    svg.append(drawn("line", { x1: left, x2: width - right, y1: level, y2: level }));
    if (!up.ticks && points.length) svg.append(drawn("text", { x: left - 5, y: level + 4, "text-anchor": "end" }, String(+value.toPrecision(4))));
  }
  if (points.length) {
    const marks = across.ticks ? across.ticks.slice(0, 8).map((text, i) => [i, text]) : [0, 0.5, 1].map((s) => across.range[0] + s * (across.range[1] - across.range[0])).map((v) => [v, String(+v.toPrecision(4))]);
    for (const [value, text] of marks) {
      const place = left + (value - across.range[0]) / (across.range[1] - across.range[0]) * (width - left - right);
      svg.append(drawn("text", { x: Math.min(Math.max(place, left + 8), width - 20), y: height - bottom + 14, "text-anchor": "middle" }, String(text).slice(0, 14)));
    }
  }
  svg.append(drawn("text", { x: (left + width) / 2, y: height - 4, "text-anchor": "middle" }, P.data.columns[x].name));
  const verdict = at("verdict");
  for (const row of points) {
    const dot = drawn("circle", { cx: px(row[x]).toFixed(1), cy: py(row[y]).toFixed(1), r: 3.5 });
    if (row[verdict] === "fail") dot.classList.add("fail");
    if (row[0] === P.chosen) dot.classList.add("on");
    dot.append(drawn("title", {}, `run ${row[0]}: ${P.data.columns[x].name} ${shown(row[x])}, ${P.data.columns[y].name} ${shown(row[y])}`));
    dot.addEventListener("click", () => choose(row[0]));
    svg.append(dot);
  }
  if (mean) {
    const sums = new Map();
    for (const row of points) { const key = px(row[x]).toFixed(1), known = sums.get(key) || [0, 0]; sums.set(key, [known[0] + row[y], known[1] + 1]); }
    const way = [...sums].filter(([, [, n]]) => n).map(([key, [sum, n]]) => [+key, py(sum / n)]).sort((a, b) => a[0] - b[0]);
    if (way.length > 1 && way.length <= 40) svg.append(drawn("path", { d: "M" + way.map(([a, b]) => `${a.toFixed(1)} ${b.toFixed(1)}`).join("L") }));
  }
  return svg;
};

const choice = (label, id, columns, chosen, then) => {
  const select = element("select", "", { id });
  for (const column of columns) select.append(element("option", column.name, { value: at(column.name) }));
  select.value = String(chosen);
  select.addEventListener("change", () => then(+select.value));
  const made = element("label", label + " ");
  made.append(select);
  return made;
};

const choose = (number) => { P.chosen = P.chosen === number ? null : number; show(); document.querySelector("tr.on")?.scrollIntoView({ block: "nearest" }); };

const linked = (row) => {
  const link = P.data.links[row[0]];
  return link ? element("a", `run ${row[0]}`, { href: link }) : element("b", `run ${row[0]}`);
};

const head = (list) => {
  const box = document.getElementById("head"), verdict = at("verdict");
  box.replaceChildren(element("h1", P.data.study));
  const failing = P.data.rows.filter((row) => row[verdict] === "fail").length;
  for (const [value, text] of [[P.data.rows.length, "runs"], [failing, "fail"], [list.length, "shown"]]) {
    const figure = element("span");
    figure.append(element("b", String(value)), ` ${text}`);
    box.append(figure);
  }
  const there = list.filter((row) => row[P.answer] !== null && row[at("status")] !== "failed");
  if (there.length && numeric(P.data.columns[P.answer])) {
    const least = there.reduce((a, b) => b[P.answer] < a[P.answer] ? b : a), most = there.reduce((a, b) => b[P.answer] > a[P.answer] ? b : a);
    for (const [text, row] of [["least", least], ["most", most]]) {
      const figure = element("span", `${text} ${P.data.columns[P.answer].name} ${shown(row[P.answer])}: `);
      figure.append(linked(row));
      box.append(figure);
    }
  }
  const best = P.data.rows.find((row) => row[0] === P.data.best);
  if (best) {
    const figure = element("span", "best: ");
    figure.append(linked(best));
    box.append(figure);
  }
  if (P.data.apart > 1) box.append(element("span", `one run in ${P.data.apart} is in this page, all are in the tables`));
  for (const limit of P.data.limits) box.append(element("span", `fails if ${limit}`));
  box.append(element("span", "gcodesim sweep", { class: "brand" }));
};

const table = (list) => {
  const box = document.getElementById("table"), made = element("table"), line = element("tr");
  P.data.columns.forEach((column, place) => {
    const mark = place === P.sort ? (P.down ? " ▾" : " ▴") : "";
    const cell = element("th", column.name + mark, numeric(column) ? {} : { class: "text" });
    cell.addEventListener("click", () => { P.down = P.sort === place && !P.down; P.sort = place; P.page = 0; show(); });
    line.append(cell);
  });
  made.append(line);
  const sorted = [...list].sort((a, b) => {
    const one = a[P.sort], other = b[P.sort];
    if (one === other) return a[0] - b[0];
    if (one === null || other === null) return one === null ? 1 : -1;
    return (one < other ? -1 : 1) * (P.down ? -1 : 1);
  });
  for (const row of sorted.slice(P.page * A_PAGE, (P.page + 1) * A_PAGE)) {
    const entry = element("tr");
    if (row[0] === P.chosen) entry.classList.add("on");
    row.forEach((value, place) => {
      const cell = element("td", place ? shown(value) : "");
      if (!place) cell.append(P.data.links[value] ? linked(row) : shown(value));
      if (!numeric(P.data.columns[place])) { cell.classList.add("text"); cell.title = shown(value); }
      if (P.data.columns[place].name === "verdict") cell.classList.add(value);
      entry.append(cell);
    });
    entry.addEventListener("click", (event) => { if (event.target.tagName !== "A") choose(row[0]); });
    made.append(entry);
  }
  box.replaceChildren(made);
  const last = Math.max(Math.ceil(list.length / A_PAGE) - 1, 0), pages = document.getElementById("pages");
  const back = element("button", "‹"), on = element("button", "›");
  back.disabled = P.page === 0; on.disabled = P.page >= last;
  back.addEventListener("click", () => { P.page--; show(); });
  on.addEventListener("click", () => { P.page++; show(); });
  pages.replaceChildren(...(last ? [back, element("span", `page ${P.page + 1} of ${last + 1}`), on] : []));
};

const filters = () => {
  const box = document.getElementById("filters");
  box.replaceChildren(element("span", "show rows with"));
  P.data.columns.forEach((column, place) => {
    if (!["input", "verdict"].includes(column.role) && place !== P.answer) return;
    if (["status", "notes", "first_finding"].includes(column.name)) return;
    const made = element("span", column.name, { class: "filter" });
    if (numeric(column)) {
      const low = element("input", "", { placeholder: "from", "aria-label": `${column.name} from` }), high = element("input", "", { placeholder: "to", "aria-label": `${column.name} to` });
      const set = () => {
        const a = low.value.trim() === "" ? -Infinity : +low.value, b = high.value.trim() === "" ? Infinity : +high.value;
        if (a === -Infinity && b === Infinity) P.filters.delete(place);
        else P.filters.set(place, (value) => value !== null && value >= a && value <= b);
        P.page = 0; show();
      };
      low.addEventListener("change", set); high.addEventListener("change", set);
      made.append(low, high);
    } else {
      const part = element("input", "", { placeholder: "has", "aria-label": `${column.name} has` });
      part.addEventListener("change", () => {
        const text = part.value.toLowerCase();
        if (text === "") P.filters.delete(place); else P.filters.set(place, (value) => String(value ?? "").toLowerCase().includes(text));
        P.page = 0; show();
      });
      made.append(part);
    }
    box.append(made);
  });
};

const show = () => {
  const list = rows();
  head(list);
  document.getElementById("scatter").replaceChildren(plot(P.x, P.y, list, 640, 380, false));
  document.getElementById("responses").replaceChildren(
    ...P.data.columns.flatMap((column, place) => column.role === "input" ? [plot(place, P.answer, list, 300, 210, true)] : []));
  table(list);
};

const begin = async () => {
  const packed = Uint8Array.from(atob(document.getElementById("index").textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  P.data = JSON.parse(await new Response(stream).text());
  const columns = P.data.columns, figures = columns.filter((column) => column.role === "figure" && P.data.rows.some((row) => row[at(column.name)] !== null));
  const inputs = columns.filter((column) => column.role === "input"), fit = [...inputs, ...figures];
  P.answer = Math.max(at(P.data.aim), 0);
  P.x = at((inputs[0] || fit[0] || columns[0]).name);
  P.y = P.answer;
  document.getElementById("axes").replaceChildren(
    choice("across", "x", fit, P.x, (place) => { P.x = place; show(); }), choice("up", "y", fit, P.y, (place) => { P.y = place; show(); }));
  document.getElementById("answer").replaceChildren(
    choice("how the inputs change", "answer-of", figures, P.answer, (place) => { P.answer = place; filters(); P.filters.clear(); show(); }));
  filters();
  show();
  document.body.dataset.ready = "1";
};
begin();
