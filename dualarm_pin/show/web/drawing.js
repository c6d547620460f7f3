// Which poses are drawn: one that would be older than DA.oldest on the screen is left out while
// newer ones come. How long answers and pictures take is measured as they come; the slowest of the
// last second counts: a mean would let every other one be too late, and one slow one is forgotten.
DA.oldest = 150; // ms
DA.tick = 1000 / 60; // ms
DA.swift = 25; // ms; where answers take longer, less is asked of each
DA.Lately = class {
  constructor() {
    this.seen = [];
  }

  add(ms) {
    this.seen.push([performance.now(), ms]);
  }

  sorted() {
    const since = performance.now() - 1000;
    this.seen = this.seen.filter(([at]) => at > since);
    return this.seen.map(([, ms]) => ms).sort((a, b) => a - b);
  }

  slowest() {
    return this.sorted().at(-1) ?? 0;
  }

  middle() {
    const ms = this.sorted();
    return ms[ms.length >> 1] ?? 0;
  }
};

DA.Drawing = class {
  // newer(): whether another pose is on its way.
  constructor(player, newer) {
    Object.assign(this, { player, newer, fresh: null, pictures: new DA.Lately(), answers: new DA.Lately(), ages: [], late: 0, behind: 0 });
    player.stage.viewer.render = () => this.draw();
  }

  // A picture takes a frame at least, and may just miss one that the slowest of late did not.
  tooOld(asked) {
    return performance.now() - asked + Math.max(this.pictures.slowest(), DA.tick) + DA.tick > DA.oldest;
  }

  answered(ms) {
    this.answers.add(ms);
  }

  hurried() {
    return this.answers.slowest() > DA.swift;
  }

  // A promise, done when the next pose may be asked for. Where pictures take longer than answers, one
  // asked for before the last is being drawn would never be seen, and only keep the processor. (It
  // is done soon where nothing is drawn, as nobody looks at the page.)
  mayAsk() {
    if (this.fresh === null || this.answers.middle() > this.pictures.middle()) return Promise.resolve();
    return new Promise((done) => {
      this.begins = done;
      setTimeout(done, DA.oldest);
    });
  }

  leaveOut() {
    this.late += 1;
    this.behind += 1;
  }

  // The scene now has the pose that was asked for at that time.
  has(asked) {
    this.fresh = asked;
  }

  draw() {
    const asked = this.fresh, begun = performance.now();
    this.fresh = null;
    if (this.begins) this.begins();
    if (asked !== null && this.newer() && this.tooOld(asked)) {
      this.player.stage.viewer.needs_render = false;
      this.leaveOut();
      return;
    }
    this.player.render();
    if (asked === null) return;
    this.behind = 0;
    // It is out when the next frame begins.
    requestAnimationFrame(() => {
      const now = performance.now();
      this.ages.push(now - asked);
      this.pictures.add(now - begun);
    });
  }
};
