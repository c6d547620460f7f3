// The design page: what is moved goes to the server, and the motion that comes back is shown.
// One request is in flight at a time; meanwhile only the newest state waits. window.dualarm.design:
//   set(change)    move: {"base2.x": 0.1, ...} from where the cell stood [m, rad]; then commit()
//   commit()       end of a change: the full search runs, and `undo` comes back to before it
//   undo() redo() idle()  idle: a promise, done when nothing is asked and no search runs
//   shown          what came back last
//   drawing        see drawing.js; `ages`: ms from each pose to its picture, `late`: how many were left
//                  out while newer ones came, because they were too old
DA.Design = class {
  constructor(player, head) {
    const task = head.design;
    Object.assign(this, { player, head, task, history: [], future: [], variants: [], shown: null });
    this.state = { change: {}, smoothness: task.smoothness, clearance: null, limits: {} };
    for (const name of task.parameters) this.state.change[name] = 0;
    this.view = player.on_stage[0];
    this.start = { objective: task.objective, index: Float32Array.from(this.view.index) };
    this.range = player.range();
    this.motion = null; // number of the motion that was found here
    this.target = this.has("base2") ? "base2" : "workpiece";
    this.drawing = new DA.Drawing(player, () => this.moving);
    const words = () => player.stage.words();
    this.tellLess = DA.seldom(() => this.tellNow(), words);
    this.figuresLess = DA.seldom(() => this.tellFigures(), () => 2 * words()); // curves cost most
    this.markLess = DA.seldom(() => this.markNow(), words);
    this.gizmo = new DA.Gizmo(player.stage, player.reach * 0.2, {
      begin: () => this.begin(),
      move: (at) => this.dragged(at),
      end: () => this.commit(),
    });
    this.build();
    this.keys();
    this.choose(this.target);
    this.ask({ search: true });
  }

  has(group) {
    return this.task.parameters.some((name) => name.startsWith(`${group}.`));
  }

  axes() {
    return ["x", "y", "z", "yaw"].filter((axis) => `${this.target}.${axis}` in this.state.change);
  }

  // ---- changes
  choose(target) {
    this.target = target;
    this.gizmo.attach(target === "base2" ? this.view.group : this.view.e1(), this.axes());
    this.placeGizmo();
    this.mark();
  }

  standing(name) {
    return this.task.standing[name] || 0; // base 2 is shown in the world, the rest from where it was
  }

  placeGizmo() {
    if (this.gizmo.held) return;
    const at = {};
    for (const axis of ["x", "y", "z", "yaw"]) {
      const name = `${this.target}.${axis}`;
      at[axis] = this.standing(name) + (this.state.change[name] || 0);
    }
    this.gizmo.place(at);
  }

  dragged(at) {
    for (const axis of this.axes()) {
      const name = `${this.target}.${axis}`;
      this.state.change[name] = at[axis] - this.standing(name);
    }
    this.follow();
  }

  set(change) {
    this.begin();
    Object.assign(this.state.change, change);
    this.placeGizmo();
    this.follow();
  }

  begin() {
    this.before = this.before || { state: structuredClone(this.state), motion: this.motion };
  }

  follow() {
    this.motion = null;
    this.mark();
    this.ask({});
  }

  commit() {
    const before = this.before;
    this.before = null;
    if (before && JSON.stringify(before.state) !== JSON.stringify(this.state)) this.past(before);
    this.mark();
    this.ask({ search: true });
  }

  // What lies behind can be undone; what was undone before it is gone.
  past(before) {
    this.history.push(before);
    this.future = [];
  }

  undo() {
    this.step(this.history, this.future);
  }

  redo() {
    this.step(this.future, this.history);
  }

  step(from, to) {
    if (!from.length) return;
    to.push({ state: structuredClone(this.state), motion: this.motion });
    this.restore(from.pop());
  }

  restore({ state, motion }) {
    this.before = null;
    this.state = structuredClone(state);
    this.motion = null;
    this.placeGizmo();
    this.mark();
    this.ask({ search: true, motion });
  }

  // ---- talking
  async post(path, message) {
    const answer = await fetch(path, {
      method: "POST",
      headers: { "Content-Type": "application/json", [this.task.header]: this.task.token },
      body: JSON.stringify({ page: this.task.page, ...message }),
    });
    if (answer.ok) return new Uint8Array(await answer.arrayBuffer());
    let said = `the server answers ${answer.status}`;
    if (answer.headers.get("Content-Type") === "application/json") said = (await answer.json()).error;
    throw new Error(said);
  }

  ask({ search = false, motion = null }) {
    const waits = this.waiting || {};
    this.waiting = { search: search || Boolean(waits.search), motion: motion ?? waits.motion ?? null, at: performance.now() };
    if (!this.busy) this.talk();
  }

  async talk() {
    this.busy = this.moving = true;
    clearTimeout(this.later);
    try {
      while (this.waiting) {
        const { at, ...wish } = this.waiting, state = structuredClone(this.state);
        this.waiting = null;
        const sent = performance.now(), bytes = await this.post("/move", { state, hurried: this.drawing.hurried(), ...wish });
        this.drawing.answered(performance.now() - sent);
        // While more is moved, what would be seen too late is not drawn: the next is on its way.
        if (this.waiting && this.drawing.tooOld(at)) this.overtaken();
        else this.show(bytes, state, at);
        if (this.waiting) await this.drawing.mayAsk();
      }
      if (this.shown.searching) this.later = setTimeout(() => this.lookAgain(), 100);
    } catch (error) {
      this.fail(error);
    }
    this.busy = this.moving = false;
  }

  overtaken() {
    this.drawing.leaveOut();
    if (this.drawing.behind > 3) this.tell();
  }

  async lookAgain() {
    if (this.busy) return;
    this.busy = true;
    try {
      const state = structuredClone(this.state), bytes = await this.post("/look", { frame: this.shown.frame });
      if (!this.waiting) this.look(bytes, state);
    } catch (error) {
      this.fail(error);
    }
    this.busy = false;
    if (this.waiting) this.talk();
    else if (this.shown && this.shown.searching) this.later = setTimeout(() => this.lookAgain(), 100);
  }

  // What the search has come to meanwhile; nothing is drawn for nothing new.
  look(bytes, state) {
    const { same, searching } = DA.unpack(bytes);
    if (!same) this.show(bytes, state, null);
    else if (this.shown.searching !== searching) {
      this.shown.searching = searching;
      this.tell();
    }
  }

  fail(error) {
    this.broken = error.message === "Failed to fetch" ? "The server has ended: start dualarm-pin design again." : error.message;
    this.waiting = null;
    if (this.shown) this.shown.searching = false;
    this.player.stage.draw(); // one that was left out is the last now
    this.tell();
  }

  async idle() {
    while (this.busy || this.waiting || (this.shown && this.shown.searching)) await new Promise((done) => setTimeout(done, 20));
    return true;
  }

  // ---- what came back
  show(bytes, state, asked) {
    const head = DA.unpack(bytes), { view, player } = this;
    const before = this.shown;
    this.broken = null;
    this.shown = Object.assign(head, { state });
    if (head.found && head.found.found) this.motion = head.found.motion;
    if (before && before.basin !== head.basin && head.valid) this.changed = this.where(state);
    view.q.set(head.array(head.q));
    view.index.set(head.array(head.index));
    this.stand(state.change);
    DA.recolour(view.marks.path[0], view.index, this.range);
    player.stage.element.classList.toggle("stale", !head.valid);
    player.seek(player.t);
    this.placeGizmo();
    if (asked !== null) this.drawing.has(asked);
    if (before && before.valid !== head.valid) this.tellLess.now();
    else this.tell();
  }

  // Base, tool and workpiece where the shown motion has them.
  stand(change) {
    const T = MeshCat.THREE, of = (name) => change[name] || 0, { task, view } = this;
    const rides = task.rides || { joints: [], frames: [], bodies: [], tips: [] };
    const old = new T.Matrix4().set(...task.base.flat()), place = new T.Vector3().setFromMatrixPosition(old);
    const turn = new T.Matrix4().makeRotationZ(of("base2.yaw")), now = turn.clone().multiply(old);
    now.setPosition(place.x + of("base2.x"), place.y + of("base2.y"), place.z + of("base2.z"));
    const motion = now.multiply(old.invert());
    for (const robot of [view.robot, ...view.ends.map((end) => end.robot)]) robot.stand(rides, motion, task.tool_axis, of("tool2.length"));
    const piece = view.marks.path[0];
    piece.position.set(of("workpiece.x"), of("workpiece.y"), of("workpiece.z"));
    piece.rotation.set(0, 0, of("workpiece.yaw"));
  }

  where(state) {
    const name = `${this.target}.x`;
    return Object.entries(state.change).filter(([, by]) => Math.abs(by) > 1e-9).map(([key, by]) => DA.said(key, this.standing(key) + by)).join(", ") || `${name} as given`;
  }

  // ---- keys on the picture: arrows, page up and down, [ and ]
  keys() {
    const { canvas } = this.player, fine = (event) => (event.shiftKey ? 0.1 : 1);
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "application");
    canvas.setAttribute("aria-label", "The cell. Arrow keys shift what is chosen along x and y, page up and down along z, [ and ] turn it; with shift, a tenth.");
    const steps = { ArrowLeft: ["x", -0.01], ArrowRight: ["x", 0.01], ArrowDown: ["y", -0.01], ArrowUp: ["y", 0.01], PageDown: ["z", -0.01], PageUp: ["z", 0.01], "[": ["yaw", Math.PI / 180], "]": ["yaw", -Math.PI / 180], "{": ["yaw", Math.PI / 180], "}": ["yaw", -Math.PI / 180] };
    canvas.addEventListener("keydown", (event) => {
      const [axis, by] = steps[event.key] || [], name = `${this.target}.${axis}`;
      if (!axis || !(name in this.state.change) || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      event.stopPropagation();
      this.set({ [name]: this.state.change[name] + by * fine(event) });
    });
    canvas.addEventListener("keyup", () => this.before && this.commit());
    canvas.addEventListener("blur", () => this.before && !this.gizmo.held && this.commit());
    document.addEventListener("keydown", (event) => {
      const key = event.key.toLowerCase(), again = key === "y" || (key === "z" && event.shiftKey);
      if (!(event.ctrlKey || event.metaKey) || event.altKey || !(again || key === "z") || event.target.matches("input[type=text]")) return;
      event.preventDefault();
      if (again) this.redo();
      else this.undo();
    });
  }
};
