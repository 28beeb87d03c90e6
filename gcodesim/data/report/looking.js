"use strict";
// Ways to look closer at a view: the path by colours, a section, picking lines of the program, and measuring.
G.SCALE = [[0.45, 0.47, 0.62], [0.27, 0.45, 0.92], [0.11, 0.78, 0.72], [0.64, 0.93, 0.24], [0.98, 0.68, 0.15], [0.85, 0.15, 0.04]];
G.scaleInk = (share) => {
  const at = Math.min(Math.max(share, 0), 1) * (G.SCALE.length - 1), i = Math.min(Math.floor(at), G.SCALE.length - 2), part = at - i;
  return G.SCALE[i].map((v, c) => v + part * (G.SCALE[i + 1][c] - v));
};
G.cssInk = (ink) => `rgb(${ink.map((v) => Math.round(255 * v)).join(",")})`;
G.KIND_INKS = [[0.93, 0.55, 0.15], [0.32, 0.62, 0.86], [0.06, 0.32, 0.66]];
G.PICK_PIXELS = 9;

// A run's figures for colours, and its tools, for each known moment.
G.coloursOf = (run, times, kind) => {
  const found = new Map();
  for (const colour of run.replay.colours) found.set(colour.name, { ...colour, values: G.column(colour.values) });
  const tools = Float32Array.from(times, (t) => { const { modal } = G.blockAt(run, t - 1e-6); return modal ? modal.tool : 0; });
  if (new Set(tools).size > 1) found.set("tool", { name: "tool", unit: "", values: tools });
  const lines = Float32Array.from(times, (t) => G.blockAt(run, t - 1e-6).line || 0);
  if (new Set(lines).size > 1) found.set("line", { name: "line", unit: "", values: lines });
  for (const colour of found.values()) {
    // rapids, and moves without work for what work does, do not set the scale
    const counts = (i) => colour.name === "feed" ? kind[i] !== 0 : colour.name === "force" ? kind[i] === 2 : true;
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < kind.length; i++) if (counts(i)) { low = Math.min(low, colour.values[i]); high = Math.max(high, colour.values[i]); }
    Object.assign(colour, high > low ? { low, high } : { low: 0, high: Math.max(high, 1e-9) });
  }
  return found;
};

Object.assign(G.View.prototype, {
  buildLooking() {
    this.colours = G.coloursOf(this.run, this.times, this.kind);
    const bar = this.box.appendChild(G.make("div", "looks"));
    const label = bar.appendChild(G.make("label", "", "path by ")), choice = label.appendChild(G.make("select", "by"));
    choice.appendChild(new Option("kind of move", ""));
    for (const name of this.colours.keys()) choice.appendChild(new Option(name === "deviation" ? "deviation from command" : name, name));
    choice.onchange = () => this.colourPath(choice.value);
    const cut = bar.appendChild(G.make("label", "", "section ")), axis = cut.appendChild(G.make("select", "axis"));
    for (const name of ["none", "X", "Y", "Z"]) axis.appendChild(new Option(name, name));
    const slider = cut.appendChild(G.make("input"));
    Object.assign(slider, { type: "range", min: 0, max: 1000, value: 500, disabled: true });
    axis.onchange = slider.oninput = () => { slider.disabled = axis.value === "none"; this.section(axis.value, slider.value / 1000); };
    this.buildPainting(bar, label);
    const measure = bar.appendChild(G.make("button", "", "measure"));
    measure.title = "click two points of the part or the path";
    measure.onclick = () => { this.measuring = measure.classList.toggle("on") ? [] : null; this.showMeasure(); };
    this.legend = this.box.appendChild(G.make("div", "legend"));
    this.said = this.box.appendChild(G.make("output", "said"));
    this.marks = new THREE.Group();
    this.frame(this.run.replay.track.frame).add(this.marks);
    const canvas = this.renderer.domElement;
    let down = null;
    canvas.addEventListener("pointerdown", (event) => { down = [event.clientX, event.clientY]; });
    canvas.addEventListener("pointerup", (event) => {
      if (down && event.button === 0 && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < 4) {
        const box = canvas.getBoundingClientRect();
        this.click(event.clientX - box.left, event.clientY - box.top);
      }
      down = null;
    });
    this.colourPath("");
  },

  // ---- colours

  colourPath(name) {
    const colour = this.colours.get(name), n = this.kind.length, ink = new THREE.Color();
    const tools = colour && name === "tool" ? [...new Set(colour.values)].sort((a, b) => a - b) : [];
    const toolInk = (tool) => new THREE.Color(G.INKS[tools.indexOf(tool) % G.INKS.length]).toArray();
    const inkOf = (i) => {
      if (!colour) return G.KIND_INKS[this.kind[i]];
      if (tools.length) return toolInk(colour.values[i]);
      if (this.kind[i] === 0 && name !== "deviation") return [0.72, 0.74, 0.76];
      return G.scaleInk((colour.values[i] - colour.low) / (colour.high - colour.low));
    };
    for (let i = 0; i + 1 < n; i++) {
      ink.setRGB(...inkOf(i + 1)).convertSRGBToLinear();
      for (const end of [0, 3]) ink.toArray(this.trackColors, 6 * i + end);
    }
    for (const part of [this.ahead, this.behind]) part.geometry.attributes.color.needsUpdate = true;
    this.legend.replaceChildren();
    const entry = (rgb, text) => {
      const row = this.legend.appendChild(G.make("div")), spot = row.appendChild(G.make("i"));
      spot.style.background = G.cssInk(rgb);
      row.append(text);
    };
    if (!colour) ["rapid", "feed", "feed in material"].forEach((text, k) => entry(G.KIND_INKS[k], text));
    else if (tools.length) for (const tool of tools) entry(toolInk(tool), tool ? `T${tool}` : "no tool");
    else {
      const strip = this.legend.appendChild(G.make("div", "strip"));
      strip.style.background = `linear-gradient(to right, ${G.SCALE.map(G.cssInk).join(",")})`;
      const ends = this.legend.appendChild(G.make("div", "ends"));
      ends.append(G.make("span", "", G.short(colour.low)), G.make("span", "", `${name} ${colour.unit}`), G.make("span", "", G.short(colour.high)));
      if (name !== "deviation") entry([0.72, 0.74, 0.76], "rapid");
    }
    this.show(G.time);
  },

  // ---- section: what of the part lies on the far side of a plane

  section(axis, share) {
    const k = ["X", "Y", "Z"].indexOf(axis), { part } = this.extents();
    this.clip ||= [];
    this.clip.length = 0;
    if (k >= 0) {
      const low = part.min.getComponent(k), high = part.max.getComponent(k), normal = new THREE.Vector3();
      normal.setComponent(k, k === 1 ? 1 : -1); // away from where one looks at first
      const at = low + share * (high - low);
      this.clip.push(new THREE.Plane(normal, k === 1 ? -at : at));
      this.tell(`section at ${axis} ${G.number(1000 * (at - low), 2)} mm of ${G.number(1000 * (high - low), 2)} mm`);
    } else this.tell("");
    this.renderer.localClippingEnabled = true;
    for (const material of this.stockMaterials) {
      material.clippingPlanes = this.clip;
      material.needsUpdate = true;
    }
    this.dirty = true;
  },

  // ---- picking

  // What is at a place of the canvas [pixels]: a moment of the path, or a point of the part in the frame of the path.
  under(x, y) {
    const width = this.box.clientWidth, height = this.box.clientHeight, frame = this.frame(this.run.replay.track.frame);
    this.render();
    this.scene.updateMatrixWorld(true);
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * x) / width - 1, 1 - (2 * y) / height), this.camera);
    const meshes = (this.painted ? this.paintedMeshes : this.tiles.flatMap((tile) => tile.meshes)).filter((mesh) => mesh.visible);
    const seen = (hit) => (this.clip || []).every((plane) => plane.distanceToPoint(hit.point) >= 0);
    const hit = ray.intersectObjects(meshes).find(seen), depth = hit ? hit.distance : Infinity;
    const found = this.shown.path && !(this.painted && hit) ? this.pathUnder(x, y, depth + 0.02 * this.partSize()) : null;
    if (found) return found;
    return hit ? { point: frame.worldToLocal(hit.point.clone()), t: null, face: this.painted ? this.faceOf(hit) : null } : null;
  },

  // The nearest moment of the path within some pixels, no farther away than `depth`.
  pathUnder(x, y, depth) {
    const width = this.box.clientWidth, height = this.box.clientHeight, n = this.kind.length, spot = new THREE.Vector3();
    const frame = this.frame(this.run.replay.track.frame), screen = new Float32Array(3 * n), matrix = frame.matrixWorld;
    for (let i = 0; i < n; i++) {
      spot.fromArray(this.trackPoints, 3 * i).applyMatrix4(matrix);
      const far = spot.distanceTo(this.camera.position);
      spot.project(this.camera);
      screen.set([(spot.x + 1) * 0.5 * width, (1 - spot.y) * 0.5 * height, spot.z < 1 ? far : Infinity], 3 * i);
    }
    let best = null, least = G.PICK_PIXELS;
    for (let i = 0; i + 1 < n; i++) {
      const ax = screen[3 * i], ay = screen[3 * i + 1], dx = screen[3 * i + 3] - ax, dy = screen[3 * i + 4] - ay, square = dx * dx + dy * dy;
      const share = square > 0 ? Math.min(Math.max(((x - ax) * dx + (y - ay) * dy) / square, 0), 1) : 0;
      const gap = Math.hypot(x - ax - share * dx, y - ay - share * dy);
      const far = screen[3 * i + 2] + share * (screen[3 * i + 5] - screen[3 * i + 2]);
      if (gap < least - 0.5 && far <= depth) { least = gap; best = { i, share }; }
    }
    if (!best) return null;
    const { i, share } = best, point = this.blend(this.trackPoints, i, share, new THREE.Vector3());
    return { point, t: this.times[i] + share * (this.times[i + 1] - this.times[i]) };
  },

  // When the tool worked nearest to a point of the part: up to now, if it has worked there, else later.
  workedAt(point) {
    const a = new THREE.Vector3(), line = new THREE.Line3(), near = new THREE.Vector3(), most = 1e-3 * this.partSize();
    let best = null, least = Infinity;
    for (let i = 0; i + 1 < this.kind.length; i++) {
      if (this.kind[i + 1] !== 2) continue;
      line.set(a.fromArray(this.trackPoints, 3 * i).clone(), new THREE.Vector3().fromArray(this.trackPoints, 3 * i + 3));
      const share = line.closestPointToPointParameter(point, true), gap = line.at(share, near).distanceTo(point);
      const t = this.times[i] + share * (this.times[i + 1] - this.times[i]), done = t <= G.time + 1e-9;
      if (gap < least - most || (gap < least + most && best !== null && done && best <= t)) { least = Math.min(gap, least); best = t; }
    }
    return best;
  },

  click(x, y) {
    const found = this.under(x, y);
    if (!found) return;
    if (this.measuring) {
      if (this.measuring.length > 1) this.measuring.length = 0;
      this.measuring.push(found.point);
      this.showMeasure();
      return;
    }
    if (found.face) {
      this.tellFace(found.face);
      return;
    }
    const t = found.t ?? this.workedAt(found.point);
    if (t === null) return;
    G.seek(t);
    const name = G.lineName(this.run, t), { line, modal } = G.blockAt(this.run, t), file = modal && this.run.files[modal.file];
    this.tell(name ? `line ${name}: ${file ? file.lines[line - 1] : ""}` : "");
  },

  // ---- measuring, in the axes of the part

  showMeasure() {
    this.marks.clear();
    const points = this.measuring || [], size = 0.008 * this.partSize();
    const ink = new THREE.MeshBasicMaterial({ color: 0xb0148c, depthTest: false, transparent: true });
    for (const point of points) {
      const ball = new THREE.Mesh(new THREE.SphereGeometry(size, 20, 12), ink);
      ball.position.copy(point);
      ball.renderOrder = 11;
      this.marks.add(ball);
    }
    if (points.length === 2) {
      const line = new THREE.Line(new THREE.BufferGeometry().setFromPoints(points), new THREE.LineBasicMaterial({ color: 0xb0148c, depthTest: false }));
      line.renderOrder = 11;
      this.marks.add(line);
      const way = points[1].clone().sub(points[0]), mm = (v) => `${G.number(1000 * v, 3)}`;
      this.tell(`${mm(way.length())} mm   ΔX ${mm(way.x)}   ΔY ${mm(way.y)}   ΔZ ${mm(way.z)}`);
    } else this.tell(this.measuring ? `click ${points.length ? "the second" : "the first"} point` : "");
    this.dirty = true;
  },

  tell(text) { this.said.textContent = text; },
});
