// Unpack, start the viewer, hand out `window.dualarm`:
//   ready          promise, done when the first picture is there
//   runs           labels of the runs
//   links          names of the links (and the tips e1, e2)
//   seek(t)        go to t in [0, 1], 0 the first path point and 1 the last; linear in between
//   time()         where we are, in [0, 1]
//   play() pause() speed(x)
//   select(k)      show run k
//   layout(mode)   "one", "overlay" or "side"; compare(k, on) chooses the others
//   show(name, on) visual collision path frames direction force velocity distance ghosts traces hold
//   look(view)     corner front side top close
//   linkPose(name) {position: [x, y, z] m, quaternion: [x, y, z, w]} in the world of the cell
//   nearest()      {names, distance [m], lacking}: the nearest bodies here, those too near
//   index()        index at this place, interpolated
//   design         on a page that `dualarm-pin design` serves: see design.js
//   seconds()      time of the motion at this place [s]; null without a motion
window.dualarm = {};
window.dualarm.ready = (async () => {
  const fail = (text) => {
    document.body.prepend(DA.h("p", { class: "fail" }, text));
    throw new Error(text);
  };
  if (!("DecompressionStream" in window)) fail("This browser is too old for this page: Chrome 80, Firefox 113 or Safari 16.4 is needed.");
  // The library is a classic script: it runs from a blob of this page, so nothing is fetched.
  const url = URL.createObjectURL(new Blob([await DA.unsqueeze("viewer")], { type: "text/javascript" }));
  await new Promise((done, failed) => document.head.append(Object.assign(document.createElement("script"), { src: url, onload: done, onerror: failed })));
  URL.revokeObjectURL(url);
  const head = DA.unpack(await DA.unsqueeze("data"));
  const player = new DA.Player(document.getElementById("player"), head, { strip: !head.results && !head.design, title: head.title });
  Object.assign(window.dualarm, {
    runs: head.runs.map((run) => run.label),
    links: [...player.on_stage[0].robot.frames.keys()],
    seek: (t) => player.seek(t),
    time: () => player.t,
    play: () => player.play(),
    pause: () => player.pause(),
    speed: (x) => (player.speed = x),
    select: (k) => player.select(k),
    layout: (mode) => player.layout(mode),
    compare: (k, on) => player.compare(k, on),
    show: (name, on) => player.toggleShow(name, on),
    look: (view) => player.look(view),
    linkPose: (name) => player.on_stage[0].robot.linkPose(name),
    nearest: () => {
      const near = player.on_stage[0].nearest && player.on_stage[0].nearest.at(player.t);
      return near && { names: near.pair.names, distance: near.value, lacking: near.lacking };
    },
    index: () => DA.between(player.on_stage[0].index, 1, player.t * (player.on_stage[0].h - 1))[0],
    seconds: () => (player.run.motion ? player.secondsAt(player.t) : null),
    player,
  });
  if (head.results) DA.report(player, head);
  if (head.design) window.dualarm.design = new DA.Design(player, head);
  document.documentElement.dataset.ready = "yes";
})();
