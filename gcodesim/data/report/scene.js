"use strict";
// The three-dimensional view of one run: machine, tool, part and path at a moment.
G.View = class {
  constructor(run, place) {
    this.run = run;
    this.box = place.appendChild(G.make("div", "view"));
    this.shown = { path: true, stock: true, cell: true, force: true };
    this.follow = false;
    this.dirty = true;
    try {
      this.renderer = new THREE.WebGLRenderer({ antialias: true, alpha: true, preserveDrawingBuffer: true });
    } catch (problem) {
      this.box.appendChild(G.make("div", "broken", "This browser draws no WebGL, so the replay is not shown. Charts and tables are."));
      return;
    }
    const renderer = this.renderer;
    renderer.outputEncoding = THREE.sRGBEncoding;
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.box.appendChild(renderer.domElement);
    renderer.domElement.tabIndex = 0;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(32, 1, 0.01, 100);
    this.camera.up.set(0, 0, 1);
    this.target = new THREE.Vector3();
    this.groups = {};
    for (const name of ["cell", "tool", "stock", "path", "force"]) this.scene.add(this.groups[name] = new THREE.Group());
    this.readMotion();
    this.pose(0, 0);
    this.buildCell();
    this.buildTools();
    this.buildStock();
    this.buildPath();
    this.buildForce();
    this.buildLight();
    this.buildControls();
    if (G.runs.length > 1) this.box.appendChild(G.make("div", "tag", run.name));
    this.buildState();
    this.buildLooking();
    new ResizeObserver(() => this.resize()).observe(this.box);
    this.resize();
    this.look("start");
  }

  // ---- motion

  readMotion() {
    const replay = this.run.replay;
    this.times = this.run.seconds(replay.times);
    this.frames = {};
    for (const [name, frame] of Object.entries(replay.frames)) {
      const object = new THREE.Group();
      this.scene.add(object);
      this.frames[name] = { object };
      if (frame.p) {
        object.position.fromArray(frame.p);
        object.quaternion.fromArray(frame.q);
      } else {
        this.frames[name].p = G.rows(frame.positions);
        this.frames[name].q = G.rows(frame.quaternions);
      }
    }
    this.frames.world = { object: this.scene };
    this.tip = G.rows(replay.tip);
    this.work = G.rows(replay.work).map((um) => um * 1e-6);
    this.wrench = G.rows(replay.force);
  }

  frame(name) { return (this.frames[name] || this.frames.world).object; }

  // Where between two known moments a time lies.
  between(t) {
    const last = this.times.length - 1, i = Math.min(Math.max(G.index(this.times, t), 0), Math.max(last - 1, 0));
    const span = last > 0 ? this.times[i + 1] - this.times[i] : 0;
    return [i, span > 0 ? Math.min(Math.max((t - this.times[i]) / span, 0), 1) : 0];
  }

  blend(rows, i, share, into) {
    const a = 3 * i, b = Math.min(a + 3, rows.length - 3);
    return into.set(
      rows[a] + share * (rows[b] - rows[a]), rows[a + 1] + share * (rows[b + 1] - rows[a + 1]), rows[a + 2] + share * (rows[b + 2] - rows[a + 2]));
  }

  pose(i, share) {
    const next = Math.min(i + 1, this.times.length - 1), turn = (this.scratch4 ||= new Float32Array(4));
    for (const { object, p, q } of Object.values(this.frames)) {
      if (!p) continue;
      this.blend(p, i, share, object.position);
      THREE.Quaternion.slerpFlat(turn, 0, q, 4 * i, q, 4 * next, share);
      object.quaternion.fromArray(turn).normalize();
    }
  }

  show(t) {
    if (!this.renderer) return;
    const [i, share] = this.between(t);
    this.pose(i, share);
    for (const { group, from, to } of this.tools) group.visible = t >= from && t < to;
    for (const tile of this.tiles) {
      const state = tile.states[Math.max(G.index(tile.times, t + 1e-9), 0)];
      if (state !== tile.current) this.setTile(tile, state);
    }
    this.showPath(t, i, share);
    this.showForce(i, share);
    this.showState(t, i, share);
    this.showPainted(t);
    if (this.follow) {
      const tip = this.blend(this.tip, i, share, new THREE.Vector3());
      const shift = tip.sub(this.target);
      this.target.add(shift);
      this.camera.position.add(shift);
    }
    this.dirty = true;
  }

  // ---- bodies

  material(color, options = {}) {
    const key = JSON.stringify([color, options]);
    this.materials ||= {};
    return this.materials[key] ||= new THREE.MeshStandardMaterial({
      color: new THREE.Color(color[0], color[1], color[2]).convertSRGBToLinear(),
      roughness: 0.62, metalness: 0.12, transparent: color[3] < 1, opacity: color[3], ...options,
    });
  }

  body(shape) {
    let geometry, flat = false;
    if (shape.kind === "box") geometry = new THREE.BoxGeometry(...shape.size);
    else if (shape.kind === "sphere") geometry = new THREE.SphereGeometry(shape.radius, 40, 24);
    else if (shape.kind === "cone") {
      geometry = new THREE.CylinderGeometry(shape.top, shape.bottom, shape.length, 48);
      geometry.rotateX(Math.PI / 2); // along z
    } else {
      geometry = this.meshOf(shape);
      flat = true;
    }
    const mesh = new THREE.Mesh(geometry, this.material(shape.color, flat ? { flatShading: true, side: THREE.DoubleSide } : {}));
    mesh.position.fromArray(shape.p);
    mesh.quaternion.fromArray(shape.q);
    mesh.castShadow = mesh.receiveShadow = shape.color[3] >= 1;
    if (!flat) {
      const edges = new THREE.EdgesGeometry(geometry, 35);
      mesh.add(new THREE.LineSegments(edges, this.edgeInk ||= new THREE.LineBasicMaterial({ color: 0x10202c, transparent: true, opacity: 0.28 })));
    }
    return mesh;
  }

  meshOf(shape) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(G.rows(shape.points), 3));
    const kind = shape.points.rows > 65535 ? Uint32Array : Uint16Array;
    geometry.setIndex(new THREE.BufferAttribute(G.rows(shape.triangles, kind), 1));
    return geometry;
  }

  buildCell() {
    this.bodies = [];
    for (const entity of this.run.replay.cell) {
      const group = new THREE.Group();
      for (const shape of entity.shapes) group.add(this.body(shape));
      this.frame(entity.frame).add(group);
      this.bodies.push(group);
    }
  }

  buildTools() {
    const list = this.run.replay.tools, scale = this.run.scale;
    this.tools = list.map((tool, i) => {
      const group = new THREE.Group();
      for (const entity of tool.shapes) {
        const part = new THREE.Group();
        for (const shape of entity.shapes) part.add(this.body(shape));
        group.add(part);
        this.frame(entity.frame).add(group);
      }
      return { group, from: tool.t * scale, to: i + 1 < list.length ? list[i + 1].t * scale : Infinity };
    });
  }

  buildStock() {
    this.clip = [];
    this.stockMaterials = new Set();
    this.tiles = this.run.replay.stock.tiles.map((states) => ({
      times: states.map((state) => state.t * this.run.scale), states, meshes: [], current: null,
    }));
    for (const tile of this.tiles) this.setTile(tile, tile.states[0]);
  }

  setTile(tile, state) {
    for (const mesh of tile.meshes) {
      mesh.removeFromParent();
      mesh.geometry.dispose();
    }
    tile.current = state;
    tile.meshes = state.parts.map((part) => {
      const material = this.material(part.color, { flatShading: true, side: THREE.DoubleSide, roughness: 0.5, metalness: 0.25 });
      // the path runs in the surface that it has made: it is drawn over it
      Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 60 });
      if (!this.stockMaterials.has(material)) {
        this.stockMaterials.add(material);
        material.clippingPlanes = this.clip;
      }
      const mesh = new THREE.Mesh(this.meshOf(part), material);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.visible = this.shown.stock && !this.painted;
      this.frame(part.frame).add(mesh);
      return mesh;
    });
  }

  // ---- path: what is done strong, what comes faint

  buildPath() {
    const { track } = this.run.replay, points = G.rows(track.points), kind = G.column(track.kind), n = kind.length;
    const place = new Float32Array(6 * Math.max(n - 1, 0)), color = new Float32Array(place.length);
    for (let i = 0; i + 1 < n; i++) place.set(points.subarray(3 * i, 3 * i + 6), 6 * i);
    this.kind = kind;
    const attributes = { position: new THREE.BufferAttribute(place, 3), color: new THREE.BufferAttribute(color, 3) };
    const line = (opacity) => {
      const geometry = new THREE.BufferGeometry();
      for (const [name, attribute] of Object.entries(attributes)) geometry.setAttribute(name, attribute);
      const material = new THREE.LineBasicMaterial({ vertexColors: true, transparent: true, opacity, depthWrite: false });
      const segments = new THREE.LineSegments(geometry, material);
      segments.frustumCulled = false;
      this.frame(track.frame).add(segments);
      return segments;
    };
    this.ahead = line(0.3);
    this.behind = line(1);
    this.rest = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ vertexColors: true }));
    this.rest.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(6), 3));
    this.rest.geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(6), 3));
    this.rest.frustumCulled = false;
    this.frame(track.frame).add(this.rest);
    this.trackPoints = points;
    this.trackColors = color;
    this.pathBox = new THREE.Box3();
    const spot = new THREE.Vector3(), frame = this.frame(track.frame);
    frame.updateMatrixWorld();
    for (let i = 0; i < n; i++) {
      if (kind[i] === 0) continue; // where it works, not where it waits
      this.pathBox.expandByPoint(spot.fromArray(points, 3 * i).applyMatrix4(frame.matrixWorld));
    }
  }

  showPath(t, i, share) {
    const count = Math.max(this.times.length - 1, 0);
    this.behind.geometry.setDrawRange(0, 2 * i);
    this.ahead.geometry.setDrawRange(2 * i, 2 * (count - i));
    const place = this.rest.geometry.attributes.position, color = this.rest.geometry.attributes.color;
    if (count > 0) {
      const now = this.blend(this.trackPoints, i, share, this.scratch3 ||= new THREE.Vector3());
      place.array.set(this.trackPoints.subarray(3 * i, 3 * i + 3));
      now.toArray(place.array, 3);
      color.array.set(this.trackColors.subarray(6 * i, 6 * i + 6));
      place.needsUpdate = color.needsUpdate = true;
    }
    for (const part of [this.ahead, this.behind, this.rest]) part.visible = this.shown.path;
  }

  // ---- force on the tool

  buildForce() {
    let most = 0;
    for (let i = 0; i < this.wrench.length; i += 3) most = Math.max(most, Math.hypot(this.wrench[i], this.wrench[i + 1], this.wrench[i + 2]));
    this.mostForce = most;
    this.arrow = new THREE.Group();
    // drawn over everything: mostly it would be inside of the tool or the part
    const material = new THREE.MeshBasicMaterial({ color: new THREE.Color(0xcf1f3a).convertSRGBToLinear(), depthTest: false, transparent: true, opacity: 0.9 });
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(1, 1, 1, 20).translate(0, 0.5, 0), material);
    this.point = new THREE.Mesh(new THREE.ConeGeometry(1, 1, 24).translate(0, 0.5, 0), material);
    this.arrow.add(this.shaft, this.point);
    this.shaft.renderOrder = this.point.renderOrder = 10;
    this.scene.add(this.arrow);
  }

  showForce(i, share) {
    const force = this.blend(this.wrench, i, share, new THREE.Vector3()), size = force.length();
    this.arrow.visible = this.shown.force && size > 0.01 * this.mostForce && size > 0;
    if (!this.arrow.visible) return;
    const room = this.partSize(), whole = (size / this.mostForce) * 0.4 * room, thick = 0.007 * room;
    this.blend(this.tip, i, share, this.arrow.position);
    this.arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), force.normalize());
    const head = Math.min(5 * thick, 0.5 * whole);
    this.shaft.scale.set(thick, Math.max(whole - head, 1e-9), thick);
    this.point.scale.set(2.1 * thick, head, 2.1 * thick);
    this.point.position.y = whole - head;
  }

  // ---- the numbers of the moment

  buildState() {
    this.state = this.box.appendChild(G.make("dl", "state"));
    this.cells = {};
    for (const name of ["X", "Y", "Z", "F", "S", "T"]) {
      this.state.appendChild(G.make("dt", "", name));
      this.cells[name] = this.state.appendChild(G.make("dd"));
    }
  }

  showState(t, i, share) {
    const { modal, i: block } = G.blockAt(this.run, t), at = this.blend(this.work, i, share, new THREE.Vector3());
    ["x", "y", "z"].forEach((axis) => { this.cells[axis.toUpperCase()].textContent = `${G.number(1000 * at[axis], 2)} mm`; });
    this.cells.F.textContent = modal ? (modal.motion === "G0" ? "rapid" : `${G.number(G.feedAt(this.run, block), 0)} mm/min`) : "–";
    this.cells.S.textContent = modal ? `${G.number(modal.spindle, 0)} rpm` : "–";
    this.cells.T.textContent = modal && modal.tool ? `${modal.tool} ${modal.tool_name !== `T${modal.tool}` ? modal.tool_name : ""}` : "–";
  }

  // ---- light, ground, camera

  extents() {
    this.scene.updateMatrixWorld(true);
    const cell = new THREE.Box3(), part = new THREE.Box3();
    for (const body of this.bodies) cell.expandByObject(body);
    for (const tile of this.tiles) for (const mesh of tile.meshes) part.expandByObject(mesh);
    if (part.isEmpty()) part.copy(this.pathBox);
    else if (!this.pathBox.isEmpty() && this.run.replay.stock.corners === null) part.union(this.pathBox);
    if (part.isEmpty()) part.copy(cell);
    cell.union(part);
    return { cell, part };
  }

  partSize() {
    return (this.partExtent ||= Math.max(...this.extents().part.getSize(new THREE.Vector3()).toArray(), 1e-3));
  }

  workSize() {
    if (!this.size) {
      const { part } = this.extents(), size = part.getSize(new THREE.Vector3());
      if (!this.pathBox.isEmpty()) size.max(this.pathBox.getSize(new THREE.Vector3()));
      this.size = Math.max(size.x, size.y, size.z, 1e-3);
    }
    return this.size;
  }

  buildLight() {
    const { cell, part } = this.extents(), size = cell.getSize(new THREE.Vector3()).length();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0xb4bdc6, 0.74));
    const sun = new THREE.DirectionalLight(0xfff8ee, 0.62), middle = part.getCenter(new THREE.Vector3());
    const reach = Math.max(1.2 * this.workSize(), 0.25 * size);
    sun.position.copy(middle).add(new THREE.Vector3(-0.55, -0.75, 1.5).multiplyScalar(2 * reach));
    sun.target.position.copy(middle);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    Object.assign(sun.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.05 * reach, far: 6 * reach });
    sun.shadow.bias = -0.0006;
    sun.shadow.normalBias = 0.002 * this.workSize();
    this.scene.add(sun, sun.target);
    this.headlight = new THREE.DirectionalLight(0xe8f0ff, 0.3); // comes from where one looks
    this.scene.add(this.headlight, this.headlight.target);
    const floor = cell.min.z, span = Math.max(size, 4 * this.workSize());
    const step = 10 ** Math.round(Math.log10(span / 12)), half = Math.ceil((0.9 * span) / step);
    const grid = new THREE.GridHelper(2 * half * step, 2 * half, 0x8fa0b0, 0xb7c2cc);
    grid.rotation.x = Math.PI / 2;
    grid.position.set(Math.round(middle.x / step) * step, Math.round(middle.y / step) * step, floor - 1e-4 * span);
    grid.material.transparent = true;
    grid.material.opacity = 0.55;
    this.scene.add(grid);
  }

  // The tool of the moment and the body of the machine that is nearest to its tip.
  holders() {
    const tip = this.blend(this.tip, ...this.between(G.time), new THREE.Vector3()), box = new THREE.Box3();
    const gap = (body) => box.setFromObject(body).distanceToPoint(tip);
    const bodies = [...this.bodies].sort((a, b) => gap(a) - gap(b)).slice(0, 1);
    const inside = this.tools.filter(({ from, to }) => G.time >= from && G.time < to).map(({ group }) => group);
    return [...bodies, ...inside.filter((group) => group.children.length)];
  }

  look(name) {
    const { cell, part } = this.extents(), whole = name === "cell";
    const box = whole ? cell : part.clone(), size = box.getSize(new THREE.Vector3());
    const ways = { part: [-0.62, -1, 0.78], cell: [-0.75, -1, 0.55], top: [0, -0.001, 1], front: [0, -1, 0.001], side: [-1, 0, 0.001] };
    const way = new THREE.Vector3(...(ways[name] || ways.part)).normalize();
    box.getCenter(this.target);
    let radius = 0.5 * size.length();
    if (name === "start") { // the part together with the tool, or what will hold it
      const bodies = this.holders(), both = box.clone();
      for (const body of bodies) both.expandByObject(body);
      both.getCenter(this.target);
      radius = 0.55 * both.getSize(new THREE.Vector3()).length();
    }
    const lens = Math.min(1, this.camera.aspect || 1) * Math.tan((Math.PI / 360) * this.camera.fov);
    const far = (radius / lens) * (whole ? 0.92 : 1.15);
    this.camera.position.copy(this.target).addScaledVector(way, far);
    this.camera.near = far / 200;
    this.camera.far = far * 30 + 10 * cell.getSize(new THREE.Vector3()).length();
    this.camera.updateProjectionMatrix();
    this.dirty = true;
    this.shareCamera();
  }

  // Turn with the left button, move with the right, zoom with the wheel; Z stays up.
  buildControls() {
    const canvas = this.renderer.domElement, pointers = new Map();
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, event);
    });
    const release = (event) => pointers.delete(event.pointerId);
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
      if (pointers.size === 2) {
        const other = [...pointers.values()].find((p) => p.pointerId !== event.pointerId);
        const apart = (p) => Math.hypot(p.clientX - other.clientX, p.clientY - other.clientY);
        this.zoom(apart(before) / Math.max(apart(event), 1));
        this.pan(dx / 2, dy / 2);
      } else if (event.buttons & 2 || event.buttons & 4 || event.shiftKey) this.pan(dx, dy);
      else this.turn(dx, dy);
      pointers.set(event.pointerId, event);
    });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-60, Math.min(60, event.deltaY * (event.deltaMode ? 30 : 1))) * 0.0022));
    }, { passive: false });
    const tools = this.box.appendChild(G.make("div", "tools"));
    for (const name of ["part", "cell", "top", "front", "side"]) {
      tools.appendChild(G.make("button", "", name)).onclick = () => this.look(name);
    }
    tools.appendChild(G.make("i"));
    for (const [name, text] of [["path", "path"], ["stock", "stock"], ["cell", "machine"], ["force", "force"]]) {
      const button = tools.appendChild(G.make("button", "on", text));
      button.onclick = () => {
        this.shown[name] = button.classList.toggle("on");
        if (name === "cell") for (const body of this.bodies) body.visible = this.shown.cell;
        if (name === "stock") this.showStock();
        this.show(G.time);
      };
    }
    const follow = tools.appendChild(G.make("button", "", "follow tool"));
    follow.onclick = () => { this.follow = follow.classList.toggle("on"); this.show(G.time); };
  }

  turn(dx, dy) {
    const way = this.camera.position.clone().sub(this.target), ball = new THREE.Spherical();
    const up = new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(0, 1, 0));
    ball.setFromVector3(way.applyQuaternion(up));
    ball.theta -= dx * 0.006;
    ball.phi = Math.min(Math.max(ball.phi - dy * 0.006, 0.002), Math.PI - 0.002);
    way.setFromSpherical(ball).applyQuaternion(up.invert());
    this.camera.position.copy(this.target).add(way);
    this.dirty = true;
    this.shareCamera();
  }

  pan(dx, dy) {
    const far = this.camera.position.distanceTo(this.target);
    const unit = (2 * far * Math.tan((Math.PI / 360) * this.camera.fov)) / this.box.clientHeight;
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 0), up = new THREE.Vector3().setFromMatrixColumn(this.camera.matrix, 1);
    const shift = right.multiplyScalar(-dx * unit).addScaledVector(up, dy * unit);
    this.camera.position.add(shift);
    this.target.add(shift);
    this.dirty = true;
    this.shareCamera();
  }

  zoom(factor) {
    this.camera.position.sub(this.target).multiplyScalar(factor).add(this.target);
    const far = this.camera.position.distanceTo(this.target);
    this.camera.near = far / 200;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
    this.shareCamera();
  }

  // Two runs are looked at from the same side.
  shareCamera() {
    for (const view of G.views || []) {
      if (view === this || !view.renderer) continue;
      view.camera.position.copy(this.camera.position);
      view.camera.near = this.camera.near;
      view.camera.far = this.camera.far;
      view.camera.updateProjectionMatrix();
      view.target.copy(this.target);
      view.dirty = true;
    }
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  render() {
    if (!this.renderer || !this.dirty) return;
    this.dirty = false;
    this.camera.lookAt(this.target);
    this.camera.updateMatrixWorld();
    this.headlight.position.copy(this.camera.position);
    this.headlight.target.position.copy(this.target);
    this.headlight.target.updateMatrixWorld();
    this.renderer.render(this.scene, this.camera);
  }
};
