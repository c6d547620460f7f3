// One run on the stage: robot, path, tips, ellipsoids, ghosts.
DA.View = class {
  // range: index values at the two ends of the colours; tint: a colour for a see-through copy.
  constructor(head, k, reach, range, tint) {
    const T = MeshCat.THREE, run = head.runs[k];
    this.run = run;
    this.reach = reach;
    this.cell = head.cells[run.cell];
    this.path = head.paths[run.path];
    this.q = head.array(run.q);
    this.index = head.array(run.index);
    this.h = this.index.length;
    this.u = head.array(this.path.u);
    this.group = new T.Group();
    this.group.matrixAutoUpdate = false;
    this.robot = new DA.Robot(head, this.cell, tint ? { tint, opacity: 0.34 } : {});
    this.group.add(this.robot.root);
    this.pose(0);
    this.home = this.e1().matrixWorld.clone();
    this.tint = tint;
    if (tint) return;
    const x = head.array(this.path.position), points = [];
    for (let i = 0; i < this.h; i++) points.push(new T.Vector3(x[3 * i], x[3 * i + 1], x[3 * i + 2]));
    this.marks = {
      path: [DA.ribbon(points, this.index, range, reach * 0.0045)],
      frames: [DA.frame(reach * 0.09), DA.frame(reach * 0.09)],
      force: [DA.ellipsoid("#E69F00")],
      velocity: [DA.ellipsoid("#0072B2")],
      direction: [DA.arrow(reach * 0.17, "#c2185b")],
    };
    this.ends = [0, this.h - 1].map((i) => ({ at: i, robot: new DA.Robot(head, this.cell, { tint: i ? "#D55E00" : "#0072B2", opacity: 0.16 }) }));
    this.marks.ghosts = this.ends.map(({ robot }) => robot.root);
    this.marks.traces = (run.tips || []).map((tip, k) => DA.trace(head.array(tip), k ? "#D55E00" : "#0072B2"));
    const { path, frames, force, velocity, direction, ghosts, traces } = this.marks;
    this.e1().add(path[0], frames[0], force[0], velocity[0], direction[0]);
    this.robot.frames.get("e2").add(frames[1]);
    this.group.add(...ghosts, ...traces);
    this.nearest = run.near ? new DA.Nearest(head, run, this.robot, reach) : null;
    if (this.nearest) this.group.add(this.nearest.group);
  }

  poseEnds() {
    for (const { at, robot } of this.ends) robot.pose(DA.between(this.q, this.cell.columns.length, at));
  }

  e1() {
    return this.robot.frames.get("e1");
  }

  pose(t) {
    this.robot.pose(DA.between(this.q, this.cell.columns.length, t * (this.h - 1)));
  }

  // Half widths of the velocity ellipsoid at t [m]: square roots of the eigenvalues of J J^T.
  widths(t) {
    this.pose(t);
    return DA.eigen(this.robot.manipulability()).values.map((v) => Math.sqrt(Math.max(v, 0)));
  }

  update(t, show, scale) {
    const T = MeshCat.THREE;
    this.group.matrix.identity();
    this.group.updateMatrixWorld(true);
    this.pose(t);
    if (!this.tint) this.updateMarks(t, show, scale);
    if (show.hold) this.group.matrix.copy(this.home).multiply(this.relativeE1().invert());
    this.group.updateMatrixWorld(true);
  }

  relativeE1() {
    return this.robot.root.matrixWorld.clone().invert().multiply(this.e1().matrixWorld);
  }

  updateMarks(t, show, scale) {
    const T = MeshCat.THREE;
    for (const [name, list] of Object.entries(this.marks)) for (const item of list) item.visible = Boolean(show[name]);
    if (show.ghosts) this.poseEnds();
    for (const kind of ["visual", "collision"]) this.robot.show(kind, show[kind]);
    if (this.nearest) this.nearest.update(t, show.distance);
    const tip = new T.Vector3().setFromMatrixPosition(this.robot.frames.get("e2").matrixWorld);
    tip.applyMatrix4(this.e1().matrixWorld.clone().invert());
    const { force, velocity, direction } = this.marks;
    if (show.force || show.velocity) {
      const { values, vectors } = DA.eigen(this.robot.manipulability());
      const width = values.map((v) => Math.sqrt(Math.max(v, 1e-12))), most = 0.75 * this.reach;
      DA.shape(velocity[0], vectors, width.map((w) => Math.min(w * scale.velocity, most)), tip);
      DA.shape(force[0], vectors, width.map((w) => Math.min(scale.force / w, most)), tip);
    }
    const u = new T.Vector3(...DA.between(this.u, 6, t * (this.h - 1)).slice(0, 3));
    if (u.length() < 1e-9) direction[0].visible = false;
    else direction[0].quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), u.normalize());
    direction[0].position.copy(tip);
  }
};
