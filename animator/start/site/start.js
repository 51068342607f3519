// The start page: it shows what the server says, and says what its user wants.

import { showCalibrations } from "./calibrations.js";
import { Cameras } from "./cameras.js";
import { showJobs } from "./jobs.js";
import { isLockedOut, LOCKED_OUT } from "./knock.js";
import { at } from "./parts.js";
import { showRecordings } from "./recordings.js";
import { showRuns } from "./runs.js";
import { Tray } from "./tray.js";
import { Uploader } from "./upload.js";

const AGAIN_MS = 500; // between two tries to reach the server

const BEGIN = new Set(["work", "live", "demo", "board", "open", "export", "report", "compare", "watched", "record"]); // wishes that a job follows from

const link = {
  send(said) { if (link.socket?.readyState === WebSocket.OPEN) link.socket.send(said); },
  wished: false, // whether a job that this page asked for is still to come
  say(wish) {
    link.wished ||= BEGIN.has(wish.type);
    link.send(JSON.stringify(wish));
  },
};
function tell({ text, well }) {
  at("told").textContent = text;
  at("told").className = well ? "" : "bad";
}

const uploader = new Uploader(link, (text) => tell({ text, well: false }));
const tray = new Tray(link, uploader);
const cameras = new Cameras(link);
let hello;

const heard = {
  hello(said) {
    hello = said;
    at("runs-folder").textContent = said.runs;
  },
  tray: (said) => tray.show(said),
  got: (said) => uploader.got(said),
  jobs: (said) => showJobs(said, link),
  runs: (said) => showRuns(said, hello, link),
  cameras: (said) => cameras.show(said),
  calibrations: (said) => showCalibrations(said, link),
  recordings: (said) => showRecordings(said, link),
  told: tell,
};

function status(state, words) {
  at("status").dataset.status = state;
  at("words").textContent = words;
}

function connect() {
  link.socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/live`);
  link.socket.addEventListener("open", () => status("tracking", "ready"));
  link.socket.addEventListener("message", ({ data }) => {
    const said = JSON.parse(data);
    heard[said.kind]?.(said);
    document.body.dataset.heard = said.kind;
  });
  link.socket.addEventListener("close", async () => {
    status("gone", (await isLockedOut()) ? LOCKED_OUT : "tritrack does not answer: it was ended, or is still to start");
    setTimeout(connect, AGAIN_MS);
  });
}

at("demo").addEventListener("click", () => link.say({ type: "demo" }));
at("board").addEventListener("click", () => link.say({ type: "board", paper: at("paper").value }));
connect();
