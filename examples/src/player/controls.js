// Time, mouse and keys. `window.player` lets scripts do what a user can: play(), pause(), seek(seconds),
// showSpheres(on), and read `time`, `duration`, `playing`. A page opened as page.html#t=2.5 stands still at 2.5 s.

const FIELD_OF_VIEW = 30 * Math.PI / 180;
const element = (id) => document.getElementById(id);

function fail(text) {
  element("failure").textContent = text;
  element("failure").hidden = false;
}

function start() {
  const canvas = element("view");
  const recording = openRecording();
  const renderer = createRenderer(canvas, recording);
  if (!renderer) return fail("This page needs WebGL 2, which this browser does not offer. Try another browser or switch hardware acceleration on.");

  const state = { time: 0, speed: 1, playing: false, spheres: false, stale: true };
  // From the side that the pictures are taken from; a ball around the scene would need 1 / sin(15°) = 3.9 radii.
  const first = { turn: 0.52, tilt: 0.76, distance: 3.3 * recording.radius, target: recording.center };
  const camera = { ...first };

  function view() {
    const { turn, tilt, distance, target } = camera;
    const away = [Math.sin(turn) * Math.cos(tilt), Math.sin(tilt), Math.cos(turn) * Math.cos(tilt)];
    const eye = add(target, away, distance);
    const near = Math.max(0.01 * distance, distance - 12 * recording.radius);
    const lens = perspective(FIELD_OF_VIEW, canvas.width / canvas.height, near, distance + 40 * recording.radius);
    return { eye, projection: multiply(lens, lookAt(eye, target, [0, 1, 0])) };
  }

  function seek(time) {
    state.time = Math.min(Math.max(time, 0), recording.duration);
    state.stale = true;
  }

  function setPlaying(playing) {
    if (playing && state.time >= recording.duration) seek(0);
    state.playing = playing;
    element("play").classList.toggle("playing", playing);
    element("play").setAttribute("aria-label", playing ? "Pause" : "Play");
  }

  function setSpheres(on) {
    state.spheres = on;
    state.stale = true;
    element("spheres").setAttribute("aria-pressed", on);
  }

  function resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.max(1, Math.round(n * ratio)));
    if (canvas.width !== width || canvas.height !== height) {
      [canvas.width, canvas.height] = [width, height];
      drawCurve();
      state.stale = true;
    }
  }

  // Kinetic energy over time, behind the scrubber.
  function drawCurve() {
    const curve = element("curve"), context = curve.getContext("2d");
    [curve.width, curve.height] = [2 * curve.clientWidth, 2 * curve.clientHeight];
    const energy = Array.from({ length: recording.steps }, (_, step) => recording.figures[4 * step] || 0);
    const most = Math.sqrt(Math.max(...energy, 1e-12));
    context.fillStyle = "rgba(0, 114, 178, 0.22)";
    context.beginPath();
    context.moveTo(0, curve.height);
    energy.forEach((value, step) => context.lineTo(
      recording.times[step] / (recording.duration || 1) * curve.width,
      curve.height * (1 - Math.sqrt(value) / most)));
    context.lineTo(curve.width, curve.height);
    context.fill();
  }

  function showFigures() {
    const [energy, deepest, contacts, awake] = recording.figures.subarray(4 * recording.stepAt(state.time));
    const rows = Number.isNaN(energy) ? [] : [
      ["Kinetic energy", energy.toFixed(energy < 10 ? 3 : 1) + " J"],
      ["Deepest overlap", (1e3 * deepest).toFixed(2) + " mm"],
      ["Contacts", contacts.toFixed(0)],
      ["Bodies awake", awake.toFixed(0)],
    ];
    const list = element("figures");
    if (list.children.length !== 2 * rows.length) {
      list.replaceChildren(...rows.flatMap(() => [document.createElement("dt"), document.createElement("dd")]));
    }
    rows.forEach(([name, value], row) => {
      list.children[2 * row].textContent = name;
      list.children[2 * row + 1].textContent = value;
    });
    element("clock").textContent = `${state.time.toFixed(2)} / ${recording.duration.toFixed(2)} s`;
    element("scrubber").value = state.time;
  }

  let last = performance.now();
  function frame(now) {
    const passed = Math.min((now - last) / 1e3, 0.1);
    last = now;
    if (state.playing) {
      seek(state.time + state.speed * passed);
      if (state.time >= recording.duration) setPlaying(false);
    }
    resize();
    if (state.stale) {
      state.stale = false;
      renderer.draw(state.time, view(), state.spheres);
      showFigures();
    }
    requestAnimationFrame(frame);
  }

  function zoom(factor) {
    camera.distance = Math.min(Math.max(camera.distance * factor, 0.1 * recording.radius), 30 * recording.radius);
    state.stale = true;
  }

  function turn(x, y) {
    camera.turn -= 0.006 * x;
    camera.tilt = Math.min(Math.max(camera.tilt + 0.006 * y, -0.2), 1.54);
  }

  // Moves the target with the pointer, in the plane of the picture.
  function move(x, y) {
    const { turn, tilt, distance } = camera;
    const length = 2 * distance * Math.tan(FIELD_OF_VIEW / 2) / canvas.clientHeight;
    const right = [Math.cos(turn), 0, -Math.sin(turn)];
    const up = [-Math.sin(turn) * Math.sin(tilt), Math.cos(tilt), -Math.cos(turn) * Math.sin(tilt)];
    camera.target = add(add(camera.target, right, -x * length), up, y * length);
  }

  const pointers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = [event.clientX, event.clientY];
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) {
      const length = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]) || 1;
      zoom(length(before) / length(now));
    } else if (event.shiftKey || event.buttons & 6) {
      move(now[0] - before[0], now[1] - before[1]);
    } else {
      turn(now[0] - before[0], now[1] - before[1]);
    }
    pointers.set(event.pointerId, now);
    state.stale = true;
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(0.0012 * event.deltaY));
  }, { passive: false });

  const home = () => { Object.assign(camera, first); state.stale = true; };
  element("play").addEventListener("click", () => setPlaying(!state.playing));
  element("spheres").addEventListener("click", () => setSpheres(!state.spheres));
  element("home").addEventListener("click", home);
  element("speed").addEventListener("change", (event) => { state.speed = Number(event.target.value); });
  element("scrubber").addEventListener("input", (event) => { setPlaying(false); seek(Number(event.target.value)); });
  window.addEventListener("keydown", (event) => {
    if (event.target.matches("select, button") && event.key === " ") return;
    const keys = {
      " ": () => setPlaying(!state.playing),
      s: () => setSpheres(!state.spheres),
      h: home,
      ArrowLeft: () => { setPlaying(false); seek(state.time - (event.shiftKey ? 1 : 1 / 60)); },
      ArrowRight: () => { setPlaying(false); seek(state.time + (event.shiftKey ? 1 : 1 / 60)); },
      Home: () => seek(0),
      End: () => seek(recording.duration),
    };
    if (!keys[event.key] || event.target.matches("select")) return;
    event.preventDefault();
    keys[event.key]();
  });

  document.title = recording.title;
  element("title").textContent = recording.title;
  element("about").textContent = `${recording.bodies.length} bodies, ${recording.steps} steps`;
  element("scrubber").max = recording.duration;
  element("spheres").hidden = recording.packings.length === 0;
  const asked = /[#&]t=([0-9.]+)/.exec(location.hash);
  if (asked) seek(Number(asked[1]));
  setPlaying(!asked && !window.matchMedia("(prefers-reduced-motion: reduce)").matches);
  window.player = {
    play: () => setPlaying(true),
    pause: () => setPlaying(false),
    seek: (time) => { setPlaying(false); seek(time); },
    showSpheres: setSpheres,
    get time() { return state.time; },
    get playing() { return state.playing; },
    duration: recording.duration,
  };
  requestAnimationFrame(frame);
}

try {
  start();
} catch (error) {
  fail("The recording cannot be shown: " + error.message);
  throw error;
}
