// The marking page: what is clicked goes to the server, which answers with what it gives.

import { Board } from "./board.js";
import { isLockedOut, LOCKED_OUT } from "./knock.js";
import { element, label, Numbers, Points, READ_PX, showResult } from "./lists.js";
import { drawMarks, drawPicture, INKS, Lens, penOf } from "./picture.js";
import { drawPlan } from "./plan.js";

const AGAIN_MS = 500; // between two tries to reach the server
const NEW_MS = 250; // between two pictures of a camera that runs
const LOUPE = 8;
const NEAR_PX = 12; // of the screen: so near a point is meant, not another place
const DRAG_PX = 4;
const FINE_PX = 0.25;
const FAR_PX = 8;

const at = (id) => document.getElementById(id);
const [me, canvas, loupe] = [Math.random().toString(36).slice(2), at("view"), at("loupe")];
let board, lens, points, numbers, socket;
let solved = { cameras: [], names: [], plan: null, worst: "", worst_at: null, whole: false };
let stills = []; // of each camera: which is shown, and its image
let [count, flying, waiting] = [0, 0, false]; // sheets: said, not answered yet, changed since
let pointed = null; // the pixel under the pointer
let [dirty, saved] = [false, true];

const heard = {
  hello(hello) {
    if (board) {
      if (hello.run !== board.hello.run) location.reload();
      return;
    }
    board = new Board(hello);
    lens = hello.pictures.map(() => new Lens(canvas, hello.size));
    stills = hello.pictures.map(() => ({ place: 0, image: null }));
    [points, numbers] = [new Points(board, act), new Numbers(board, act)];
    at("title").textContent = `${hello.title}: ${hello.method}`;
    document.title = `${hello.method} · ${hello.title} · tritrack`;
    canvas.style.aspectRatio = `${hello.size[0]} / ${hello.size[1]}`;
    at("cameras").replaceChildren(...hello.pictures.map(({ number }, i) => {
      const tab = element("button", `camera ${number}`);
      tab.addEventListener("click", () => look(i));
      return tab;
    }));
    at("adding").replaceChildren(...Object.keys(hello.hints).map((kind) => {
      const add = element("button", kind === "pole" ? "Add a pole" : `Add a point on the ${kind}`);
      add.addEventListener("click", () => act(() => board.sheet.marks.length < hello.most_marks
        && board.add({ kind, px: [null, null], at_m: kind === "pole" ? [0, 0] : null })));
      return add;
    }));
    at("save").hidden = !hello.writes;
    at("save").textContent = `Save ${hello.writes}`;
    hello.pictures.forEach((_, i) => load(i));
    setInterval(() => { if (running() && at("hold").ariaPressed === "false") load(board.camera); }, NEW_MS);
    look(0);
  },
  shown(shown) {
    const own = shown.by === me;
    if (own && shown.count === flying) flying = 0;
    if (!own && !(flying || waiting)) board.sheet = shown.sheet;
    solved = shown.solved;
    at("kept").textContent = shown.kept;
    at("kept").className = shown.well ? "" : "bad";
    document.body.dataset.shown = own ? shown.count : 0;
    say();
    refresh();
  },
  told({ text, well }) {
    flying = 0;
    saved = well || saved;
    at("told").textContent = text;
    at("told").className = well ? "" : "bad";
    say();
    refresh();
  },
};

function connect() {
  socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/live`);
  socket.addEventListener("open", () => { waiting ||= flying > 0; flying = 0; status("tracking", "ready"); });
  socket.addEventListener("message", ({ data }) => {
    const told = JSON.parse(data);
    heard[told.kind]?.(told);
  });
  socket.addEventListener("close", async () => {
    status("gone", (await isLockedOut()) ? LOCKED_OUT : "tritrack does not answer: it was ended, or is still to start");
    setTimeout(connect, AGAIN_MS);
  });
}

function status(state, words) {
  at("status").dataset.status = state;
  at("words").textContent = words;
}

/** Say the newest sheet, one at a time: of many changes in a row the last is enough. */
function say() {
  if (!waiting || flying || socket.readyState !== WebSocket.OPEN) return;
  [waiting, flying] = [false, ++count];
  socket.send(JSON.stringify({ type: "marked", sheet: board.sheet, by: me, count }));
}

/** Do something to the board; what it changed is said. */
function act(change, follow = false) {
  const before = board.sheet;
  change();
  if (board.sheet !== before) {
    [waiting, saved] = [true, !board.hello.writes];
    at("told").textContent = "";
    say();
  }
  if (follow && board.picked !== null) lens[board.camera].show(board.at(board.picked));
  refresh();
}

function refresh() {
  if (!dirty) requestAnimationFrame(draw);
  dirty = true;
}

const running = () => Boolean(board?.hello.pictures[board.camera].runs);

function load(camera) {
  const { stills: addresses, runs } = board.hello.pictures[camera];
  const still = stills[camera];
  if (still.loading || !addresses.length) return;
  const image = new Image();
  still.loading = true;
  image.src = runs ? `${addresses[0]}?${Date.now()}` : addresses[still.place];
  const wanted = still.place;
  image.decode().then(() => { still.image = image; }, () => {}).finally(() => {
    still.loading = false;
    if (still.place !== wanted) load(camera);
    document.body.dataset.loaded = stills.filter((each) => each.image).length;
    refresh();
  });
}

function look(camera) {
  if (!board.hello.pictures[camera]) return;
  if (board.camera !== camera) [board.picked, board.wanted] = [null, 0];
  board.camera = camera;
  pointed = null;
  refresh();
}

function scrub(by) {
  const { stills: addresses } = board.hello.pictures[board.camera];
  stills[board.camera].place = Math.max(0, Math.min(addresses.length - 1, by));
  load(board.camera);
  refresh();
}

function draw() {
  dirty = false;
  if (!board) return;
  const { hello, camera } = board;
  const { number, stills: addresses, frames, runs } = hello.pictures[camera];
  const [still, through] = [stills[camera], lens[camera]];
  through.panBy(0, 0);
  [...at("cameras").children].forEach((tab, i) => { tab.ariaPressed = i === camera; });
  const seen = solved.cameras[camera];
  const marks = board.sheet.marks.map((mark, i) => ({
    at: board.at(i), ink: INKS[mark.kind], label: label(board, solved.names, i), picked: board.picked === i,
    worst: solved.worst_at?.[0] === camera && solved.worst_at[1] === i && seen?.off_px[i] > READ_PX,
  }));
  const pen = penOf(canvas);
  drawPicture(pen, through, still.image);
  drawMarks(pen, through, marks, seen);
  canvas.style.touchAction = through.zoom > 1 ? "none" : "pan-y";
  at("whole").textContent = `${through.zoom < 10 ? through.zoom.toFixed(through.zoom % 1 ? 1 : 0) : through.zoom.toFixed(0)}×`;
  drawLoupe(still.image, marks, seen);
  at("undo").disabled = !board.before.length;
  at("clear").disabled = board.picked === null;
  at("hold").hidden = !runs;
  at("scrub").hidden = runs || addresses.length < 2;
  at("scrub").max = addresses.length - 1;
  at("scrub").value = still.place;
  at("clock").textContent = runs ? "" : `frame ${frames[still.place] ?? 0}`;
  at("still").hidden = at("scrub").hidden && at("hold").hidden;
  at("save").disabled = !solved.whole || flying > 0 || waiting;
  for (const add of at("adding").children) add.disabled = board.sheet.marks.length >= hello.most_marks;
  prompt(number);
  points.show(solved);
  numbers.show();
  showResult(board, solved);
  drawPlan(at("plan"), solved.plan, marks.map((mark) => mark.label));
  document.body.dataset.picked = board.picked ?? "";
}

function prompt(number) {
  const { next, hello } = board;
  const other = hello.pictures.findIndex(({ number: n }) => board.sheet.marks.some((_, i) => !board.at(i, n - 1)));
  const words = element("span", "");
  if (next >= 0) {
    words.append("next: ", element("b", solved.names[next] ?? `point ${next + 1}`), ` · ${hello.hints[board.sheet.marks[next].kind][number - 1]}`);
  } else if (other >= 0) {
    words.append(`all points of camera ${number} are there; go on in `, element("b", `camera ${hello.pictures[other].number}`));
  } else words.append("all points are there: drag what is off, or move it by the arrow keys");
  if (at("next").textContent !== words.textContent) at("next").replaceChildren(words);
}

function drawLoupe(image, marks, seen) {
  const middle = pointed ?? (board.picked === null ? null : board.at(board.picked));
  at("chosen").textContent = board.picked === null ? "no point is picked: click one to move it" : `${solved.names[board.picked] ?? ""}: ${board.at(board.picked).join(", ")}`;
  const pen = penOf(loupe);
  if (!middle) return;
  const near = new Lens(loupe, board.hello.size);
  near.zoom = (LOUPE * near.zoom) / near.scale;
  near.middle = middle;
  drawPicture(pen, near, image);
  drawMarks(pen, near, marks, seen);
  pen.strokeStyle = "rgba(255, 255, 255, .8)";
  pen.lineWidth = 1;
  pen.strokeRect(loupe.clientWidth / 2 - LOUPE / 2, loupe.clientHeight / 2 - LOUPE / 2, LOUPE, LOUPE);
}

// The pointer: a click places or picks, a drag of a point moves it, a drag of the picture pans it.
let held = null;
canvas.addEventListener("pointerdown", (event) => {
  if (!board || event.button) return;
  const through = lens[board.camera];
  const where = through.toPixel(event.offsetX, event.offsetY);
  held = { x: event.offsetX, y: event.offsetY, mark: board.near(where, NEAR_PX / through.scale), moved: false };
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  if (!board) return;
  const through = lens[board.camera];
  pointed = event.pointerType === "mouse" ? through.toPixel(event.offsetX, event.offsetY) : null;
  if (held && (held.moved ||= Math.hypot(event.offsetX - held.x, event.offsetY - held.y) > DRAG_PX)) {
    const by = [(event.offsetX - held.x) / through.scale, (event.offsetY - held.y) / through.scale];
    [held.x, held.y] = [event.offsetX, event.offsetY];
    if (held.mark < 0) through.panBy(-by[0], -by[1]);
    else act(() => { board.picked = held.mark; board.nudge(by); });
  }
  refresh();
});
canvas.addEventListener("pointerup", (event) => {
  const was = held;
  held = null;
  if (!board || !was || was.moved) return;
  const where = lens[board.camera].toPixel(event.offsetX, event.offsetY);
  const inside = where.every((value, i) => value >= 0 && value <= board.hello.size[i]);
  if (was.mark >= 0) act(() => { board.picked = was.mark; });
  else if (inside) act(() => board.place(where));
});
canvas.addEventListener("touchstart", (event) => { // a finger on a point drags it, not the page
  const box = canvas.getBoundingClientRect();
  const through = lens?.[board.camera];
  const [x, y] = [event.touches[0].clientX - box.x, event.touches[0].clientY - box.y];
  if (through && board.near(through.toPixel(x, y), NEAR_PX / through.scale) >= 0) event.preventDefault();
}, { passive: false });
canvas.addEventListener("pointercancel", () => { held = null; });
canvas.addEventListener("pointerleave", () => { pointed = null; refresh(); });
canvas.addEventListener("wheel", (event) => {
  event.preventDefault();
  lens?.[board.camera].zoomBy(Math.exp(-event.deltaY / 300), event.offsetX, event.offsetY);
  refresh();
}, { passive: false });
loupe.addEventListener("click", (event) => {
  if (board?.picked === null) return;
  act(() => board.nudge([(event.offsetX - loupe.clientWidth / 2) / LOUPE, (event.offsetY - loupe.clientHeight / 2) / LOUPE]));
});

function zoom(times) {
  const through = lens[board.camera];
  if (board.picked !== null) through.show(board.at(board.picked));
  through.zoomBy(times);
  refresh();
}

function another(by) {
  const { marks } = board.sheet;
  if (!marks.length) return;
  const from = board.picked ?? board.next;
  act(() => board.pick(board.camera, (from + by + marks.length) % marks.length), true);
}

function nudge(by) { pointed = null; act(() => board.nudge(by), true); }
function clear() { if (board.picked !== null) act(() => { board.wanted = board.picked; board.put(board.picked, null); }); }
function undo() { act(() => board.undo()); }
function save() { if (!at("save").disabled && board.hello.writes) socket.send(JSON.stringify({ type: "save" })); }
function hold() { at("hold").ariaPressed = at("hold").ariaPressed === "false"; }

const DOES = { in: () => zoom(1.5), out: () => zoom(1 / 1.5), whole: () => zoom(0), undo, clear, save, hold };
for (const [id, does] of Object.entries(DOES)) at(id).addEventListener("click", () => board && does());
at("scrub").addEventListener("input", (event) => scrub(Number(event.target.value)));
for (const button of document.querySelectorAll("[data-by]")) {
  button.addEventListener("click", () => board && nudge(button.dataset.by.split(",").map(Number)));
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const KEYS = {
  Enter: () => { pointed = null; act(() => board.place(lens[board.camera].middle)); },
  "+": DOES.in, "=": DOES.in, "-": DOES.out, 0: DOES.whole, n: () => another(1), N: () => another(-1),
  Delete: clear, Backspace: clear, u: undo, s: save, h: () => running() && hold(), 1: () => look(0), 2: () => look(1),
  ",": () => scrub(stills[board.camera].place - 1), ".": () => scrub(stills[board.camera].place + 1),
  Escape: () => { board.picked = null; refresh(); },
};
addEventListener("keydown", (event) => {
  const typing = event.target.tagName === "INPUT";
  const pressing = event.target.tagName === "BUTTON" && event.key === "Enter";
  if (!board || typing || pressing || event.altKey || event.metaKey) return;
  if (event.ctrlKey && event.key !== "z") return;
  const does = event.key in ARROWS ? () => nudge(ARROWS[event.key].map((by) => by * (event.shiftKey ? FAR_PX : FINE_PX))) : event.ctrlKey ? undo : KEYS[event.key];
  if (!does) return;
  event.preventDefault();
  does();
});
addEventListener("resize", refresh);
addEventListener("beforeunload", (event) => { if (!saved && solved.whole) event.preventDefault(); });

connect();
