// The player: stage and clock. Everything that changes goes through `seek` and `refresh`; what
// stands around the stage is in panel.js.
DA.Player = class {
  constructor(element, head, options = {}) {
    Object.assign(this, { element, head, options });
    this.t = 0;
    this.speed = 1;
    this.seconds = 8; // for the whole path at speed 1
    this.playing = false;
    this.listeners = { time: [], run: [], shown: [] };
    this.active = 0;
    this.chosen = new Set([0]);
    this.mode = "one";
    this.show = { visual: true, collision: false, path: true, frames: true, force: false, velocity: false, direction: true, ghosts: false, traces: false, hold: false, distance: true };
    this.views = new Map();
    this.sayLess = DA.seldom(() => this.say(), () => this.stage.words());
    this.build();
    this.start();
    this.refresh();
    this.seek(0);
  }

  on(event, f) {
    this.listeners[event].push(f);
  }

  tell(event) {
    for (const f of this.listeners[event]) f(this);
  }

  get run() {
    return this.head.runs[this.active];
  }

  // ---- the page around the stage
  build() {
    const n = DA.h, { head } = this;
    this.canvas = n("div", { class: "canvas" });
    this.tiles = n("div", { class: "tiles" });
    this.readout = n("output", { class: "readout" });
    this.panel = this.buildPanel();
    const stage = n("section", { class: "stage", "aria-label": "The two arms" }, this.canvas, this.tiles, this.heading(), this.panel);
    this.playButton = n("button", { class: "play", type: "button", onclick: () => this.toggle() });
    this.scrub = n("input", { type: "range", class: "scrub", min: 0, max: 1, step: "any", value: 0, "aria-label": "Place on the path", oninput: () => { this.pause(); this.seek(Number(this.scrub.value)); } });
    this.strip = n("div", { class: "strip" });
    const speeds = [0.1, 0.25, 0.5, 1, 2, 4].map((s) => n("option", { value: s, selected: s === 1 }, `${s}×`));
    const speed = n("select", { class: "speed", "aria-label": "Speed", onchange: (e) => (this.speed = Number(e.target.value)) }, speeds);
    const bar = n("footer", { class: "bar" }, this.playButton, n("div", { class: "track" }, this.options.strip === false ? null : this.strip, this.scrub), speed);
    this.element.append(stage, bar);
    document.addEventListener("keydown", (e) => {
      if (e.target.matches("input, select, textarea, summary")) return;
      const step = 1 / Math.max(1, this.views.get(`${this.active}/`).h - 1);
      const act = { " ": () => this.toggle(), ArrowRight: () => this.seek(this.t + step), ArrowLeft: () => this.seek(this.t - step), Home: () => this.seek(0), End: () => this.seek(1) }[e.key];
      if (!act || (e.key === " " && e.target.matches("button"))) return;
      e.preventDefault();
      if (e.key !== " ") this.pause();
      act();
    });
    if (this.options.strip !== false) this.buildStrip();
    this.mark();
  }

  // ---- the stage
  start() {
    const { head } = this;
    head.materials = new Map();
    head.geometries = head.meshes.map((mesh) => DA.geometry(head, mesh));
    this.stage = new DA.Stage(this.canvas);
    if (this.stage.software) head.geometries.forEach(DA.rough);
    this.stage.viewer.render = () => this.render();
    this.stage.resized = () => this.place();
    this.frameCell();
    const loop = (now) => {
      const passed = Math.min(now - (this.last ?? now), 250);
      this.last = now;
      if (this.playing) this.advance(passed);
      requestAnimationFrame(loop);
    };
    requestAnimationFrame(loop);
  }

  // Room for the whole motion of the selected run: first, middle and last posture.
  frameCell() {
    const T = MeshCat.THREE, { head } = this, box = new T.Box3(), cell = head.cells[this.run.cell];
    const q = head.array(this.run.q), n = cell.columns.length, robot = new DA.Robot(head, cell, {});
    for (const t of [0, 0.5, 1]) {
      robot.pose(DA.between(q, n, t * (q.length / n - 1)));
      box.expandByObject(robot.root);
      for (const tip of ["e1", "e2"]) box.expandByPoint(new T.Vector3().setFromMatrixPosition(robot.frames.get(tip).matrixWorld));
    }
    const base = (tip) => {
      let j = cell[tip].joint, last = j;
      for (; j > 0; j = cell.joints[j - 1].joint) last = j;
      return last ? new T.Vector3().setFromMatrixPosition(robot.joints[last - 1].matrixWorld) : new T.Vector3();
    };
    const first = base("e1"), across = base("e2").sub(first);
    this.framed = this.run.cell;
    this.reach = 0.5 * box.getSize(new T.Vector3()).length();
    this.stage.frame(box, across.length() > 1e-3 ? across : new T.Vector3(1, 0, 0));
  }

  range() {
    let low = Infinity, high = -Infinity;
    for (const run of this.head.runs) for (const v of this.head.array(run.index)) if (Number.isFinite(v)) [low, high] = [Math.min(low, v), Math.max(high, v)];
    return low < high ? [low, high] : [low - 1, low + 1];
  }

  view(k, tint) {
    const key = `${k}/${tint || ""}`;
    if (!this.views.has(key)) {
      const view = new DA.View(this.head, k, this.reach, this.range(), tint);
      this.views.set(key, view);
      this.stage.world.add(view.group);
    }
    return this.views.get(key);
  }

  // Choose what stands on the stage; called when run, comparison or switches change.
  refresh() {
    if (this.framed !== this.run.cell) this.frameCell();
    const others = this.mode === "one" ? [] : [...this.chosen].filter((k) => k !== this.active && this.head.runs[k].cell === this.run.cell).slice(0, 8);
    const main = this.view(this.active);
    this.on_stage = [main, ...others.map((k) => this.view(k, this.mode === "overlay" ? DA.colour(k) : undefined))];
    this.shown = [this.active, ...others];
    for (const view of this.views.values()) view.group.visible = this.on_stage.includes(view);
    this.scale = this.scales();
    this.place();
    this.mark();
    this.tell("shown");
    this.seek(this.t);
  }

  // The same scale for every run on the stage, so that sizes can be compared.
  scales() {
    if (!this.show.force && !this.show.velocity) return null;
    const wide = [], thin = [];
    for (const view of this.on_stage) for (let i = 0; i <= 6; i++) {
      const width = view.widths(i / 6);
      wide.push(Math.max(...width));
      thin.push(1 / Math.max(Math.min(...width), 1e-3));
    }
    const middle = (list) => list.sort((a, b) => a - b)[Math.floor(list.length / 2)];
    const size = 0.24 * this.reach, scale = { velocity: size / middle(wide), force: size / middle(thin) };
    this.scaleNote.textContent = `Drawn: velocity 1 m per unit of q as ${DA.number(scale.velocity)} m; force 1/m as ${DA.number(scale.force)} m.`;
    return scale;
  }

  // Tiles of the stage, each with its camera shape: one, or one per run side by side.
  place() {
    const w = this.canvas.clientWidth, h = this.canvas.clientHeight, count = this.mode === "side" ? this.on_stage.length : 1;
    if (!w || !h || !this.on_stage) return;
    let columns = 1;
    while (columns < count && (w / columns) / (h / Math.ceil(count / columns)) > 1.25) columns++;
    const rows = Math.ceil(count / columns), before = this.aspect;
    this.grid = Array.from({ length: count }, (_, k) => ({ x: ((k % columns) * w) / columns, y: h - ((Math.floor(k / columns) + 1) * h) / rows, w: w / columns, h: h / rows }));
    this.aspect = w / columns / (h / rows);
    this.tiles.replaceChildren(...(count < 2 ? [] : this.grid.map((g, k) => DA.h("span", { class: "tile", style: `left:${g.x}px;bottom:${g.y}px;width:${g.w}px;height:${g.h}px` }, DA.h("b", {}, DA.h("i", { style: `background:${DA.colour(this.shown[k])}` }), this.head.runs[this.shown[k]].label)))));
    if (before !== this.aspect) {
      this.stage.viewer.camera.aspect = this.aspect;
      // Whoever has turned the view keeps it, unless the number of tiles changes.
      if (!this.stage.turned || this.count !== count) this.stage.look(this.camera || "corner", this.tip());
    }
    this.count = count;
    this.stage.moved();
  }

  render() {
    const { viewer } = this.stage, { renderer, camera, scene } = viewer, g = this.grid;
    viewer.needs_render = false;
    this.stage.drawn = performance.now();
    viewer.controls.update();
    camera.aspect = this.aspect || camera.aspect;
    camera.updateProjectionMatrix();
    if (!g || g.length < 2) {
      renderer.setScissorTest(false);
      renderer.setViewport(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
      renderer.render(scene, camera);
    } else {
      renderer.setScissorTest(true);
      g.forEach((tile, k) => {
        this.on_stage.forEach((view, j) => (view.group.visible = j === k));
        renderer.setViewport(tile.x, tile.y, tile.w, tile.h);
        renderer.setScissor(tile.x, tile.y, tile.w, tile.h);
        renderer.render(scene, camera);
      });
      for (const view of this.on_stage) view.group.visible = true;
    }
    this.frames = (this.frames || 0) + 1;
  }

  // ---- what users, charts and tests call
  seek(t) {
    this.t = Math.min(Math.max(Number(t) || 0, 0), 1);
    for (const view of this.on_stage) view.update(this.t, this.show, this.scale || { velocity: 0, force: 0 });
    if (document.activeElement !== this.scrub || Number(this.scrub.value) !== this.t) this.scrub.value = this.t;
    if (this.stage.held) this.sayLess();
    else this.sayLess.now();
    this.stage.moved();
    this.tell("time");
  }

  say() {
    const view = this.on_stage[0], at = this.t * (view.h - 1), s = this.head.array(view.path.arc_length);
    const items = [["index", DA.number(DA.between(view.index, 1, at)[0])], ["point", `${(at + 1).toFixed(1)} / ${view.h}`], ["arc length", `${DA.between(s, 1, at)[0].toFixed(3)} m`]];
    if (view.nearest) {
      const near = view.nearest.at(this.t);
      items.push(["nearest", `${near.value.toFixed(3)} m`]);
      this.readout.title = near.pair.names.join(" – ");
    }
    const motion = this.run.motion;
    if (motion) items.push(["time", `${this.secondsAt(this.t).toFixed(3)} / ${motion.duration.toFixed(3)} s`], ["held back by", motion.held_by[Math.round(at)]]);
    this.readout.replaceChildren(DA.h("b", {}, DA.h("i", { style: `background:${DA.colour(this.active)}` }), this.run.label), ...items.map(([k, v]) => DA.h("span", {}, `${k} `, DA.h("em", {}, v))));
  }

  // Seconds of the motion at place t, and the place after so many seconds: real time.
  secondsAt(t) {
    const time = this.head.array(this.run.motion.time);
    return DA.between(time, 1, t * (time.length - 1))[0];
  }

  placeAt(seconds) {
    const time = this.head.array(this.run.motion.time), last = time.length - 1;
    let k = 0;
    while (k < last - 1 && time[k + 1] < seconds) k++;
    const step = time[k + 1] - time[k];
    return (k + (step > 0 ? Math.min((seconds - time[k]) / step, 1) : 1)) / last;
  }

  advance(passed) {
    const ahead = (passed / 1000) * this.speed;
    let t = this.t + ahead / this.seconds;
    // A place that many points share in time is passed by at least a little.
    if (this.run.motion) t = Math.max(this.placeAt(this.secondsAt(this.t) + ahead), this.t + 1e-9);
    this.seek(t >= 1 ? 1 : t);
    if (t >= 1) this.pause();
    this.slow = 0.9 * (this.slow ?? 30) + 0.1 * passed;
    // A weak machine keeps its frame rate and gives up detail until the motion rests.
    if (this.slow > 70) this.stage.thrifty = true;
    if (this.slow > 90) this.stage.coarse = true;
  }

  play() {
    if (this.t >= 1) this.seek(0);
    this.playing = true;
    this.mark();
  }

  pause() {
    this.playing = false;
    this.mark();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  select(k) {
    if (!(k in this.head.runs)) throw new Error(`no run ${k}; there are ${this.head.runs.length}`);
    this.active = k;
    this.refresh();
    this.tell("run");
  }

  compare(k, on) {
    if (on) this.chosen.add(k);
    else this.chosen.delete(k);
    this.refresh();
  }

  layout(mode) {
    this.mode = mode;
    if (mode !== "one" && this.chosen.size < 2) this.head.runs.slice(0, 4).forEach((_, k) => this.chosen.add(k));
    this.refresh();
  }

  toggleShow(name, on) {
    if (!(name in this.show)) throw new Error(`no switch ${name}; known: ${Object.keys(this.show).join(", ")}`);
    this.show[name] = on;
    const box = this.panel.querySelector(`[data-show=${name}]`);
    if (box) box.checked = on;
    this.scaleNote.hidden = !this.show.force && !this.show.velocity;
    this.refresh();
  }

  tip() {
    const T = MeshCat.THREE, p = this.on_stage[0].robot.linkPose("e2").position;
    return new T.Vector3(...p);
  }

  look(view) {
    this.camera = view;
    this.stage.look(view, this.tip());
  }

  picture() {
    this.stage.quality(true);
    this.render();
    const link = DA.h("a", { download: "dualarm.png", href: this.stage.viewer.renderer.domElement.toDataURL("image/png") });
    link.click();
  }
};

DA.theme = function (name) {
  const root = document.documentElement;
  const dark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  root.dataset.theme = name || (dark ? "light" : "dark");
};
