// What is drawn besides the robots: path, tip frames, ellipsoids with u, labels.

const SIDES = 10; // corners of a section of the tube

// A tube through the path, coloured by the index; it hangs on e1 and moves with it.
DA.ribbon = function (points, values, range, radius) {
  const T = MeshCat.THREE, h = points.length, sides = SIDES;
  const position = [], colour = [], faces = [];
  const side = new T.Vector3(), up = new T.Vector3(), tangent = new T.Vector3();
  for (let i = 0; i < h; i++) {
    tangent.subVectors(points[Math.min(i + 1, h - 1)], points[Math.max(i - 1, 0)]).normalize();
    if (i === 0 || side.addScaledVector(tangent, -side.dot(tangent)).length() < 1e-6) {
      side.set(Math.abs(tangent.x) < 0.8 ? 1 : 0, Math.abs(tangent.x) < 0.8 ? 0 : 1, 0);
      side.addScaledVector(tangent, -side.dot(tangent));
    }
    side.normalize();
    up.crossVectors(tangent, side);
    const c = DA.shade((values[i] - range[0]) / (range[1] - range[0] || 1));
    for (let k = 0; k < sides; k++) {
      const a = (2 * Math.PI * k) / sides;
      position.push(...points[i].clone().addScaledVector(side, radius * Math.cos(a)).addScaledVector(up, radius * Math.sin(a)).toArray());
      colour.push(...c);
      if (i + 1 < h) {
        const n = (k + 1) % sides, [p, q, r, s] = [i * sides + k, i * sides + n, (i + 1) * sides + k, (i + 1) * sides + n];
        faces.push(p, q, r, q, s, r);
      }
    }
  }
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.Float32BufferAttribute(position, 3));
  geometry.setAttribute("color", new T.Float32BufferAttribute(colour, 3));
  geometry.setIndex(faces);
  geometry.computeVertexNormals();
  const tube = new T.Mesh(geometry, new T.MeshBasicMaterial({ vertexColors: true, side: T.DoubleSide }));
  // Faintly through the links in front of it: the path is what the page is about.
  const through = new T.Mesh(geometry, new T.MeshBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.4, depthTest: false }));
  through.renderOrder = 4;
  tube.add(through);
  return tube;
};

// Colour a tube anew.
DA.recolour = function (tube, values, range) {
  const colour = tube.geometry.getAttribute("color");
  values.forEach((value, i) => {
    const c = DA.shade((value - range[0]) / (range[1] - range[0] || 1));
    for (let k = 0; k < SIDES; k++) colour.setXYZ(i * SIDES + k, ...c);
  });
  colour.needsUpdate = true;
};

// A line through points of the world (flat x, y, z), seen through whatever is in front of it.
DA.trace = function (points, colour) {
  const T = MeshCat.THREE, geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.Float32BufferAttribute(Array.from(points), 3));
  const line = new T.Line(geometry, new T.LineBasicMaterial({ color: colour, depthTest: false, transparent: true }));
  line.renderOrder = 5;
  return line;
};

DA.frame = function (size) {
  const T = MeshCat.THREE, group = new T.Group();
  const ends = [[[0, 0, -Math.PI / 2], "#d9383a"], [[0, 0, 0], "#2fa34a"], [[Math.PI / 2, 0, 0], "#2f6fde"]];
  for (const [turn, colour] of ends) {
    const arm = new T.Group(), material = new T.MeshBasicMaterial({ color: colour });
    const rod = new T.Mesh(new T.CylinderGeometry(size * 0.03, size * 0.03, size, 10), material);
    const tip = new T.Mesh(new T.ConeGeometry(size * 0.08, size * 0.22, 14), material);
    rod.position.y = size / 2;
    tip.position.y = size;
    arm.add(rod, tip);
    arm.rotation.set(...turn);
    group.add(arm);
  }
  return group;
};

DA.arrow = function (length, colour) {
  const T = MeshCat.THREE, group = new T.Group(), material = new T.MeshBasicMaterial({ color: colour });
  const rod = new T.Mesh(new T.CylinderGeometry(length * 0.025, length * 0.025, length * 0.8, 12), material);
  const tip = new T.Mesh(new T.ConeGeometry(length * 0.075, length * 0.24, 18), material);
  rod.position.y = length * 0.4;
  tip.position.y = length * 0.88;
  group.add(rod, tip);
  return group;
};

DA.ellipsoid = function (colour) {
  const T = MeshCat.THREE;
  const material = new T.MeshPhongMaterial({ color: colour, transparent: true, opacity: 0.34, depthWrite: false, shininess: 60 });
  const ball = new T.Mesh(new T.SphereGeometry(1, 40, 24), material);
  ball.renderOrder = 3;
  ball.matrixAutoUpdate = false;
  return ball;
};

// Give a unit ball, child of e1, the axes `V` (columns, e1 axes), half widths `sizes`, centre `at`.
DA.shape = function (ball, V, sizes, at) {
  const M = V.map((row) => row.slice());
  const det = M[0][0] * (M[1][1] * M[2][2] - M[1][2] * M[2][1]) - M[0][1] * (M[1][0] * M[2][2] - M[1][2] * M[2][0]) + M[0][2] * (M[1][0] * M[2][1] - M[1][1] * M[2][0]);
  if (det < 0) for (const row of M) row[0] = -row[0];
  const m = M.map((row) => row.map((v, k) => v * Math.max(sizes[k], 1e-5)));
  ball.matrix.set(...m[0], at.x, ...m[1], at.y, ...m[2], at.z, 0, 0, 0, 1);
  ball.matrixWorldNeedsUpdate = true;
};

DA.label = function (text, colour, height) {
  const T = MeshCat.THREE, canvas = document.createElement("canvas"), g = canvas.getContext("2d");
  const font = "600 44px system-ui, 'DejaVu Sans', sans-serif";
  g.font = font;
  canvas.width = Math.ceil(g.measureText(text).width) + 56;
  canvas.height = 72;
  g.font = font;
  g.fillStyle = colour;
  g.beginPath();
  const [w, r] = [canvas.width, 34];
  g.moveTo(r, 2); g.arcTo(w - 2, 2, w - 2, 70, r); g.arcTo(w - 2, 70, 2, 70, r); g.arcTo(2, 70, 2, 2, r); g.arcTo(2, 2, w, 2, r);
  g.fill();
  g.fillStyle = "#fff";
  g.textBaseline = "middle";
  g.fillText(text, 28, 38);
  const sprite = new T.Sprite(new T.SpriteMaterial({ map: new T.CanvasTexture(canvas), depthTest: false, transparent: true }));
  sprite.material.map.minFilter = T.LinearFilter;
  sprite.scale.set((height * canvas.width) / canvas.height, height, 1);
  sprite.renderOrder = 10;
  return sprite;
};
