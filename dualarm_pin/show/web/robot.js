// The robots: Pinocchio's joint tree as nested three.js groups, each turned by its own joint angle.

// Corners on a grid and faces -> a geometry whose edges stay sharp and whose drums look round.
DA.geometry = function (head, mesh) {
  const T = MeshCat.THREE;
  const grid = head.array(mesh.corners), faces = head.array(mesh.faces), count = faces.length / 3;
  const x = new Float32Array(grid.length);
  for (let k = 0; k < grid.length; k++) x[k] = mesh.origin[k % 3] + grid[k] * mesh.step[k % 3];
  const normals = new Float32Array(3 * count), start = new Uint32Array(x.length / 3 + 1);
  for (let f = 0; f < count; f++) {
    const [a, b, c] = [3 * faces[3 * f], 3 * faces[3 * f + 1], 3 * faces[3 * f + 2]];
    const u = [x[b] - x[a], x[b + 1] - x[a + 1], x[b + 2] - x[a + 2]];
    const v = [x[c] - x[a], x[c + 1] - x[a + 1], x[c + 2] - x[a + 2]];
    normals.set([u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], 3 * f);
    for (let k = 0; k < 3; k++) start[faces[3 * f + k] + 1]++;
  }
  for (let v = 1; v < start.length; v++) start[v] += start[v - 1];
  const around = new Uint32Array(3 * count), next = start.slice();
  for (let k = 0; k < 3 * count; k++) around[next[faces[k]]++] = Math.floor(k / 3);
  // Corners that share place and normal are one vertex: without a graphics card vertices cost most.
  const position = [], smooth = [], index = new Uint32Array(3 * count), made = Array.from({ length: x.length / 3 }, () => []);
  const length = (f) => Math.hypot(normals[3 * f], normals[3 * f + 1], normals[3 * f + 2]) || 1e-30;
  for (let k = 0; k < 3 * count; k++) {
    const f = Math.floor(k / 3), v = faces[k], size = length(f), n = [0, 0, 0];
    for (let i = start[v]; i < start[v + 1]; i++) {
      const g = around[i];
      const dot = normals[3 * f] * normals[3 * g] + normals[3 * f + 1] * normals[3 * g + 1] + normals[3 * f + 2] * normals[3 * g + 2];
      if (dot > 0.8 * size * length(g)) for (let j = 0; j < 3; j++) n[j] += normals[3 * g + j];
    }
    const whole = Math.hypot(n[0], n[1], n[2]) || 1;
    for (let j = 0; j < 3; j++) n[j] /= whole;
    const same = made[v].find((m) => smooth[3 * m] * n[0] + smooth[3 * m + 1] * n[1] + smooth[3 * m + 2] * n[2] > 0.9995);
    index[k] = same ?? position.length / 3;
    if (same !== undefined) continue;
    made[v].push(index[k]);
    position.push(x[3 * v], x[3 * v + 1], x[3 * v + 2]);
    smooth.push(...n);
  }
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.Float32BufferAttribute(position, 3));
  geometry.setAttribute("normal", new T.Float32BufferAttribute(smooth, 3));
  geometry.setIndex(new T.BufferAttribute(index, 1));
  return geometry;
};

// A rough stand-in for motion without a graphics card: corners in one box of a grid, that face the
// same way, are one. Each of the two knows the other.
DA.rough = function (geometry) {
  const T = MeshCat.THREE, { position, normal } = geometry.attributes, faces = geometry.index.array;
  if (faces.length < 3 * 300) return;
  geometry.computeBoundingBox();
  const box = geometry.boundingBox, step = box.getSize(new T.Vector3()).length() / 8, first = new Map(), kept = [];
  const into = Array.from({ length: position.count }, (_, k) => {
    const at = [0, 1, 2].map((j) => Math.floor((position.array[3 * k + j] - box.min.getComponent(j)) / step));
    const side = [0, 1, 2].reduce((bits, j) => 2 * bits + Number(normal.array[3 * k + j] > 0), 0);
    const key = ((at[0] * 64 + at[1]) * 64 + at[2]) * 8 + side;
    if (!first.has(key)) first.set(key, k);
    return first.get(key);
  });
  for (let f = 0; f < faces.length; f += 3) {
    const [a, b, c] = [into[faces[f]], into[faces[f + 1]], into[faces[f + 2]]];
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  const rough = new T.BufferGeometry();
  const used = [...new Set(kept)], number = new Map(used.map((v, k) => [v, k]));
  const pick = (array) => used.flatMap((v) => [array[3 * v], array[3 * v + 1], array[3 * v + 2]]);
  rough.setAttribute("position", new T.Float32BufferAttribute(pick(position.array), 3));
  rough.setAttribute("normal", new T.Float32BufferAttribute(pick(normal.array), 3));
  rough.setIndex(kept.map((v) => number.get(v)));
  geometry.userData.rough = rough;
  rough.userData.fine = geometry;
};

DA.place = function (object, placed) {
  object.position.fromArray(placed.p);
  object.quaternion.fromArray(placed.r);
  return object;
};

DA.Robot = class {
  // look: {} for the robot itself, {tint: "#rrggbb", opacity: 0.2} for a ghost.
  constructor(head, cell, look) {
    const T = MeshCat.THREE;
    this.cell = cell;
    this.root = new T.Group();
    this.joints = cell.joints.map((joint) => {
      const group = new T.Group();
      group.userData = { rest: new T.Quaternion(...joint.r), at: new T.Vector3(...joint.p), axis: new T.Vector3(...joint.axis) };
      return group;
    });
    const of = (j) => (j === 0 ? this.root : this.joints[j - 1]);
    cell.joints.forEach((joint, k) => of(joint.joint).add(this.joints[k]));
    this.frames = new Map();
    for (const frame of [...cell.frames, cell.e1, cell.e2]) {
      const node = DA.place(new T.Group(), frame);
      node.name = frame.name;
      of(frame.joint).add(node);
      this.frames.set(frame.name, node);
    }
    this.kinds = { visual: [], collision: [] };
    this.bodies = new Map();
    for (const [k, body] of cell.bodies.entries()) {
      if (look.tint && body.kind === "collision") continue;
      const mesh = DA.place(new T.Mesh(head.geometries[body.mesh], this.material(head, body, look)), body);
      mesh.castShadow = !look.tint && body.kind === "visual";
      mesh.receiveShadow = mesh.castShadow;
      mesh.renderOrder = look.tint ? 2 : body.kind === "collision" ? 1 : 0;
      mesh.visible = body.kind === "visual";
      mesh.userData.of = body.of;
      of(body.joint).add(mesh);
      this.kinds[body.kind].push(mesh);
      this.bodies.set(k, mesh);
    }
    this.chain = this.signs();
  }

  // Move what stands on a base: `rides` lists it; `motion` (Matrix4) leads from where it stood.
  // The tool of arm 2 reaches `longer` [m] further along its axis.
  stand(rides, motion, toolAxis, longer) {
    const T = MeshCat.THREE, turn = new T.Quaternion().setFromRotationMatrix(motion);
    const move = (node, placed) => {
      DA.place(node, placed);
      node.position.applyMatrix4(motion);
      node.quaternion.premultiply(turn);
    };
    const { cell } = this;
    for (const k of rides.joints) {
      this.joints[k].userData.rest.fromArray(cell.joints[k].r).premultiply(turn);
      this.joints[k].userData.at.fromArray(cell.joints[k].p).applyMatrix4(motion);
    }
    for (const k of rides.frames) move(this.frames.get(cell.frames[k].name), cell.frames[k]);
    for (const k of rides.bodies) if (this.bodies.has(k)) move(this.bodies.get(k), cell.bodies[k]);
    for (const tip of ["e1", "e2"]) {
      const node = this.frames.get(tip);
      if (rides.tips.includes(tip)) move(node, cell[tip]);
      else DA.place(node, cell[tip]);
      if (tip === "e2") node.position.add(new T.Vector3(...toolAxis).multiplyScalar(longer).applyQuaternion(node.quaternion));
    }
  }

  material(head, body, look) {
    const T = MeshCat.THREE, hull = body.kind === "collision";
    const key = look.tint ? look.tint + look.opacity : hull ? "hull" : body.colour.join();
    const kept = head.materials;
    if (!kept.has(key)) {
      const colour = new T.Color(look.tint || (hull ? "#E69F00" : 0));
      if (!look.tint && !hull) colour.setRGB(...body.colour.slice(0, 3));
      const opacity = look.tint ? look.opacity : hull ? 0.35 : body.colour[3];
      kept.set(key, new T.MeshPhongMaterial({
        color: colour, specular: 0x2a2a2a, shininess: 38, opacity, transparent: opacity < 1, depthWrite: !hull,
        // Ghosts step back and hulls step forward where they coincide with the robot.
        polygonOffset: Boolean(look.tint) || hull, polygonOffsetFactor: hull ? -1 : 2, polygonOffsetUnits: hull ? -4 : 8,
      }));
    }
    return kept.get(key);
  }

  // +1 for joints that carry e2 alone, -1 for e1 alone, 0 for both or none: the sign of their column.
  signs() {
    const carried = (j) => {
      const list = new Set();
      for (; j > 0; j = this.cell.joints[j - 1].joint) list.add(j - 1);
      return list;
    };
    const one = carried(this.cell.e1.joint), two = carried(this.cell.e2.joint);
    return this.joints.map((_, k) => Number(two.has(k)) - Number(one.has(k)));
  }

  pose(q) {
    const T = MeshCat.THREE, turn = new T.Quaternion();
    this.cell.joints.forEach((joint, k) => {
      const value = joint.map.reduce((sum, [column, factor]) => sum + factor * q[column], joint.offset);
      const { rest, at, axis } = this.joints[k].userData;
      if (joint.turns) {
        this.joints[k].position.copy(at);
        this.joints[k].quaternion.copy(rest).multiply(turn.setFromAxisAngle(axis, value));
      } else {
        this.joints[k].quaternion.copy(rest);
        this.joints[k].position.copy(axis).multiplyScalar(value).applyQuaternion(rest).add(at);
      }
    });
    this.root.updateMatrixWorld(true);
  }

  show(kind, on) {
    for (const mesh of this.kinds[kind]) mesh.visible = on;
  }

  // Pose of a link in the world of the cell, as Pinocchio gives it.
  linkPose(name) {
    const T = MeshCat.THREE, node = this.frames.get(name);
    if (!node) throw new Error(`no link ${name}; known: ${[...this.frames.keys()].join(", ")}`);
    const matrix = this.root.matrixWorld.clone().invert().multiply(node.matrixWorld);
    const p = new T.Vector3(), r = new T.Quaternion(), s = new T.Vector3();
    matrix.decompose(p, r, s);
    return { position: p.toArray(), quaternion: r.toArray() };
  }

  // Translational part of J_r J_r^T, in e1 axes: eq. (11), from the joint axes as they stand.
  manipulability() {
    const T = MeshCat.THREE, columns = this.cell.columns.map(() => new T.Vector3());
    const e1 = this.frames.get("e1").matrixWorld, e2 = this.frames.get("e2").matrixWorld;
    const back = new T.Matrix3().setFromMatrix4(e1).transpose();
    const tip = new T.Vector3().setFromMatrixPosition(e2), at = new T.Vector3(), axis = new T.Vector3();
    this.cell.joints.forEach((joint, k) => {
      if (!this.chain[k]) return;
      const world = this.joints[k].matrixWorld;
      axis.copy(this.joints[k].userData.axis).transformDirection(world);
      at.setFromMatrixPosition(world);
      const v = joint.turns ? axis.clone().cross(at.subVectors(tip, at)) : axis.clone();
      v.multiplyScalar(this.chain[k]).applyMatrix3(back);
      for (const [column, factor] of joint.map) columns[column].addScaledVector(v, factor);
    });
    const A = [[0, 0, 0], [0, 0, 0], [0, 0, 0]];
    for (const v of columns) {
      const a = v.toArray();
      for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) A[i][j] += a[i] * a[j];
    }
    return A;
  }
};
