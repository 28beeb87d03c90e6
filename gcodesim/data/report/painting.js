"use strict";
// The finished part in colours: how far it is from its target, which tool and which line made each face. A face leads to
// its line, and the line of the moment to its faces.
G.GOUGE_INKS = [[0.70, 0.09, 0.17], [0.94, 0.54, 0.38], [0.97, 0.97, 0.97], [0.40, 0.66, 0.81], [0.13, 0.40, 0.67]];
G.WITHIN_INK = [0.67, 0.77, 0.63];
G.UNTOUCHED_INK = [0.74, 0.74, 0.74];
G.NOW_INK = [0.93, 0.10, 0.60];
G.TOLERANCES_SHOWN = 4;

G.gougeInk = (share) => {
  const at = Math.min(Math.max(share, 0), 1) * (G.GOUGE_INKS.length - 1), i = Math.min(Math.floor(at), G.GOUGE_INKS.length - 2);
  return G.GOUGE_INKS[i].map((v, c) => v + (at - i) * (G.GOUGE_INKS[i + 1][c] - v));
};

Object.assign(G.View.prototype, {
  buildPainting(bar, before) {
    this.painted = "";
    this.skins = this.run.replay.skins || [];
    this.paintedMeshes = [];
    this.partLegend = this.box.appendChild(G.make("div", "legend part"));
    this.partLegend.hidden = true;
    if (!this.skins.length) return;
    const label = G.make("label", "", "part by "), choice = label.appendChild(G.make("select", "part-by"));
    choice.appendChild(new Option("material", ""));
    for (const [name, text] of [["deviation", "deviation from target"], ["tool", "tool"], ["line", "line"]]) choice.appendChild(new Option(text, name));
    choice.onchange = () => this.paintPart(choice.value);
    bar.insertBefore(label, before);
    this.partChoice = choice;
  },

  // One mesh for each skin, with corners of its own for each face.
  buildSkins() {
    for (const skin of this.skins) {
      const points = G.rows(skin.points), corners = G.rows(skin.triangles, Uint32Array), place = new Float32Array(3 * corners.length);
      for (let i = 0; i < corners.length; i++) place.set(points.subarray(3 * corners[i], 3 * corners[i] + 3), 3 * i);
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.BufferAttribute(place, 3));
      geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(place.length), 3));
      const material = new THREE.MeshStandardMaterial({ vertexColors: true, flatShading: true, side: THREE.DoubleSide, roughness: 0.75, metalness: 0 });
      Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 60, clippingPlanes: this.clip });
      this.stockMaterials.add(material);
      const mesh = new THREE.Mesh(geometry, material);
      mesh.userData = { skin, deviation: G.column(skin.deviation), maker: G.column(skin.maker) };
      this.frame(skin.frame).add(mesh);
      this.paintedMeshes.push(mesh);
    }
  },

  paintPart(name) {
    if (!this.skins.length) return;
    this.painted = name;
    this.partChoice.value = name;
    if (name && !this.paintedMeshes.length) this.buildSkins();
    this.shownLine = null;
    this.inkFaces();
    this.showStock();
    this.showPartLegend();
    this.dirty = true;
  },

  showStock() {
    for (const tile of this.tiles) for (const mesh of tile.meshes) mesh.visible = this.shown.stock && !this.painted;
    for (const mesh of this.paintedMeshes) mesh.visible = this.shown.stock && !!this.painted;
    this.dirty = true;
  },

  // The colour of each maker of a skin.
  makerInks(skin) {
    const key = this.painted === "tool" ? ([, , tool]) => tool : ([file, line]) => `${file}:${line}`;
    const known = [...new Set(skin.makers.map(key))];
    return skin.makers.map((maker) => new THREE.Color(G.INKS[known.indexOf(key(maker)) % G.INKS.length]).toArray());
  },

  inkFaces() {
    if (!this.painted) return;
    const ink = new THREE.Color();
    for (const mesh of this.paintedMeshes) {
      const { skin, deviation, maker } = mesh.userData, color = mesh.geometry.attributes.color;
      const within = skin.tolerance_mm / skin.step_mm, most = 2 * G.TOLERANCES_SHOWN * within;
      const inks = this.painted === "deviation" ? null : this.makerInks(skin), now = this.shownLine;
      for (let f = 0; f < maker.length; f++) {
        let rgb;
        if (!inks) rgb = Math.abs(deviation[f]) <= within + 0.5 ? G.WITHIN_INK : G.gougeInk(0.5 + deviation[f] / most);
        else rgb = maker[f] < 0 ? G.UNTOUCHED_INK : inks[maker[f]];
        const own = maker[f] >= 0 ? skin.makers[maker[f]] : null;
        if (this.painted === "line" && own && now && own[1] === now.line && own[0] === now.file) rgb = G.NOW_INK;
        ink.setRGB(...rgb).convertSRGBToLinear();
        for (let k = 0; k < 3; k++) ink.toArray(color.array, 9 * f + 3 * k);
      }
      color.needsUpdate = true;
    }
  },

  // By line, the faces of the line that runs stand out.
  showPainted(t) {
    if (this.painted !== "line") return;
    const { line, modal } = G.blockAt(this.run, t), file = modal && this.run.files[modal.file], now = file ? { file: file.name, line } : null;
    if (now && this.shownLine && now.line === this.shownLine.line && now.file === this.shownLine.file) return;
    this.shownLine = now;
    this.inkFaces();
  },

  showPartLegend() {
    this.partLegend.replaceChildren();
    this.partLegend.hidden = !this.painted;
    if (!this.painted) return;
    const entry = (rgb, text) => {
      const row = this.partLegend.appendChild(G.make("div")), spot = row.appendChild(G.make("i"));
      spot.style.background = G.cssInk(rgb);
      row.append(text);
    };
    const [skin] = this.skins;
    if (this.painted === "deviation") {
      const strip = this.partLegend.appendChild(G.make("div", "strip")), most = G.TOLERANCES_SHOWN * skin.tolerance_mm;
      strip.style.background = `linear-gradient(to right, ${G.GOUGE_INKS.map(G.cssInk).join(",")})`;
      const ends = this.partLegend.appendChild(G.make("div", "ends"));
      ends.append(G.make("span", "", `−${G.short(most)}`), G.make("span", "", "gouge · mm · excess"), G.make("span", "", `+${G.short(most)}`));
      entry(G.WITHIN_INK, `within ±${G.short(skin.tolerance_mm)} mm`);
      return;
    }
    const inks = this.makerInks(skin), seen = new Set();
    if (this.painted === "tool") {
      skin.makers.forEach(([, , tool], k) => { if (!seen.has(tool)) { seen.add(tool); entry(inks[k], `T${tool}`); } });
    } else entry(G.NOW_INK, "line of the moment");
    entry(G.UNTOUCHED_INK, "made by no tool");
  },

  // What a face is: its deviation, and who made it.
  faceOf(hit) {
    const { skin, deviation, maker } = hit.object.userData, f = hit.faceIndex, own = maker[f] >= 0 ? skin.makers[maker[f]] : null;
    return { deviation: deviation[f] * skin.step_mm, file: own && own[0], line: own && own[1], tool: own && own[2] };
  },

  tellFace({ deviation, file, line, tool }) {
    const t = file ? G.firstOf(this.run, file, line) : null, found = this.run.files.find((one) => one.name === file);
    if (t !== null) G.seek(t + 1e-6);
    const far = `${deviation < 0 ? "−" : "+"}${G.number(Math.abs(deviation), 3)} mm`;
    this.tell(file ? `line ${this.run.files.length > 1 ? `${file}:` : ""}${line}, T${tool}, ${far}: ${found ? found.lines[line - 1] : ""}` : `made by no tool, ${far}`);
  },

  // A place out of tolerance, by its number in the results.
  lookAtSpot(number) {
    const skin = this.skins.find((one) => number < one.spots.length);
    if (!skin) return;
    this.paintPart("deviation");
    const [low, high] = skin.spots[number].map((point) => new THREE.Vector3().fromArray(point));
    const frame = this.frame(skin.frame), way = this.camera.position.clone().sub(this.target).normalize();
    this.scene.updateMatrixWorld(true);
    this.target.copy(frame.localToWorld(low.clone().add(high).multiplyScalar(0.5)));
    const far = Math.max(6 * low.distanceTo(high), 0.6 * this.partSize());
    this.camera.position.copy(this.target).addScaledVector(way, far);
    this.camera.near = far / 200;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
    this.shareCamera();
  },
});

// How high the ridges are that each operation of a round tool left on the part.
G.scallopTable = (place, run) => {
  const ridges = run.results.target?.scallops || [];
  if (!ridges.length) return;
  G.table(place, `${G.runs.length > 1 ? `${run.name}: ` : ""}Scallops`, "ridges between passes, against the target: half of the area has lower ones",
    [["operation", "l"], ["tool"], ["mm²"], ["typical mm"], ["highest mm"]],
    ridges.map((one) => ({
      cells: [one.operation ?? "–", `T${one.tool}`, G.number(one.area_mm2, 0), G.number(one.typical_mm, 4), G.number(one.most_mm, 4)],
      t: (() => { const own = (run.results.operations || []).find((other) => other.name === one.operation && other.tool === one.tool); return own ? G.firstOf(run, run.program, own.first_line) : null; })(),
    })));
};

// Where the part is not what it should be: each place leads to its line, and the view to the place.
G.targetTable = (place, run) => {
  const target = run.results.target;
  if (!target) return;
  const view = () => G.views.find((one) => one.run === run), signed = (v) => `${v < 0 ? "−" : "+"}${G.number(Math.abs(v), 3)}`;
  const share = `${G.number(100 * target.share_outside, 2)} % of the target beyond ${G.short(target.tolerance_mm)} mm`;
  const lines = (region) => region.lines.length ? region.lines.slice(0, 4).map((one) => one.line).join(", ") + (region.lines.length > 4 ? " …" : "") : region.line ? `${region.line}?` : "–";
  const others = (region) => (region.others ?? []).slice(0, 4).map((one) => one.line).join(", ") + ((region.others ?? []).length > 4 ? " …" : "");
  G.table(place, `${G.runs.length > 1 ? `${run.name}: ` : ""}Part against target`, `${signed(target.least_deviation_mm)} to ${signed(target.most_deviation_mm)} mm, ${share}`,
    [["", "l"], ["mm"], ["mm³"], ["at"], ["lines"], ["also"], ["tool"]],
    target.regions.map((region, number) => ({
      cells: [region.kind, G.number(region.depth_mm, 3), G.number(region.volume_mm3, 1), `${region.system} X${G.short(region.x_mm)} Y${G.short(region.y_mm)} Z${G.short(region.z_mm)}`, lines(region), others(region), region.tool === null ? "–" : `T${region.tool}`],
      go: () => {
        const t = region.line ? G.firstOf(run, region.file, region.line) : null;
        if (t !== null) G.seek(t + 1e-6);
        view().lookAtSpot(number);
      },
    })));
};
