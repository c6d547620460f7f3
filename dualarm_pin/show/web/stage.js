// The stage: meshcat's viewer with our light, floor and cameras.
DA.Stage = class {
  constructor(element) {
    const T = MeshCat.THREE;
    this.element = element;
    // Without a graphics card every pixel costs: then draw plainly in motion, finely at rest.
    this.software = DA.softwareRendering();
    this.thrifty = this.software;
    const renderer = new T.WebGLRenderer({ antialias: !this.software, alpha: true });
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = T.PCFSoftShadowMap;
    element.append(renderer.domElement);
    this.viewer = new MeshCat.Viewer(element, true, renderer);
    this.viewer.controls.addEventListener("change", () => this.moved());
    this.viewer.controls.addEventListener("start", () => (this.turned = true));
    this.viewer.gui.domElement.remove();
    this.viewer.hide_background();
    for (const path of [["Lights"], ["Grid"], ["Axes"]]) this.viewer.delete_path(path);
    this.world = new T.Group();
    this.viewer.scene.add(this.world);
    this.light();
    new ResizeObserver(() => this.fit()).observe(element);
    this.quality(true);
    this.fit();
  }

  quality(fine) {
    if (this.fine === fine) return;
    this.fine = fine;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.viewer.renderer.setPixelRatio(fine ? (this.software ? Math.max(ratio, 1.6) : ratio) : this.coarse || this.held ? 0.5 : 0.7);
    this.key.castShadow = fine;
    if (this.ground) this.ground.visible = fine;
    this.world.traverse((mesh) => {
      const { rough, fine: whole } = mesh.isMesh ? mesh.geometry.userData : {};
      if (fine ? whole : rough) mesh.geometry = fine ? whole : rough;
    });
    this.draw();
  }

  // ms between words while something is dragged: without a graphics card they cost as much as pictures.
  words() {
    return this.thrifty ? 400 : 150;
  }

  // Called whenever the picture changes.
  moved() {
    this.draw();
    if (!this.thrifty) return;
    this.quality(false);
    clearTimeout(this.rest);
    this.rest = setTimeout(() => this.quality(true), 350);
  }

  light() {
    const T = MeshCat.THREE, world = this.world;
    world.add(new T.HemisphereLight(0xffffff, 0x9298a3, 0.72));
    this.key = new T.DirectionalLight(0xfff2e2, 0.62);
    this.key.castShadow = true;
    this.key.shadow.mapSize.set(1024, 1024);
    this.key.shadow.bias = -0.0008;
    this.key.shadow.normalBias = 0.01;
    const fill = new T.DirectionalLight(0xdfe9ff, 0.3);
    fill.position.set(-4, 5, 3);
    world.add(this.key, this.key.target, fill);
  }

  // Put floor, light and camera around a box (cell coordinates), looking across the line of the bases.
  frame(box, across) {
    const T = MeshCat.THREE, centre = box.getCenter(new T.Vector3()), size = box.getSize(new T.Vector3());
    const radius = 0.5 * size.length();
    Object.assign(this, { box, across, centre, radius, bottom: box.min.z });
    if (this.floor) this.world.remove(this.floor);
    this.floor = new T.Group();
    const ground = (this.ground = new T.Mesh(new T.CircleGeometry(radius * 3, 64), new T.ShadowMaterial({ opacity: 0.22 })));
    ground.receiveShadow = true;
    ground.renderOrder = -2;
    const step = [0.05, 0.1, 0.25, 0.5, 1, 2.5, 5].find((s) => radius / s < 6) || 10;
    const count = 2 * Math.ceil((radius * 2) / step);
    const grid = new T.GridHelper(count * step, count, 0x808894, 0x808894);
    grid.material.transparent = true;
    grid.material.opacity = 0.26;
    grid.material.depthWrite = false;
    grid.rotation.x = Math.PI / 2;
    grid.position.z = 0.001;
    grid.renderOrder = -1;
    this.floor.add(ground, grid);
    this.floor.position.set(Math.round(centre.x / step) * step, Math.round(centre.y / step) * step, box.min.z);
    this.world.add(this.floor);
    const light = this.key;
    light.target.position.copy(centre);
    light.position.copy(centre).add(new T.Vector3(-0.5, -0.75, 1.5).multiplyScalar(radius * 1.6));
    const s = light.shadow.camera;
    Object.assign(s, { left: -radius * 1.3, right: radius * 1.3, top: radius * 1.3, bottom: -radius * 1.3, near: 0.05, far: radius * 6 });
    s.updateProjectionMatrix();
    this.look("corner");
  }

  // view: corner, front, side, top; or close, with the point to look at.
  look(view, point) {
    const T = MeshCat.THREE, along = this.across.clone().setZ(0);
    if (along.length() < 1e-3) along.set(1, 0, 0);
    along.normalize();
    const front = new T.Vector3(along.y, -along.x, 0);
    const turned = (a, up) => front.clone().multiplyScalar(Math.cos(a)).addScaledVector(along, Math.sin(a)).setZ(up);
    const directions = { corner: turned(0.42, 0.42), front: turned(0, 0.12), side: turned(Math.PI / 2, 0.2), top: turned(0, 20), close: turned(0.5, 0.55) };
    const at = view === "close" ? point : this.centre;
    const camera = this.viewer.camera, toward = directions[view].normalize();
    const eye = toward.clone().multiplyScalar(view === "close" ? this.radius * 0.8 : this.distance(toward)).add(at);
    // meshcat's world is z up inside a y up scene.
    this.viewer.controls.target.set(at.x, at.z, -at.y);
    camera.position.set(eye.x, eye.z, -eye.y);
    camera.near = this.radius / 200;
    camera.far = this.radius * 60;
    this.viewer.controls.update();
    this.turned = false;
    this.draw();
  }

  // From how far the whole box fills the picture, seen along `toward`.
  distance(toward) {
    const T = MeshCat.THREE, camera = this.viewer.camera, tan = Math.tan((camera.fov * Math.PI) / 360);
    const right = new T.Vector3(-toward.y, toward.x, 0).normalize(), up = toward.clone().cross(right);
    const corner = new T.Vector3();
    let far = 0;
    for (let k = 0; k < 8; k++) {
      corner.set(k & 1 ? this.box.max.x : this.box.min.x, k & 2 ? this.box.max.y : this.box.min.y, k & 4 ? this.box.max.z : this.box.min.z).sub(this.centre);
      const near = corner.dot(toward), x = Math.abs(corner.dot(right)), y = Math.abs(corner.dot(up));
      far = Math.max(far, near + y / (0.86 * tan), near + x / (0.94 * tan * camera.aspect));
    }
    return far;
  }

  fit() {
    const w = this.element.clientWidth, h = this.element.clientHeight;
    if (!w || !h) return;
    this.viewer.camera.fov = 38;
    this.viewer.set_3d_pane_size(w, h);
    if (this.resized) this.resized();
  }

  draw() {
    this.viewer.set_dirty();
  }
};

DA.softwareRendering = function () {
  const gl = document.createElement("canvas").getContext("webgl");
  const info = gl && gl.getExtension("WEBGL_debug_renderer_info");
  const name = info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : "";
  if (gl) gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
};
