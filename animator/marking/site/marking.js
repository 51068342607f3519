// The marking page: what is clicked goes to the server, which answers with what it gives.

import { Board } from "./board.js";
import { listen } from "./hands.js";
import { isLockedOut, LOCKED_OUT } from "./knock.js";
import { element } from "./lists.js";
import { Stage } from "./stage.js";

const AGAIN_MS = 500; // between two tries to reach the server

const at = (id) => document.getElementById(id);
const me = Math.random().toString(36).slice(2);
let greeting, stage, socket;
let [count, flying, waiting] = [0, 0, false]; // sheets: said, not answered yet, changed since
let saved = true;

const heard = {
  hello(hello) {
    if (greeting && hello.run !== greeting.run) location.reload(); // after a pause of the connection
    greeting ??= hello;
  },
  shown(shown) {
    if (!stage) begin(greeting, shown.sheet);
    const own = shown.by === me;
    if (own && shown.count === flying) flying = 0;
    if (!own && !(flying || waiting)) stage.board.sheet = shown.sheet;
    stage.solved = shown.solved;
    at("kept").textContent = shown.kept;
    at("kept").className = shown.well ? "" : "bad";
    document.body.dataset.shown = own ? shown.count : 0;
    say();
  },
  told({ text, well }) {
    flying = 0;
    saved = well || saved;
    at("told").textContent = text;
    at("told").className = well ? "" : "bad";
    if (stage) say();
  },
};

/** Show the board once its sheet is known: nothing can be clicked before, and overwrite what was kept. */
function begin(hello, sheet) {
  stage = new Stage(new Board(hello, sheet), act);
  listen(stage, act, save);
  at("title").textContent = `${hello.title}: ${hello.method}`;
  document.title = `${hello.method} · ${hello.title} · tritrack`;
  at("adding").replaceChildren(...Object.keys(hello.hints).map((kind) => {
    const add = element("button", kind === "pole" ? "Add a pole" : `Add a point on the ${kind}`);
    add.addEventListener("click", () => act(() => stage.board.add({ kind, px: [null, null], at_m: kind === "pole" ? [0, 0] : null })));
    return add;
  }));
  at("save").hidden = !hello.writes;
  at("save").textContent = `Save ${hello.writes}`;
}

function connect() {
  socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/live`);
  socket.addEventListener("open", () => {
    [waiting, flying] = [waiting || flying > 0, 0];
    status("tracking", "ready");
  });
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
  if (waiting && !flying && socket.readyState === WebSocket.OPEN) {
    [waiting, flying] = [false, ++count];
    socket.send(JSON.stringify({ type: "marked", sheet: stage.board.sheet, by: me, count }));
  }
  stage.savable = stage.solved.whole && !flying && !waiting;
  stage.refresh();
}

/** Do something to the board; what it changed is said, and shown if it would be out of sight. */
function act(change, follow = false) {
  const { board } = stage;
  const before = board.sheet;
  change();
  if (board.sheet !== before) {
    [waiting, saved] = [true, !board.hello.writes];
    at("told").textContent = "";
  }
  if (follow && board.picked !== null) stage.lens.show(board.at(board.picked));
  say();
}

function save() {
  if (stage.savable && stage.board.hello.writes) socket.send(JSON.stringify({ type: "save" }));
}

addEventListener("resize", () => stage?.refresh());
addEventListener("beforeunload", (event) => { if (!saved && stage?.solved.whole) event.preventDefault(); });

connect();
