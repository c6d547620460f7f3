// The report beside the player: plots that follow the motion and lead it, tables of text.
DA.report = function (player, head) {
  const n = DA.h, host = document.getElementById("pages"), many = head.runs.length > 1;
  const lengths = new Set(head.runs.map((run) => run.index.shape[0]));
  let charts = [], along = "point";
  const seek = (t) => {
    player.pause();
    player.seek(t);
  };

  // What the horizontal axis says; runs of different length meet only as a share of the path.
  const axis = () => {
    const s = Array.from(head.array(head.paths[player.run.path].arc_length)), h = s.length;
    if (lengths.size > 1) return { label: "share of the path [%]", values: [0, 100] };
    if (along === "time" && player.run.motion) return { label: many ? `time of ${player.run.label} [s]` : "time [s]", values: Array.from(head.array(player.run.motion.time)) };
    if (along === "arc" && s[h - 1] > 0) return { label: "arc length [m]", values: s };
    return { label: "path point", whole: true, values: s.map((_, i) => i + 1) };
  };

  const series = (values) => head.runs.map((run, k) => ({ run: k, name: run.label, values: values(run), colour: DA.colour(k), dash: DA.dashes[k % 7] })).filter((s) => s.values);
  const stored = (key) => (run) => (run[key] ? Array.from(head.array(run[key])) : null);
  const degrees = (run, k) => (head.cells[run.cell].columns[k].kind === "revolute" ? 180 / Math.PI : 1);
  const column = (run, k) => {
    const q = head.array(run.q), width = run.q.shape[1];
    return Array.from({ length: run.q.shape[0] }, (_, i) => q[i * width + k] * degrees(run, k));
  };
  const steps = (run) => {
    const turning = head.cells[run.cell].columns.map((c, k) => k).filter((k) => head.cells[run.cell].columns[k].kind === "revolute");
    const columns = turning.map((k) => column(run, k));
    return turning.length ? Array.from({ length: run.q.shape[0] - 1 }, (_, i) => Math.max(...columns.map((c) => Math.abs(c[i + 1] - c[i])))) : null;
  };

  const add = (parent, spec, small) => {
    if (!spec.series.length) return;
    const place = n("div", { class: "chart" });
    parent.append(n("figure", { class: small ? "small" : "wide" }, n("figcaption", {}, spec.title, spec.unit ? n("small", {}, ` [${spec.unit}]`) : null), place));
    const chart = new DA.Chart(place, { ...spec, small, x: axis() }, seek);
    charts.push(chart);
  };

  const draw = () => {
    charts = [];
    const run = player.run, cell = head.cells[run.cell], body = n("div", { class: "charts" });
    host.querySelector(".charts")?.remove();
    card.after(body);
    add(body, { title: run.quantity || "index", unit: run.units, series: series(stored("index")), zero: true });
    const asked = (run.near && run.near.required) || 0;
    add(body, { title: "clearance, all pairs of links", unit: "m", series: series(stored("clearance")), zero: true, floor: 0 });
    add(body, { title: "nearest of arms, parts and objects" + (asked ? `; ${asked} m is asked for` : ""), unit: "m", series: series((r) => (r.near ? Array.from(head.array(r.near.distance)) : null)), zero: true, floor: asked });
    add(body, { title: "distance between the arms", unit: "m", series: series(stored("between_arms")), zero: true, floor: 0 });
    add(body, { title: "smallest singular value of J_r", unit: "m and rad mixed", series: series(stored("singular_value")), zero: true });
    add(body, { title: "largest joint step", unit: "deg", series: series(steps), zero: true, steps: true });
    if (run.motion) motion(body, run, cell);
    const grid = n("div", { class: "grid-of-joints" });
    body.append(n("h2", {}, "Joints within their bounds"), grid);
    cell.columns.forEach((joint, k) => {
      const scale = degrees(run, k);
      add(grid, {
        title: joint.name, unit: joint.kind === "revolute" ? "deg" : "m", bounds: [joint.lower * scale, joint.upper * scale],
        series: series((other) => (other.cell === run.cell ? column(other, k) : null)),
      }, true);
    });
    choose();
  };

  // Shares of the limits, joint by joint, and which limit holds the motion back where.
  const motion = (body, run, cell) => {
    const shares = (key) => cell.columns.map((joint, k) => {
      const all = head.array(run.motion[key]), width = cell.columns.length;
      return { name: joint.name, values: Array.from({ length: all.length / width }, (_, i) => 100 * all[i * width + k]), colour: DA.colour(k), dash: DA.dashes[k % 7] };
    }).filter((s) => s.values.some(Number.isFinite));
    body.append(n("h2", {}, "Motion in time"));
    add(body, { title: "joint speed, share of its limit", unit: "%", series: shares("speed_share"), zero: true });
    if (run.motion.torque_share) add(body, { title: "joint torque, share of its limit", unit: "%", series: shares("torque_share"), zero: true });
    const names = [...new Set(run.motion.held_by)], xs = axis().values, whole = xs[xs.length - 1] - xs[0] || 1, parts = [];
    const edge = (i) => (xs.length === run.motion.held_by.length ? (i <= 0 ? xs[0] : i >= xs.length ? xs[xs.length - 1] : 0.5 * (xs[i - 1] + xs[i])) : (i / run.motion.held_by.length) * whole);
    for (let i = 0, j; i < run.motion.held_by.length; i = j) {
      for (j = i; run.motion.held_by[j] === run.motion.held_by[i]; j++);
      const name = run.motion.held_by[i];
      parts.push(n("i", { title: name, style: `width:${(100 * (edge(j) - edge(i))) / whole}%;background:${DA.colour(names.indexOf(name))}` }));
    }
    body.append(n("figure", { class: "wide" }, n("figcaption", {}, "what holds the motion back, along the path"),
      n("div", { class: "held", role: "img", "aria-label": names.join(", ") }, parts),
      n("p", { class: "held-names" }, names.map((name, k) => n("span", {}, n("i", { style: `background:${DA.colour(k)}` }), name)))));
  };

  // Index against feed of every result that has a motion; a point chooses its result.
  const trade = () => {
    const points = head.runs.map((run, k) => ({ run, k })).filter(({ run }) => run.motion);
    if (points.length < 2) return null;
    const w = 420, h = 220, m = 46, mean = (run) => Array.from(head.array(run.index)).reduce((a, b) => a + b, 0) / run.index.shape[0];
    const span = (values) => { const low = Math.min(...values), high = Math.max(...values), room = 0.08 * (high - low) || 1; return [low - room, high + room]; };
    const x = span(points.map(({ run }) => mean(run))), y = span(points.map(({ run }) => run.motion.feed));
    const X = (v) => m + ((v - x[0]) / (x[1] - x[0])) * (w - m - 10), Y = (v) => h - 34 - ((v - y[0]) / (y[1] - y[0])) * (h - 44);
    const tick = (v, px, py, c) => n("text", { x: px, y: py, class: `tick ${c}` }, DA.number(v, 3));
    const marks = DA.Chart.ticks(x[0], x[1], 4).map((v) => tick(v, X(v), h - 18, "mid")).concat(DA.Chart.ticks(y[0], y[1], 4).map((v) => tick(v, m - 6, Y(v) + 4, "end")));
    const dots = points.map(({ run, k }) => n("circle", { cx: X(mean(run)), cy: Y(run.motion.feed), r: 6, fill: DA.colour(k), class: "trade-point", tabindex: 0, role: "button", "aria-label": run.label, onclick: () => player.select(k), onkeydown: (e) => e.key === "Enter" && player.select(k) }, n("title", {}, `${run.label}: index ${DA.number(mean(run))}, feed ${DA.number(run.motion.feed)} m/s`)));
    return n("figure", { class: "wide trade" }, n("figcaption", {}, "index against feed", n("small", {}, " each point is a motion: click to open it")),
      n("svg", { viewBox: `0 0 ${w} ${h}`, class: "plot" }, marks, n("text", { x: (w + m) / 2, y: h - 3, class: "tick mid" }, "mean index"), n("text", { x: m, y: 10, class: "tick" }, "feed [m/s]"), dots));
  };

  const choose = () => {
    fill();
    for (const chart of charts) {
      chart.choose(chart.spec.series.findIndex((s) => s.run === player.active));
      chart.move(player.t);
    }
    for (const b of host.querySelectorAll("[data-run]")) b.setAttribute("aria-pressed", String(Number(b.dataset.run) === player.active));
    for (const cell of host.querySelectorAll("[data-column]")) cell.classList.toggle("active", Number(cell.dataset.column) === player.active);
    const task = host.querySelector(".task");
    if (task) task.textContent = player.run.task || "not stored";
  };

  const legend = n("div", { class: "legend" },
    head.runs.map((run, k) => n("button", { type: "button", "data-run": k, onclick: () => player.select(k) }, n("i", { style: `background:${DA.colour(k)}` }), run.label, run.found === false ? " (not found)" : "")),
    lengths.size > 1 ? null : n("select", { "aria-label": "Horizontal axis", onchange: (e) => { along = e.target.value; draw(); } }, n("option", { value: "point" }, "by path point"), n("option", { value: "arc" }, "by arc length"), head.runs.some((run) => run.motion) ? n("option", { value: "time" }, "by time") : null));

  const table = (section) => n("section", { class: "table" }, n("h2", {}, section.title), n("div", { class: "scroll" }, n("table", {},
    many ? n("thead", {}, n("tr", {}, n("th", {}), head.runs.map((run, k) => n("th", { scope: "col", "data-column": k }, n("i", { style: `background:${DA.colour(k)}` }), run.label)))) : null,
    n("tbody", {}, section.rows.filter(([name]) => name !== "in words").map(([name, cells]) => n("tr", {}, n("th", { scope: "row" }, name), cells.map((text, k) => n("td", { "data-column": k }, text || "–"))))))));

  // What one wants to know first, for the chosen result.
  const rows = new Map(head.results.flatMap((s) => s.rows));
  const first = ["found", "duration", "feed", "mean index", "largest index", "objective", "smallest clearance", "clearance asked for", "between the points", "above the lowest objective", "arms apart by", "largest joint step", "gap to it", "verdict", "in words"];
  const card = n("dl", { class: "card" });
  const fill = () => card.replaceChildren(...first.filter((name) => rows.has(name) && rows.get(name)[player.active]).map((name) => {
    const text = rows.get(name)[player.active].split("\n")[0];
    return n("div", { class: (text === "NO" || text.includes("COLLISION") || text.includes("NOT KEPT") ? "bad" : "") + (["verdict", "in words"].includes(name) ? " full" : "") }, n("dt", {}, name), n("dd", {}, text));
  }));

  const exchange = trade();
  host.append(legend, card, ...(exchange ? [exchange] : []), ...head.results.filter((s) => s.rows.length).map(table));
  if (head.runs.some((run) => run.task)) host.append(n("details", { class: "source" }, n("summary", {}, "The task as solved"), n("pre", { class: "task" })));
  host.append(n("footer", { class: "made" }, "Made by dualarm_pin. The 3D view is meshcat (MIT licence), which holds three.js (MIT licence)."));
  draw();

  let shown = player.run.cell;
  player.on("time", () => charts.forEach((chart) => chart.move(player.t)));
  player.on("run", () => {
    if (player.run.cell !== shown || head.runs.some((run) => run.motion)) {
      shown = player.run.cell;
      draw();
    } else choose();
  });
  Object.defineProperty(window.dualarm, "charts", { get: () => charts });
};
