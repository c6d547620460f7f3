// A handle in the scene: three arrows to shift it, a ring to turn it about its z axis. Mouse, pen and
// touch alike; the camera stands still meanwhile.
DA.Gizmo = class {
  // size [m]; on: {begin(), move({x, y, z, yaw}), end()}; `parent` is the frame in which it moves.
  constructor(stage, size, on) {
    const T = MeshCat.THREE;
    Object.assign(this, { stage, size, on, at: { x: 0, y: 0, z: 0, yaw: 0 }, held: null });
    this.group = new T.Group();
    this.parts = [];
    const turns = { x: [0, 0, -Math.PI / 2], y: [0, 0, 0], z: [Math.PI / 2, 0, 0] };
    const colours = { x: "#e0484a", y: "#35a852", z: "#3b7be8", yaw: "#e8a13b" };
    for (const name of ["x", "y", "z"]) {
      const arrow = DA.arrow(size, colours[name]);
      const rod = this.unseen(new T.CylinderGeometry(size * 0.1, size * 0.1, size * 0.85, 8));
      rod.position.y = size * 0.62;
      arrow.add(rod);
      arrow.rotation.set(...turns[name]);
      this.part(name, arrow);
    }
    const ring = new T.Group(), round = size * 0.62;
    ring.add(new T.Mesh(new T.TorusGeometry(round, size * 0.02, 8, 64), new T.MeshBasicMaterial({ color: colours.yaw })));
    ring.add(this.unseen(new T.TorusGeometry(round, size * 0.075, 6, 32)));
    this.part("yaw", ring);
    this.caster = new T.Raycaster();
    // On the element around the canvas and before it: the camera's controls listen on the canvas.
    const around = stage.element.parentElement, canvas = stage.viewer.renderer.domElement;
    const inside = (event) => event.target === canvas;
    around.addEventListener("pointerdown", (event) => inside(event) && this.down(event), true);
    around.addEventListener("pointermove", (event) => (this.held ? this.drag(event) : inside(event) && event.pointerType === "mouse" && this.hover(event)), true);
    for (const end of ["pointerup", "pointercancel"]) around.addEventListener(end, (event) => this.up(event), true);
  }

  // What fingers hit: a ray finds it, though it is not drawn.
  unseen(geometry) {
    const mesh = new MeshCat.THREE.Mesh(geometry, new MeshCat.THREE.MeshBasicMaterial());
    mesh.visible = false;
    return mesh;
  }

  part(name, group) {
    group.traverse((mesh) => {
      if (!mesh.isMesh) return;
      mesh.userData.part = name;
      mesh.material.depthTest = false;
      mesh.material.transparent = true;
      mesh.renderOrder = 20;
    });
    this.parts.push({ name, group });
    this.group.add(group);
  }

  // Hang it on a frame; null takes it away. Only parts named in `parts` are there.
  attach(parent, parts) {
    if (this.group.parent) this.group.parent.remove(this.group);
    this.parent = parent;
    if (parent) parent.add(this.group);
    for (const { name, group } of this.parts) group.visible = parts.includes(name);
  }

  place(at) {
    Object.assign(this.at, at);
    this.group.position.set(this.at.x, this.at.y, this.at.z);
    this.group.updateMatrixWorld(true);
    // Without a graphics card pictures are for what follows: the handle alone moves less often.
    if (!this.held || !this.stage.thrifty || performance.now() - this.stage.drawn > 100) this.stage.moved();
  }

  // The ray under a pointer, in the coordinates of `frame` (a Matrix4 to the world).
  ray(event, frame) {
    const T = MeshCat.THREE, canvas = this.stage.viewer.renderer.domElement, box = canvas.getBoundingClientRect();
    const at = new T.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    this.stage.viewer.camera.updateMatrixWorld(); // it may have been turned since the last picture
    this.caster.setFromCamera(at, this.stage.viewer.camera);
    return frame ? this.caster.ray.clone().applyMatrix4(frame.clone().invert()) : this.caster.ray;
  }

  hit(event) {
    if (!this.parent) return null;
    this.ray(event);
    const seen = this.parts.filter(({ group }) => group.visible).map(({ group }) => group);
    const hits = this.caster.intersectObjects(seen, true);
    return hits.length ? hits[0].object.userData.part : null;
  }

  hover(event) {
    const part = this.hit(event);
    if (part === this.over) return;
    this.over = part;
    this.lit(part);
    this.stage.element.style.cursor = part ? "grab" : "";
  }

  lit(part) {
    for (const { name, group } of this.parts) group.scale.setScalar(name === part ? 1.12 : 1);
    this.stage.draw();
  }

  // Along an arrow: the place on its axis that is nearest to the ray. On the ring: the angle.
  value(part, ray, from) {
    const T = MeshCat.THREE, origin = new T.Vector3(from.x, from.y, from.z);
    if (part === "yaw") {
      const plane = new T.Plane(new T.Vector3(0, 0, 1), -from.z), point = ray.intersectPlane(plane, new T.Vector3());
      return point ? Math.atan2(point.y - from.y, point.x - from.x) : null;
    }
    const axis = new T.Vector3(Number(part === "x"), Number(part === "y"), Number(part === "z"));
    const away = origin.sub(ray.origin), along = axis.dot(ray.direction), across = 1 - along * along;
    return across < 1e-3 ? null : (along * ray.direction.dot(away) - axis.dot(away)) / across;
  }

  down(event) {
    if (this.held || event.button > 0 || !event.isPrimary) return;
    const part = this.hit(event);
    if (!part) return;
    event.stopPropagation();
    event.preventDefault();
    // The frame of the first moment: what is dragged may carry its own frame along.
    const frame = this.parent.matrixWorld.clone(), from = { ...this.at };
    const start = this.value(part, this.ray(event, frame), from);
    if (start === null) return;
    this.held = { id: event.pointerId, part, frame, from, last: start, turned: 0 };
    this.stage.element.setPointerCapture?.(event.pointerId);
    this.stage.viewer.controls.enabled = false;
    this.stage.held = true;
    this.lit(part);
    this.stage.element.style.cursor = "grabbing";
    this.on.begin();
  }

  drag(event) {
    const { id, part, frame, from, last } = this.held;
    if (event.pointerId !== id) return;
    event.stopPropagation();
    const value = this.value(part, this.ray(event, frame), from);
    if (value === null) return;
    let step = value - last;
    if (part === "yaw") step = Math.atan2(Math.sin(step), Math.cos(step)); // past the back of the circle
    this.held.last = value;
    this.held.turned += step;
    this.place({ [part]: from[part] + this.held.turned });
    this.on.move({ ...this.at });
  }

  up(event) {
    if (!this.held || event.pointerId !== this.held.id) return;
    event.stopPropagation();
    this.held = null;
    this.stage.viewer.controls.enabled = true;
    this.stage.held = false;
    this.lit(null);
    this.stage.element.style.cursor = "";
    this.on.end();
  }
};
