// The dropped files: what each is, and what can be done with them.

import { at, button, element, fill, size } from "./parts.js";

const TASKS = {
  single: "Follow the person",
  track: "Follow the person",
  person: "Calibrate by the person",
  board: "Calibrate by the board",
  poles: "Calibrate by poles, clicked",
  markers: "Aim by line markers, clicked",
  import: "Take over the calibration",
};

export class Tray {
  constructor(link, uploader) {
    this.link = link;
    this.uploader = uploader;
    this.tasks = "";
    const drop = at("drop");
    for (const kind of ["dragover", "dragenter"]) addEventListener(kind, (event) => { event.preventDefault(); drop.classList.add("over"); });
    addEventListener("dragleave", (event) => { if (!event.relatedTarget) drop.classList.remove("over"); });
    addEventListener("drop", (event) => {
      event.preventDefault();
      drop.classList.remove("over");
      uploader.addDropped(event.dataTransfer);
    });
    at("choose-files").addEventListener("change", ({ target }) => {
      uploader.add([...target.files]);
      target.value = "";
    });
    at("name").addEventListener("input", ({ target }) => { target.own = target.value !== ""; });
    at("work").addEventListener("submit", (event) => { event.preventDefault(); at("tasks").firstElementChild?.click(); });
  }

  show({ files, tasks, says, name }) {
    this.uploader.keep(new Set(files.map(({ file }) => file)));
    fill(at("files"), files.map((file, n) => ({ ...file, n, all: files.length })), ({ file }) => file, (file) => this.row(file));
    at("tray-says").textContent = says;
    at("tray-says").hidden = says === "";
    at("work").hidden = tasks.length === 0;
    at("work").className = tasks.includes("track") ? "" : "one";
    if (!at("name").own) at("name").value = name;
    if (files.length === 0) at("name").own = false;
    if (this.tasks === tasks.join()) return;
    this.tasks = tasks.join();
    at("tasks").replaceChildren(...tasks.map((task, n) => button(`do-${task}`, TASKS[task], () => this.work(task), n === 0 ? { className: "main-task" } : {})));
  }

  row({ file, name, bytes, got, facts, fault, n, all, kind }) {
    const camera = all > 1 && kind === "video" ? `camera ${n + 1}: ` : "";
    const whole = got === bytes;
    const state = fault || (whole ? facts || (kind === "calibration" ? "a calibration" : "looking at it …") : `${size(got)} of ${size(bytes)}`);
    return element("li", { className: "row" },
      element("div", {}, element("h3", { title: name }, camera + name), element("p", { className: fault ? "bad" : "quiet" }, `${state}${whole && !fault ? `, ${size(bytes)}` : ""}`),
        whole ? "" : element("progress", { max: bytes, value: got, "aria-label": `${name}: on its way` })),
      element("div", { className: "buttons" },
        n > 0 ? button(`up-${file}`, "▲", () => this.link.say({ type: "raise", file }), { ariaLabel: `${name}: one camera earlier`, title: "one camera earlier" }) : "",
        button(`away-${file}`, "Take away", () => this.link.say({ type: "drop", file }), { ariaLabel: `Take away ${name}` })));
  }

  work(task) {
    if (!at("work").reportValidity()) return;
    const number = (id) => (at(id).value === "" ? null : Number(at(id).value));
    this.link.say({
      type: "work", task, name: at("name").value, calibration: task === "track" ? at("calibration").value : "",
      everyone: task === "track" && at("whom").value === "all",
      offset_s: task === "track" ? number("offset") : null, stature_m: number("stature") ?? 1.75, square_mm: number("square"),
    });
    at("name").own = false;
  }
}
