// The two bodies that are nearest: a line between them with its length; bodies that are nearer than
// what is asked for, or in each other, turn magenta, the colour of no robot. The places come with the page; between two
// of them the line follows the bodies.
DA.Nearest = class {
  constructor(head, run, robot, reach) {
    const T = MeshCat.THREE;
    Object.assign(this, { robot, reach, near: run.near });
    this.distance = head.array(run.near.distance);
    this.ends = [head.array(run.near.first), head.array(run.near.second)];
    this.colour = new T.MeshBasicMaterial({ depthTest: false, transparent: true });
    this.rod = new T.Mesh(new T.CylinderGeometry(1, 1, 1, 10), this.colour);
    this.balls = [0, 1].map(() => new T.Mesh(new T.SphereGeometry(1, 14, 10), this.colour));
    this.group = new T.Group();
    this.group.add(this.rod, ...this.balls);
    for (const part of this.group.children) part.renderOrder = 6;
    this.warning = new T.MeshPhongMaterial({ color: "#e100b4", specular: 0x2a2a2a, shininess: 38 });
  }

  // The stored place that is nearest to t, and the distance there or between.
  at(t) {
    const last = this.distance.length - 1, i = Math.round(t * last), pair = this.near.pairs[this.near.which[i]];
    const same = this.near.which[Math.floor(t * last)] === this.near.which[Math.ceil(t * last)];
    const value = same && last > 0 ? DA.between(this.distance, 1, t * last)[0] : this.distance[i];
    const lacking = this.near.lacking[i] || [];
    return { i, pair, value, lacking, bad: lacking.length > 0 || value <= 0 };
  }

  update(t, on) {
    const T = MeshCat.THREE, here = this.at(t), root = this.robot.root;
    this.group.visible = on;
    this.tint(on ? here.lacking : []);
    if (!on) return;
    const back = root.matrixWorld.clone().invert();
    const [a, b] = here.pair.joints.map((j, side) => {
      const x = new T.Vector3(...this.ends[side].subarray(3 * here.i, 3 * here.i + 3));
      const node = j === 0 ? root : this.robot.joints[j - 1];
      return x.applyMatrix4(node.matrixWorld).applyMatrix4(back);
    });
    const along = new T.Vector3().subVectors(b, a), length = along.length(), r = 0.004 * this.reach;
    this.colour.color.set(here.bad ? "#e100b4" : "#00838f");
    this.rod.visible = length > 1e-9;
    this.rod.position.addVectors(a, b).multiplyScalar(0.5);
    this.rod.scale.set(r, Math.max(length, 1e-6), r);
    if (length > 1e-9) this.rod.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), along.normalize());
    this.balls.forEach((ball, k) => {
      ball.position.copy(k ? b : a);
      ball.scale.setScalar(2.4 * r);
    });
    this.say(`${here.value.toFixed(3)} m`, here.bad ? "#e100b4" : "#00838f", this.rod.position);
  }

  // A label is a picture: drawn again only when its text changes.
  say(text, colour, place) {
    if (this.text !== text + colour) {
      if (this.label) {
        this.group.remove(this.label);
        this.label.material.map.dispose();
        this.label.material.dispose();
      }
      this.label = DA.label(text, colour, 0.055 * this.reach);
      this.group.add(this.label);
      this.text = text + colour;
    }
    this.label.position.copy(place);
    this.label.position.z += 0.05 * this.reach;
  }

  tint(names) {
    const key = names.join("\n");
    if (key === this.tinted) return;
    this.tinted = key;
    const bad = new Set(names);
    for (const meshes of Object.values(this.robot.kinds)) for (const mesh of meshes) {
      mesh.userData.plain = mesh.userData.plain || mesh.material;
      mesh.material = bad.has(mesh.userData.of) ? this.warning : mesh.userData.plain;
    }
  }
};
