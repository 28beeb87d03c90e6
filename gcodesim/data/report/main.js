"use strict";
// Puts the page together. `#t=12.5` in the address opens it at a moment, `&view=cell` from a side, `&part=line` with the part in colours.
(async () => {
  await G.load();
  const place = (id) => document.getElementById(id);
  G.head(place("head"));
  G.views = [];
  for (const run of G.runs) {
    const view = new G.View(run, place("stage"));
    G.views.push(view);
    G.onTime((t) => view.show(t));
  }
  G.program(place("stage"));
  G.bar(place("bar"));
  G.plots = G.charts(place("charts"));
  G.tables(place("tables"));
  const wishes = new URLSearchParams(location.hash.slice(1));
  G.seek(+(wishes.get("t") || 0));
  if (wishes.has("t") || wishes.has("view")) G.views[0].look(wishes.get("view") || "start");
  if (wishes.has("part")) for (const view of G.views) view.paintPart(wishes.get("part"));
  const frame = (at) => {
    G.tick(at);
    for (const view of G.views) view.render();
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
  document.body.dataset.ready = "1";
})().catch((problem) => {
  document.body.dataset.ready = "failed";
  const text = typeof DecompressionStream === "undefined"
    ? "This browser is too old for the page: it needs one of 2023 or later." : `The page could not be shown: ${problem}`;
  document.getElementById("stage").textContent = text;
  throw problem;
});
