"use strict";
// Everything of ours lives in DA; `window.dualarm` is what users and tests call (start.js).
const DA = {};

DA.unsqueeze = async function (id) {
  const text = atob(document.getElementById(id).textContent.trim());
  const bytes = Uint8Array.from(text, (c) => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
};

// The layout is that of show/packing.py.
DA.unpack = function (bytes) {
  const length = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + length)));
  const base = bytes.byteOffset + 4 + length;
  const kinds = { f4: Float32Array, u2: Uint16Array, u4: Uint32Array };
  head.array = (ref) =>
    new kinds[ref.type](bytes.buffer, base + ref.at, ref.shape.reduce((a, b) => a * b, 1));
  return head;
};

// Own the name of an element's parts in one line: h("p", {class: "x"}, "text", child).
DA.h = function (tag, attributes, ...children) {
  const svg = DA.svgTags.has(tag);
  const node = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [key, value] of Object.entries(attributes || {})) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value === true ? "" : value);
  }
  // Text nodes only, never markup: names come from files.
  for (const child of children.flat()) if (child !== null && child !== undefined) node.append(child);
  return node;
};
DA.svgTags = new Set(["svg", "path", "line", "rect", "circle", "g", "text", "polyline", "title", "clipPath", "defs"]);

// Okabe and Ito, as in the figures; black is replaced by grey that shows on both themes.
DA.colours = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8a8f98"];
DA.dashes = ["", "9 4", "3 3", "10 3 2 3", "5 2 2 2 2 2", "14 5", "1 3"];
DA.colour = (k) => DA.colours[k % 7];

// The brighter part of viridis, so that a low index is seen before dark links too: even in
// lightness, safe for colour-blind readers.
DA.viridis = [[59, 82, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
DA.shade = function (x) {
  const last = DA.viridis.length - 1, s = Math.min(Math.max(x, 0), 1) * last, k = Math.min(Math.floor(s), last - 1), f = s - k;
  return DA.viridis[k].map((a, i) => (a + f * (DA.viridis[k + 1][i] - a)) / 255);
};

// f, called at once where it has rested for ms() milliseconds, else once later, for all calls meanwhile; `.now()`
// does not wait. Words that change with every picture cost more than the picture.
DA.seldom = function (f, ms) {
  let last = -Infinity, timer = null;
  const now = () => {
    clearTimeout(timer);
    timer = null;
    last = performance.now();
    f();
  };
  const call = () => {
    const left = last + ms() - performance.now();
    if (left <= 0) now();
    else timer = timer ?? setTimeout(now, left);
  };
  return Object.assign(call, { now });
};

DA.number = function (x, digits = 3) {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  if (size !== 0 && (size < 1e-3 || size >= 1e5)) return x.toExponential(digits - 1).replace("-", "−");
  return Number(x.toPrecision(digits)).toString().replace("-", "−");
};

// Row `at` (a real number) of a (rows, width) array, linear between rows: the motion between points.
DA.between = function (array, width, at) {
  const rows = array.length / width, k = Math.min(Math.floor(at), rows - 2), f = at - k;
  const out = new Array(width);
  for (let j = 0; j < width; j++) {
    const a = array[k * width + j];
    out[j] = a + f * (array[(k + 1) * width + j] - a);
  }
  return out;
};

// Eigenvalues and vectors (columns) of a symmetric 3x3 matrix by Jacobi rotations.
DA.eigen = function (matrix) {
  const A = matrix.map((r) => r.slice()), V = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 30; sweep++) {
    if (A[0][1] ** 2 + A[0][2] ** 2 + A[1][2] ** 2 < 1e-22 * (A[0][0] ** 2 + A[1][1] ** 2 + A[2][2] ** 2)) break;
    for (const [p, q] of [[0, 1], [0, 2], [1, 2]]) {
      if (A[p][q] === 0) continue;
      const theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
      const t = (theta >= 0 ? 1 : -1) / (Math.abs(theta) + Math.hypot(theta, 1));
      const c = 1 / Math.hypot(t, 1), s = t * c;
      for (let k = 0; k < 3; k++) [A[k][p], A[k][q]] = [c * A[k][p] - s * A[k][q], s * A[k][p] + c * A[k][q]];
      for (let k = 0; k < 3; k++) [A[p][k], A[q][k]] = [c * A[p][k] - s * A[q][k], s * A[p][k] + c * A[q][k]];
      for (let k = 0; k < 3; k++) [V[k][p], V[k][q]] = [c * V[k][p] - s * V[k][q], s * V[k][p] + c * V[k][q]];
    }
  }
  return { values: [A[0][0], A[1][1], A[2][2]], vectors: V };
};
