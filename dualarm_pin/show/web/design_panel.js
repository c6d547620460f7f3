// What stands beside the picture on the design page: what can be changed, and what it does.
DA.said = function (name, value) {
  const label = name.replace("base2.", "base 2 ").replace("workpiece.", "workpiece ").replace("tool2.length", "tool 2 longer by");
  return `${label} ${name.endsWith("yaw") ? `${((value * 180) / Math.PI).toFixed(1)}°` : `${value.toFixed(3)} m`}`;
};

Object.assign(DA.Design.prototype, {
  build() {
    const n = DA.h, { player, task } = this;
    player.panel.open = false;
    this.desk = document.getElementById("desk");
    this.status = n("p", { class: "state", role: "status" });
    this.objective = n("p", { class: "objective" });
    this.basin = n("p", { class: "note" });
    this.near = n("p", { class: "near" });
    this.slopes = n("p", { class: "note" });
    this.evidence = n("details", { class: "evidence" }, n("summary", {}, "Evidence"), n("p", { class: "note" }));
    this.chartBox = n("div", { class: "chart" });
    this.bars = n("div", { class: "ranges" });
    this.list = n("ol", { class: "variants" });
    this.undoButton = n("button", { type: "button", onclick: () => this.undo(), title: "Ctrl+Z" }, "Undo");
    this.redoButton = n("button", { type: "button", onclick: () => this.redo(), title: "Ctrl+Shift+Z or Ctrl+Y" }, "Redo");
    this.keepButton = n("button", { type: "button", onclick: () => this.keep() }, "Keep");
    this.saveButton = n("button", { type: "button", onclick: () => this.save() }, "Save");
    this.name = n("input", { type: "text", maxlength: 60, value: "variant 1", "aria-label": "Name of the variant" });
    this.saved = n("p", { class: "note" });
    const part = (title, ...inside) => n("section", {}, n("h2", {}, title), ...inside);
    this.desk.append(
      this.status, this.objective, this.basin, this.evidence,
      n("div", { class: "modes" }, this.undoButton, this.redoButton, this.saveButton), this.saved,
      part("Place", this.buildPlace()),
      part("Asked", ...this.buildAsked()),
      part("Index along the path", this.chartBox, n("p", { class: "note" }, n("i", { style: `background:${DA.colour(0)}` }), "now ", n("i", { style: `background:${DA.colour(6)}` }), "at the start")),
      ...(task.distances ? [part("Nearest bodies", this.near)] : []),
      part("Joint ranges used", this.bars),
      ...(this.has("base2") ? [part("Slope at base 2", this.slopes)] : []),
      part("Variants", n("div", { class: "keep" }, this.name, this.keepButton), this.list));
    const values = (array) => Array.from(array);
    this.chart = new DA.Chart(this.chartBox, {
      title: "Index along the path", small: true, zero: true, x: { values: values(this.start.index.map((_, i) => i + 1)), whole: true },
      series: [{ name: "now", values: values(this.start.index), colour: DA.colour(0), dash: "" }, { name: "at the start", values: values(this.start.index), colour: DA.colour(6), dash: "9 4" }],
    }, (t) => { player.pause(); player.seek(t); });
    this.chart.choose(0);
    player.on("time", () => this.chart.move(player.t));
    this.buildRanges();
    this.arrows = {};
    for (const axis of ["x", "y", "z"]) {
      this.arrows[axis] = DA.arrow(player.reach * 0.14, "#CC79A7");
      this.arrows[axis].visible = false;
      this.view.group.add(this.arrows[axis]);
    }
  },

  buildPlace() {
    const n = DA.h, box = n("div", { class: "place" });
    const choose = n("div", { class: "modes", role: "group", "aria-label": "What is moved" },
      [["base2", "Base 2"], ["workpiece", "Workpiece"]].filter(([group]) => this.has(group)).map(([group, text]) => n("button", { type: "button", "data-target": group, onclick: () => this.choose(group) }, text)));
    this.fields = {};
    for (const axis of ["x", "y", "z", "yaw"]) {
      const input = (this.fields[axis] = n("input", { type: "number", step: axis === "yaw" ? 1 : 0.01, "data-axis": axis }));
      input.addEventListener("input", () => {
        const name = `${this.target}.${axis}`, value = input.valueAsNumber * (axis === "yaw" ? Math.PI / 180 : 1);
        if (Number.isFinite(value) && name in this.state.change) this.set({ [name]: value - this.standing(name) });
      });
      input.addEventListener("change", () => this.commit());
      box.append(n("label", { "data-field": axis }, n("span", {}, axis === "yaw" ? "yaw°" : `${axis} [m]`), input));
    }
    return n("div", {}, choose, box);
  },

  // A slider with its value in words: get() and put(v) in the units of the slider.
  slider(text, [low, high, step], get, put, said) {
    const n = DA.h, out = n("output", {}), input = n("input", { type: "range", min: low, max: high, step, "aria-label": text });
    const row = n("label", { class: "slider" }, n("span", {}, text), input, out);
    const update = () => {
      if (document.activeElement !== input || Math.abs(Number(input.value) - get()) > step) input.value = get();
      out.textContent = said(get());
      input.setAttribute("aria-valuetext", out.textContent);
    };
    input.addEventListener("input", () => { this.begin(); put(Number(input.value)); this.follow(); });
    input.addEventListener("change", () => this.commit());
    this.updates.push(update);
    return row;
  },

  buildAsked() {
    const n = DA.h, { state, task } = this, rows = [];
    this.updates = [];
    const least = task.smoothness > 0 ? Math.log10(task.smoothness) - 2 : -2;
    rows.push(this.slider("λ", [least, least + 4, 0.01], () => (this.state.smoothness > 0 ? Math.log10(this.state.smoothness) : least), (v) => (this.state.smoothness = 10 ** v), () => DA.number(this.state.smoothness)));
    if (task.distances) {
      const given = task.clearance === null ? "off" : `${task.clearance} m`;
      rows.push(this.slider("clearance", [0, 0.3, 0.005], () => this.state.clearance ?? task.clearance ?? 0, (v) => (this.state.clearance = v), () => (this.state.clearance === null ? `${given}, as in the task` : `${this.state.clearance.toFixed(3)} m`)));
    }
    if ("tool2.length" in state.change) rows.push(this.slider("tool 2 longer", [-0.3, 0.5, 0.005], () => this.state.change["tool2.length"], (v) => (this.state.change["tool2.length"] = v), (v) => `${v.toFixed(3)} m`));
    const columns = this.view.cell.columns;
    this.joint = n("select", { "aria-label": "Joint whose limits are changed", onchange: () => this.chooseJoint() }, columns.map((column, k) => n("option", { value: k }, column.name)));
    this.limits = n("div", {});
    rows.push(n("label", { class: "slider" }, n("span", {}, "limits of"), this.joint), this.limits);
    this.fixedUpdates = this.updates.length;
    this.chooseJoint();
    return rows;
  },

  limitsOf(k) {
    const column = this.view.cell.columns[k];
    return this.state.limits[column.name] || [column.lower, column.upper];
  },

  chooseJoint() {
    const k = Number(this.joint.value), column = this.view.cell.columns[k], turns = column.kind === "revolute";
    const room = Math.min(0.5 * (column.upper - column.lower), turns ? 1.5 : 0.5), gap = 0.02 * (column.upper - column.lower);
    const said = (v) => (turns ? `${((v * 180) / Math.PI).toFixed(1)}°` : `${v.toFixed(3)} m`);
    const scale = [column.lower - room, column.upper + room, (column.upper - column.lower) / 400];
    const put = (side) => (v) => {
      const both = [...this.limitsOf(k)];
      both[side] = side ? Math.max(v, both[0] + gap) : Math.min(v, both[1] - gap);
      this.state.limits[column.name] = both;
    };
    this.updates.length = this.fixedUpdates;
    this.limits.replaceChildren(
      this.slider("lower", scale, () => this.limitsOf(k)[0], put(0), said),
      this.slider("upper", scale, () => this.limitsOf(k)[1], put(1), said));
    for (const update of this.updates) update();
  },

  buildRanges() {
    const n = DA.h;
    this.rows = this.view.cell.columns.map((column) => {
      const used = n("b", {}), track = n("span", { class: "range" }, used), text = n("small", {});
      this.bars.append(n("div", { "data-joint": column.name }, n("span", { class: "name" }, column.name), track, text));
      return { used, text };
    });
  },

  // How things stand: after every change, while something is dragged a few times a second.
  mark() {
    if (this.gizmo.held) this.markLess();
    else this.markLess.now();
  },

  markNow() {
    for (const button of this.desk.querySelectorAll("[data-target]")) button.setAttribute("aria-pressed", String(button.dataset.target === this.target));
    for (const [axis, input] of Object.entries(this.fields)) {
      const name = `${this.target}.${axis}`, there = name in this.state.change;
      input.closest("label").hidden = !there;
      const value = (this.standing(name) + (this.state.change[name] || 0)) * (axis === "yaw" ? 180 / Math.PI : 1);
      // What is being typed is left alone.
      if (document.activeElement !== input || Math.abs(input.valueAsNumber - value) > 1e-3) input.value = value.toFixed(axis === "yaw" ? 1 : 3);
    }
    for (const update of this.updates) update();
    this.undoButton.disabled = !this.history.length;
    this.redoButton.disabled = !this.future.length;
  },

  // What came back, in the panels; the same. (`before` is set from begin to commit.)
  tell() {
    if (this.before && !this.broken) this.tellLess();
    else this.tellLess.now();
  },

  tellNow() {
    const { shown, start } = this, n = DA.h;
    if (this.broken || !shown) {
      this.status.textContent = this.broken || "…";
      this.status.dataset.kind = "bad";
      return;
    }
    const { found } = shown, sure = Boolean(found && found.found && shown.valid), short = shown.near && shown.near.lacking;
    this.status.dataset.kind = sure ? "found" : shown.valid ? "follows" : "bad";
    this.status.textContent = sure ? `Found and checked${shown.searching ? "; still searching" : ""}` : shown.valid ? `Best motion known${short ? ", nearer than required" : ""}${this.drawing.behind > 3 ? ", falls behind what is moved" : ""}; ${shown.searching ? "searching" : "not searched here"}` : `No motion here${shown.searching ? " yet" : ""}: ${shown.why}. Grey: the last valid motion.`;
    const by = shown.objective - start.objective, share = (100 * by) / Math.abs(start.objective || 1);
    const sign = (v, digits) => `${Number(v.toFixed(digits)) < 0 ? "−" : "+"}${Math.abs(v).toFixed(digits)}`;
    this.objective.replaceChildren(n("b", {}, shown.valid ? shown.objective.toFixed(4) : "–"), n("span", {}, shown.valid ? ` objective; ${sign(by, 4)} (${sign(share, 1)} %) since the start` : " objective"));
    this.basin.textContent = shown.valid ? `Way of moving no. ${shown.basin} of ${shown.pool.length} followed${this.changed ? `, since ${this.changed}` : ""}.` + (shown.pool.length > 1 ? ` Next best: ${shown.pool.slice(1, 4).map((v) => v.toFixed(3)).join(", ")}.` : "") : "";
    this.evidence.hidden = !found;
    if (found) this.evidence.lastChild.textContent = [found.message, found.sentences].filter(Boolean).join("\n");
    if (shown.near) {
      const { names, distance, point, required } = shown.near;
      this.near.textContent = `${distance.toFixed(3)} m at point ${point}: ${names.join(" – ")}; ${required === null ? "no distance is asked for" : `required ${required.toFixed(3)} m`}${short ? (distance < 0 ? "; they collide" : "; too near") : ""}`;
      this.near.classList.toggle("short", Boolean(short));
    } else this.near.textContent = "–";
    this.tellSlopes(sure ? found.slopes : null);
    if (this.before) this.figuresLess();
    else this.figuresLess.now();
    this.saveButton.disabled = !sure;
    this.saveButton.title = sure ? `Writes cell, task and result into ${this.task.folder}` : "When the search has found a motion here";
    this.keepButton.disabled = !shown.valid;
  },

  tellFigures() {
    this.chart.spec.series[0].values = this.shown.valid ? Array.from(this.view.index) : [];
    this.chart.draw();
    this.tellRanges();
  },

  tellRanges() {
    const { cell, q } = this.view, width = cell.columns.length;
    cell.columns.forEach((column, k) => {
      let low = Infinity, high = -Infinity;
      for (let i = k; i < q.length; i += width) [low, high] = [Math.min(low, q[i]), Math.max(high, q[i])];
      const [from, to] = this.limitsOf(k), at = (v) => Math.min(Math.max((100 * (v - from)) / (to - from), 0), 100);
      const held = low - from < 1e-3 * (to - from) || to - high < 1e-3 * (to - from), unit = column.kind === "revolute" ? 180 / Math.PI : 1;
      const { used, text } = this.rows[k];
      used.style.left = `${at(low)}%`;
      used.style.width = `${Math.max(at(high) - at(low), 1.5)}%`;
      used.classList.toggle("held", held);
      text.textContent = `${DA.number(low * unit)} … ${DA.number(high * unit)}${unit > 1 ? "°" : " m"}`;
    });
  },

  // Arrows toward where the objective falls, as long as it falls fast.
  tellSlopes(slopes) {
    const T = MeshCat.THREE, most = slopes ? Math.max(...["x", "y", "z"].map((axis) => Math.abs(slopes[`base2.${axis}`]))) : 0;
    for (const [k, axis] of ["x", "y", "z"].entries()) {
      const arrow = this.arrows[axis], slope = slopes ? slopes[`base2.${axis}`] : 0, share = Math.abs(slope) / (most || 1);
      arrow.visible = share > 0.02 && most > 1e-6;
      if (!arrow.visible) continue;
      const toward = new T.Vector3().setComponent(k, -Math.sign(slope));
      arrow.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), toward);
      arrow.scale.setScalar(0.4 + 0.6 * share);
      const at = ["x", "y", "z"].map((a) => this.standing(`base2.${a}`) + this.state.change[`base2.${a}`]);
      arrow.position.set(...at).addScaledVector(toward, this.gizmo.size * 1.08);
    }
    this.slopes.textContent = slopes ? `Objective for +1 mm: ${["x", "y", "z"].map((a) => `${a} ${DA.number(slopes[`base2.${a}`] / 1000)}`).join(", ")}; for +1 mrad: yaw ${DA.number(slopes["base2.yaw"] / 1000)}. Pink arrows: where it falls.` : this.shown.searching ? "…" : "Not known here: clearance holds the motion, or nothing is found.";
    this.player.stage.moved();
  },

  // ---- variants and files
  keep() {
    const { shown } = this, name = this.name.value.trim() || `variant ${this.variants.length + 1}`;
    this.variants.push({ name, state: structuredClone(this.state), motion: this.motion, objective: shown.objective, found: Boolean(shown.found && shown.found.found) });
    this.name.value = `variant ${this.variants.length + 1}`;
    this.tellVariants();
  },

  tellVariants() {
    const n = DA.h;
    this.list.replaceChildren(...this.variants.map((variant) => n("li", {},
      n("span", { class: "name", title: this.where(variant.state) }, variant.name),
      n("small", { title: variant.found ? "found and checked" : "the best known when it was kept" }, `${variant.objective.toFixed(4)}${variant.found ? "" : " ?"}`),
      n("button", { type: "button", onclick: () => { this.begin(); this.past(this.before); this.restore(variant); } }, "Restore"),
      n("button", { type: "button", "aria-label": `Forget ${variant.name}`, onclick: () => { this.variants.splice(this.variants.indexOf(variant), 1); this.tellVariants(); } }, "×"))));
  },

  async save() {
    try {
      const bytes = await this.post("/save", {});
      this.saved.textContent = `Saved into ${JSON.parse(new TextDecoder().decode(bytes)).saved}`;
    } catch (error) {
      this.saved.textContent = error.message;
    }
  },
});
