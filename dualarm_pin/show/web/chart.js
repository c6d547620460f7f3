// A line chart in SVG: several curves, one cursor, and a click that says where.
DA.Chart = class {
  // spec: {title, unit, x: {label, values}, series: [{name, values, colour, dash}], bounds: [low, high], zero, steps}
  constructor(element, spec, seek) {
    Object.assign(this, { element, spec, seek, at: 0, active: -1 });
    this.svg = DA.h("svg", { class: "plot", role: "img", "aria-label": spec.title });
    this.tip = DA.h("div", { class: "tip", hidden: true });
    element.append(this.svg, this.tip);
    const point = (event) => this.invert(event.clientX - this.svg.getBoundingClientRect().left);
    this.svg.addEventListener("pointerdown", (event) => {
      this.svg.setPointerCapture(event.pointerId);
      this.held = true;
      this.seek(point(event));
    });
    this.svg.addEventListener("pointermove", (event) => {
      this.hover(point(event));
      if (this.held) this.seek(point(event));
    });
    for (const end of ["pointerup", "pointercancel"]) this.svg.addEventListener(end, () => (this.held = false));
    this.svg.addEventListener("pointerleave", () => (this.tip.hidden = true));
    new ResizeObserver(() => this.draw()).observe(element);
    this.draw();
  }

  static ticks(low, high, count) {
    const raw = (high - low) / Math.max(count, 1), power = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= raw * 0.999) || 10 * power;
    const out = [];
    for (let v = Math.ceil(low / step - 1e-9) * step; v <= high + 1e-9 * step; v += step) out.push(Math.abs(v) < 1e-12 ? 0 : v);
    return out;
  }

  domain() {
    const { spec } = this;
    let low = spec.zero ? 0 : Infinity, high = -Infinity;
    for (const s of spec.series) for (const v of s.values) if (Number.isFinite(v)) [low, high] = [Math.min(low, v), Math.max(high, v)];
    if (spec.bounds) [low, high] = [Math.min(low, spec.bounds[0]), Math.max(high, spec.bounds[1])];
    if (!(high > low)) [low, high] = [low - 0.5 || -0.5, low + 0.5 || 0.5];
    if (!Number.isFinite(low)) [low, high] = [0, 1];
    const room = 0.06 * (high - low);
    return [spec.zero && low === 0 ? 0 : low - room, high + room];
  }

  // Curves are drawn over the fraction of the path t in [0, 1]; `x.values` says what that is.
  draw() {
    const w = this.element.clientWidth, h = this.element.clientHeight, { spec } = this;
    if (!w || !h) return;
    const bare = spec.bare, m = bare ? { l: 0, r: 0, t: 3, b: 3 } : { l: 46, r: 10, t: 8, b: spec.small ? 18 : 30 };
    Object.assign(this, { w, h, m });
    const [low, high] = this.domain(), X = (t) => m.l + t * (w - m.l - m.r);
    const Y = (v) => h - m.b - ((v - low) / (high - low)) * (h - m.t - m.b);
    this.X = X;
    const n = DA.h, parts = [];
    const line = (x1, y1, x2, y2, c) => n("line", { x1, y1, x2, y2, class: c });
    if (!bare) {
      const [from, to] = spec.bounds || [];
      const levels = spec.bounds ? [from, ...(from < 0 && to > 0 ? [0] : []), to] : DA.Chart.ticks(low, high, Math.max(2, (h - 40) / 34));
      for (const v of levels) {
        parts.push(line(m.l, Y(v), w - m.r, Y(v), "grid"), n("text", { x: m.l - 6, y: Y(v) + 4, class: "tick end" }, DA.number(v, 4)));
      }
      const xs = spec.x.values, last = xs[xs.length - 1], first = xs[0];
      let ticks = DA.Chart.ticks(first, last, Math.max(2, w / 90));
      if (spec.x.whole) ticks = ticks.filter((v) => Number.isInteger(v));
      for (const v of ticks) {
        const t = (v - first) / (last - first);
        parts.push(line(X(t), m.t, X(t), h - m.b, "grid"), n("text", { x: X(t), y: h - m.b + 14, class: "tick mid" }, DA.number(v, 4)));
      }
      parts.push(line(m.l, h - m.b, w - m.r, h - m.b, "axis"));
      if (!spec.small) parts.push(n("text", { x: (m.l + w - m.r) / 2, y: h - 3, class: "tick mid" }, spec.x.label));
    }
    if (spec.bounds) {
      const [a, b] = spec.bounds.map(Y);
      parts.push(n("rect", { x: m.l, y: m.t, width: w - m.l - m.r, height: Math.max(0, b - m.t), class: "outside" }));
      parts.push(n("rect", { x: m.l, y: a, width: w - m.l - m.r, height: Math.max(0, h - m.b - a), class: "outside" }));
      parts.push(line(m.l, a, w - m.r, a, "bound"), line(m.l, b, w - m.r, b, "bound"));
    }
    if (spec.floor !== undefined && low < spec.floor) {
      parts.push(n("rect", { x: m.l, y: Y(spec.floor), width: w - m.l - m.r, height: h - m.b - Y(spec.floor), class: "danger" }));
    }
    const ordered = spec.series.map((s, k) => [s, k]).sort((a, b) => (a[1] === this.active) - (b[1] === this.active));
    for (const [s, k] of ordered) {
      const d = [], count = s.values.length;
      s.values.forEach((v, i) => {
        if (!Number.isFinite(v)) return;
        const x = this.x01(i, count);
        if (spec.steps) d.push(`${d.length ? "L" : "M"}${X(i / count)} ${Y(v)}L${X((i + 1) / count)} ${Y(v)}`);
        else d.push(`${d.length ? "L" : "M"}${X(x)} ${Y(v)}`);
      });
      if (d.length) parts.push(n("path", { d: d.join(""), class: "curve" + (k === this.active ? " active" : ""), stroke: s.colour, "stroke-dasharray": s.dash || null, "data-name": s.name }));
    }
    this.cursor = line(X(0), m.t, X(0), h - m.b, "cursor");
    this.dot = n("circle", { r: 4.5, class: "dot" });
    parts.push(this.cursor, this.dot);
    this.Y = Y;
    this.svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
    this.svg.replaceChildren(...parts);
    this.moved = null;
    this.move(this.at);
  }

  // Points stand at their x (arc length or number), so curves bend where the path does.
  x01(i, count) {
    const xs = this.spec.x.values;
    if (xs.length !== count) {
      // Values between the points stand between them.
      const at = count > 1 ? (i / (count - 1)) * (xs.length - 1) : 0, k = Math.min(Math.floor(at), xs.length - 2);
      return (xs[k] + (at - k) * (xs[k + 1] - xs[k]) - xs[0]) / (xs[xs.length - 1] - xs[0] || 1);
    }
    return (xs[i] - xs[0]) / (xs[count - 1] - xs[0] || 1);
  }

  toX(t) {
    const xs = this.spec.x.values, at = t * (xs.length - 1), k = Math.min(Math.floor(at), xs.length - 2);
    return this.X((xs[k] + (at - k) * (xs[k + 1] - xs[k]) - xs[0]) / (xs[xs.length - 1] - xs[0] || 1));
  }

  invert(px) {
    const xs = this.spec.x.values, last = xs.length - 1;
    const x = xs[0] + Math.min(Math.max((px - this.m.l) / (this.w - this.m.l - this.m.r), 0), 1) * (xs[last] - xs[0]);
    let k = 0;
    while (k < last - 1 && xs[k + 1] < x) k++;
    const f = xs[k + 1] > xs[k] ? (x - xs[k]) / (xs[k + 1] - xs[k]) : 0;
    return Math.min(1, (k + Math.min(Math.max(f, 0), 1)) / last);
  }

  move(t) {
    this.at = t;
    if (!this.X) return;
    const x = this.toX(t), s = this.spec.series[this.active < 0 ? 0 : this.active];
    const v = s && this.value(s, t), now = `${x} ${v}`;
    if (this.moved === now) return; // the same numbers would be painted again too
    this.moved = now;
    this.cursor.setAttribute("x1", x);
    this.cursor.setAttribute("x2", x);
    this.dot.setAttribute("visibility", Number.isFinite(v) ? "visible" : "hidden");
    if (Number.isFinite(v)) {
      this.dot.setAttribute("cx", x);
      this.dot.setAttribute("cy", this.Y(v));
      this.dot.setAttribute("fill", s.colour);
    }
  }

  value(s, t) {
    const count = s.values.length;
    if (this.spec.steps) return s.values[Math.min(Math.floor(t * count), count - 1)];
    return count > 1 ? DA.between(s.values, 1, t * (count - 1))[0] : s.values[0];
  }

  hover(t) {
    const rows = this.spec.series.map((s) => DA.h("div", {}, DA.h("i", { style: `background:${s.colour}` }), `${s.name}: ${DA.number(this.value(s, t), 4)}${this.spec.unit ? " " + this.spec.unit : ""}`));
    this.tip.replaceChildren(...rows);
    this.tip.hidden = false;
    const x = this.toX(t), right = x > this.w / 2;
    this.tip.style.left = right ? "" : `${x + 10}px`;
    this.tip.style.right = right ? `${this.w - x + 10}px` : "";
  }

  choose(k) {
    this.active = k;
    this.draw();
  }
};
