// The live page: hears the run over a WebSocket, shows its newest frame or the one that is looked at.

import { Actions } from "./actions.js";
import { History } from "./history.js";
import { isLockedOut, LOCKED_OUT } from "./knock.js";
import { Events, element, showEnding, showHealth, showPosture, showStatus, showTold, showTrust } from "./panel.js";
import { everyone, People } from "./people.js";
import { INKS, Plot } from "./plot.js";
import { Room } from "./room.js";
import { View } from "./views.js";

const AGAIN_MS = 500; // between two tries to reach the run
const PLOT_MS = 100; // between two drawings of the plot
const MOST_CHOSEN = 4;
const CHOSEN = ["r_shoulder_z", "l_shoulder_z", "r_knee_x", "l_knee_x"];

const at = (id) => document.getElementById(id);
const history = new History();
const plot = new Plot(at("plot"), history);
const events = new Events((seconds) => { history.seekTime(seconds); refresh(); });
let greeting, people, room, actions, socket;
let views = [];
let [dirty, plotted, before] = [false, 0, 0];

const heard = {
  hello(told) {
    if (greeting) { // after a pause of the connection
      if (told.run !== greeting.run) location.reload();
      return;
    }
    greeting = told;
    at("title").textContent = told.title;
    document.title = `${told.title} · tritrack`;
    people = new People(at("everyone"), told.people, refresh);
    plot.of = (frame) => people.of(frame);
    room = new Room(at("room"), told.cylinders, told.cameras);
    actions = new Actions(told.commands, (what) => { if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ what })); });
    chooser(told.angles);
  },
  room(told) {
    room.setCameras(told);
    if (views.length !== told.cameras.length) {
      at("views").replaceChildren();
      document.body.classList.toggle("strip", told.cameras.length > 2);
      views = told.cameras.map((_, i) => new View(greeting.cameras[i], at("views")));
    }
    refresh();
  },
  frame(frame) {
    if (!history.add(frame)) return;
    frame.events.forEach((event) => events.add(event));
    refresh();
  },
  health(told) { showHealth(told.pulses); },
  told(told) { actions.told(told); showTold(told.well, told.text); },
  over(told) {
    if (history.over) return;
    history.over = true;
    history.follow();
    actions.end();
    at("live").hidden = true;
    at("health").hidden = !at("processes").children.length; // a recording has no processes
    showEnding(told.facts, history.frames);
    showTold(true, "");
    refresh();
  },
};

function connect() {
  socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/live`);
  socket.addEventListener("message", ({ data }) => {
    const told = JSON.parse(data);
    heard[told.kind]?.(told);
  });
  socket.addEventListener("close", async () => {
    const waiting = history.frames.length ? "the run does not answer" : "waiting for the run";
    const words = (await isLockedOut()) ? LOCKED_OUT : waiting;
    if (!history.over) showStatus("gone", words);
    setTimeout(connect, AGAIN_MS);
  });
}

function refresh() { dirty = true; }

function draw(now_ms) {
  requestAnimationFrame(draw);
  if (history.advance((now_ms - before) / 1000)) refresh();
  before = now_ms;
  if (!dirty) return;
  dirty = false;
  const frame = history.shown;
  if (frame) show(frame);
  room?.draw();
  if (!history.following || now_ms - plotted > PLOT_MS) {
    plotted = now_ms;
    plot.draw();
    keys(frame);
  }
}

function show(frame) {
  document.body.dataset.frame = frame.frame;
  document.body.dataset.drawn = Number(document.body.dataset.drawn ?? 0) + 1;
  people.show(history);
  const looked = people.of(frame);
  const coloured = everyone(frame).map((one) => ({ ...one, colour: people.colour(one.person) }));
  views.forEach((view, i) => view.show(frame.views[i] ?? null, coloured.map((one) => ({ ...one, fit: one.views[i] })), looked.views[i], greeting));
  room.show(coloured);
  showPosture(looked, people.colour(looked.person));
  actions.alone(!people.several && /^\d$/.test(frame.from_views)); // of several, nobody is turned about
  showTrust(frame.trust);
  const words = looked.person ? `person ${looked.person}: ${looked.words}` : looked.words;
  showStatus(history.over ? "over" : looked.status, history.over ? "the run is over: this is its recording" : history.following ? words : `looking back; the run goes on`);
  const scrub = at("scrub");
  scrub.max = history.frames.length - 1;
  scrub.value = history.at;
  scrub.setAttribute("aria-valuetext", `frame ${frame.frame}, ${frame.time_s.toFixed(1)} seconds`);
  at("clock").textContent = history.following ? `${frame.time_s.toFixed(1)} s` : `${frame.time_s.toFixed(2)} of ${history.span[1].toFixed(2)} s`;
  const moves = history.following || history.playing;
  at("play").textContent = moves ? "❚❚" : "▶";
  at("play").setAttribute("aria-label", moves ? "pause" : "play");
  at("live").setAttribute("aria-pressed", history.following);
}

function chooser(angles) {
  const chosen = CHOSEN.filter((name) => angles.includes(name));
  const boxes = angles.map((name) => {
    const box = Object.assign(document.createElement("input"), { type: "checkbox", name, checked: chosen.includes(name) });
    const label = element("label", "");
    label.append(box, name.replaceAll("_", " "));
    at("angles").append(label);
    return box;
  });
  const update = () => {
    const on = boxes.filter((box) => box.checked);
    boxes.forEach((box) => { box.disabled = !box.checked && on.length >= MOST_CHOSEN; });
    plot.chosen = on.map((box) => angles.indexOf(box.name));
    at("keys").replaceChildren(...on.map((box, i) => {
      const key = element("span", box.name.replaceAll("_", " "));
      key.style.color = INKS[i];
      key.append(document.createElement("output"));
      return key;
    }));
    plotted = 0;
    refresh();
  };
  at("angles").addEventListener("change", update);
  update();
}

function keys(frame) {
  plot.chosen.forEach((angle, i) => {
    const value = frame && people.of(frame).angles[angle];
    at("keys").children[i].firstElementChild.textContent = value === undefined ? "–" : `${Math.round(value) || 0}°`; // no -0
  });
}

function step(frames) { history.playing = false; history.seek(history.at + frames); refresh(); }
function toggle() { history.toggle(); refresh(); }
function follow() { history.follow(); refresh(); }

at("play").addEventListener("click", toggle);
at("live").addEventListener("click", follow);
at("scrub").addEventListener("input", (event) => { history.playing = false; history.seek(Number(event.target.value)); refresh(); });
at("speed").addEventListener("change", (event) => { history.speed = Number(event.target.value); });

function look(event) {
  if (event.type === "pointermove" && !event.buttons) return;
  history.playing = false;
  history.seekTime(plot.timeAt(event.offsetX));
  refresh();
}
at("plot").addEventListener("pointerdown", look);
at("plot").addEventListener("pointermove", look);

at("room").addEventListener("pointermove", (event) => {
  if (!event.buttons) return;
  room.move(-event.movementX / 160, event.movementY / 200, 1);
  refresh();
});
at("room").addEventListener("wheel", (event) => { event.preventDefault(); room.move(0, 0, Math.exp(event.deltaY / 800)); refresh(); }, { passive: false });
const TURNS = { ArrowLeft: [-0.1, 0, 1], ArrowRight: [0.1, 0, 1], ArrowUp: [0, 0.07, 1], ArrowDown: [0, -0.07, 1], "+": [0, 0, 0.9], "-": [0, 0, 1.1] };
at("room").addEventListener("keydown", (event) => {
  if (!(event.key in TURNS)) return;
  event.preventDefault();
  event.stopPropagation();
  room.move(...TURNS[event.key]);
  refresh();
});

const KEYS = {
  " ": toggle, l: follow, Home: () => step(-history.frames.length), End: () => step(history.frames.length),
  ArrowLeft: (event) => step(event.shiftKey ? -15 : -1), ArrowRight: (event) => step(event.shiftKey ? 15 : 1),
  r: () => press("record"), s: () => press("save"),
};
function press(id) { if (!at("actions").hidden) at(id).click(); }
addEventListener("keydown", (event) => {
  if (event.target.tagName === "SELECT") return; // letters choose there
  const own = /^(INPUT|BUTTON|SUMMARY)$/.test(event.target.tagName);
  if (event.ctrlKey || event.altKey || event.metaKey || !(event.key in KEYS) || (own && event.key.length > 1) || (own && event.key === " ")) return;
  event.preventDefault();
  KEYS[event.key](event);
});
addEventListener("resize", () => { plotted = 0; refresh(); });

connect();
requestAnimationFrame(draw);
