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
    lengths.size > 1 ? null : n("select", { "aria-label": "Horizontal axis", onchange: (e) => { along = e.target.value; draw(); } }, n("option", { value: "point" }, "by path point"), n("option", { value: "arc" }, "by arc length")));

  const table = (section) => n("section", { class: "table" }, n("h2", {}, section.title), n("div", { class: "scroll" }, n("table", {},
    many ? n("thead", {}, n("tr", {}, n("th", {}), head.runs.map((run, k) => n("th", { scope: "col", "data-column": k }, n("i", { style: `background:${DA.colour(k)}` }), run.label)))) : null,
    n("tbody", {}, section.rows.filter(([name]) => name !== "in words").map(([name, cells]) => n("tr", {}, n("th", { scope: "row" }, name), cells.map((text, k) => n("td", { "data-column": k }, text || "–"))))))));

  // What one wants to know first, for the chosen result.
  const rows = new Map(head.results.flatMap((s) => s.rows));
  const first = ["found", "mean index", "largest index", "objective", "smallest clearance", "clearance asked for", "between the points", "above the lowest objective", "arms apart by", "largest joint step", "gap to it", "verdict", "in words"];
  const card = n("dl", { class: "card" });
  const fill = () => card.replaceChildren(...first.filter((name) => rows.has(name) && rows.get(name)[player.active]).map((name) => {
    const text = rows.get(name)[player.active].split("\n")[0];
    return n("div", { class: (text === "NO" || text.includes("COLLISION") || text.includes("NOT KEPT") ? "bad" : "") + (["verdict", "in words"].includes(name) ? " full" : "") }, n("dt", {}, name), n("dd", {}, text));
  }));

  host.append(legend, card, ...head.results.filter((s) => s.rows.length).map(table));
  if (head.runs.some((run) => run.task)) host.append(n("details", { class: "source" }, n("summary", {}, "The task as solved"), n("pre", { class: "task" })));
  host.append(n("footer", { class: "made" }, "Made by dualarm_pin. The 3D view is meshcat (MIT licence), which holds three.js (MIT licence)."));
  draw();

  let shown = player.run.cell;
  player.on("time", () => charts.forEach((chart) => chart.move(player.t)));
  player.on("run", () => {
    if (player.run.cell !== shown) {
      shown = player.run.cell;
      draw();
    } else choose();
  });
  Object.defineProperty(window.dualarm, "charts", { get: () => charts });
};
