// What stands around the stage: heading, strip of the index, panel of switches.
Object.assign(DA.Player.prototype, {
  heading() {
    const n = DA.h;
    return n("header", { class: "heading" }, n("h1", {}, this.options.title || document.title), this.readout);
  },

  // All runs if they are few, else those on the stage: forty curves cannot be told apart anyway.
  buildStrip() {
    const { head } = this, few = head.runs.length <= 8;
    const draw = () => {
      const shown = few ? head.runs.map((_, k) => k) : this.shown;
      const h = head.array(this.run.index).length;
      this.chart.spec = {
        title: "Index along the path", bare: true, zero: true, x: { values: Array.from({ length: h }, (_, i) => i) },
        series: shown.map((k) => ({ name: head.runs[k].label, values: Array.from(head.array(head.runs[k].index)), colour: DA.colour(k), dash: "" })),
      };
      this.chart.choose(shown.indexOf(this.active));
    };
    this.shown = [0];
    this.chart = new DA.Chart(this.strip, { title: "", bare: true, x: { values: [0, 1] }, series: [] }, (t) => { this.pause(); this.seek(t); });
    this.on("time", () => this.chart.move(this.t));
    this.on("shown", draw);
  },

  buildPanel() {
    const n = DA.h, { head } = this;
    const box = (name, text, hint) => n("label", { class: "switch", title: hint }, n("input", { type: "checkbox", "data-show": name, checked: this.show[name], onchange: (e) => this.toggleShow(name, e.target.checked) }), n("span", {}, text));
    const rows = head.runs.map((run, k) => {
      const values = Array.from(head.array(run.index)), mean = values.reduce((a, b) => a + b, 0) / values.length;
      return n("li", { "data-run": k },
        n("label", {}, n("input", { type: "radio", name: "run", checked: k === 0, onchange: () => this.select(k) }), n("i", { style: `background:${DA.colour(k)}` }), n("span", { class: "name" }, run.label), n("small", { title: "mean index" }, DA.number(mean))),
        head.runs.length > 1 ? n("input", { type: "checkbox", class: "with", title: "show together with the selected one", checked: k === 0, onchange: (e) => this.compare(k, e.target.checked) }) : null);
    });
    const modes = head.runs.length < 2 ? null : n("div", { class: "modes", role: "group", "aria-label": "Comparison" },
      ["one", "overlay", "side"].map((m) => n("button", { type: "button", "data-mode": m, onclick: () => this.layout(m) }, { one: "One", overlay: "Overlay", side: "Side by side" }[m])));
    const views = n("div", { class: "modes", role: "group", "aria-label": "Camera" },
      ["corner", "front", "side", "top", "close"].map((v) => n("button", { type: "button", onclick: () => this.look(v) }, v)));
    const panel = n("details", { class: "panel", open: this.element.classList.contains("whole") && window.innerWidth > 760 },
      n("summary", { title: "Show or hide this panel" }, "View"),
      n("h2", {}, "Runs"), n("ol", { class: "runs" }, rows), modes,
      n("h2", {}, "Show"),
      n("div", { class: "switches" },
        box("visual", "robots"), box("collision", "collision shapes"), box("path", "path, coloured by index"), box("frames", "tip frames"),
        box("direction", "direction u", "the direction in which the index counts"),
        box("force", "force ellipsoid", "inverse of J_r J_r^T, linear part: forces that unit joint torques balance"),
        box("velocity", "velocity ellipsoid", "J_r J_r^T, linear part: speeds that unit joint speeds reach"),
        head.runs.some((run) => run.near) ? box("distance", "nearest bodies", "the two bodies that are nearest; magenta where they are nearer than what is asked for") : null,
        box("ghosts", "first (blue), last (orange)"), box("traces", "traces of both tips", "where the tips go in the world: e1 blue, e2 orange"), box("hold", "hold e1 still", "ride on the first tool: the motion as e1 sees it")),
      this.scaleNote = n("p", { class: "note", hidden: true }),
      n("h2", {}, "Camera"), views,
      n("div", { class: "modes" }, n("button", { type: "button", onclick: () => DA.theme() }, "light / dark"), n("button", { type: "button", onclick: () => this.picture() }, "save picture")));
    return panel;
  },

  mark() {
    this.playButton.textContent = this.playing ? "❚❚" : "▶";
    this.playButton.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    for (const b of this.panel.querySelectorAll("[data-mode]")) b.setAttribute("aria-pressed", String(b.dataset.mode === this.mode));
    for (const li of this.panel.querySelectorAll("[data-run]")) {
      const k = Number(li.dataset.run), together = li.querySelector(".with");
      li.classList.toggle("active", k === this.active);
      li.querySelector("[type=radio]").checked = k === this.active;
      if (together) Object.assign(together, { checked: this.chosen.has(k) || k === this.active, hidden: this.mode === "one" });
    }
  },
});
