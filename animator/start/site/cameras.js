// The cameras of this machine, with pictures while they are wanted.

import { at, element, fill } from "./parts.js";

const EVERY_MS = 500; // between two pictures

export class Cameras {
  constructor(link) {
    this.link = link;
    this.chosen = []; // in the order of choice: the first is camera 1
    this.on = false;
    at("look").addEventListener("click", () => link.say({ type: "look", on: !this.on }));
    at("live").addEventListener("click", () => link.say({ type: "live", cameras: this.chosen, calibration: at("live-calibration").value, pictures: at("live-pictures").checked }));
    at("record").addEventListener("click", () => {
      if (at("record-seconds").reportValidity() && at("record-name").reportValidity()) link.say({ type: "record", cameras: this.chosen, seconds: Number(at("record-seconds").value), name: at("record-name").value });
    });
    at("watch").addEventListener("click", () => link.say({ type: "watch", cameras: this.watching ? [] : this.chosen }));
    at("watched").addEventListener("click", () => {
      if (at("live-square").reportValidity()) link.say({ type: "watched", square_mm: at("live-square").value === "" ? null : Number(at("live-square").value) });
    });
    setInterval(() => this.renew(), EVERY_MS);
  }

  show({ on, cameras, says, watching, board }) {
    this.on = on;
    this.watching = watching;
    at("watch").ariaPressed = watching;
    at("cameras").className = watching ? "watching" : "";
    at("watch").textContent = watching ? "Watch the board no longer" : "Watch the board";
    at("watched").hidden = at("square-field").hidden = !watching;
    fill(at("board-says"), board, (_, n) => n, (line) => element("li", {}, line));
    this.chosen = this.chosen.filter((one) => cameras.some(({ camera }) => camera === one));
    at("cameras-say").textContent = says;
    at("cameras-say").hidden = says === "";
    at("look").disabled = cameras.length === 0;
    at("look").ariaPressed = on;
    at("look").textContent = on ? "Close the cameras" : "Show their pictures";
    this.cameras = cameras;
    this.draw();
  }

  draw() {
    at("live").disabled = this.chosen.length === 0;
    at("watch").disabled = this.chosen.length === 0 && !this.watching;
    at("record").disabled = this.chosen.length < 2;
    at("record").textContent = this.chosen.length > 1 ? `Record ${this.chosen.length} cameras` : "Record";
    at("live").className = this.chosen.length ? "main-task" : "";
    at("live").textContent = this.chosen.length > 1 ? `Track live with ${this.chosen.length} cameras` : "Track live";
    fill(at("cameras"), this.cameras.map((each) => ({ ...each, number: this.chosen.indexOf(each.camera) + 1, on: this.on })), ({ camera }) => camera, (each) => this.row(each));
  }

  row({ camera, name, where, facts, fault, picture, number, on }) {
    const box = element("input", { id: `use-${camera}`, type: "checkbox", checked: number > 0 });
    box.addEventListener("change", () => {
      this.chosen = box.checked ? [...this.chosen, camera] : this.chosen.filter((one) => one !== camera);
      this.draw();
    });
    return element("li", { className: `${number ? "chosen" : ""} ${on ? "" : "closed"}` },
      picture ? element("img", { src: `${picture}?${Date.now()}`, alt: `what ${name} (${where}) sees`, "data-picture": picture }) : on ? element("div", { className: "blank" }) : "",
      element("div", {},
        element("label", {}, box, name + (number ? `: camera ${number}` : "")),
        element("p", { className: "quiet" }, where),
        element("p", { className: fault ? "bad" : "quiet" }, fault || facts || (on ? "opening …" : "closed"))));
  }

  /** The next picture of each, while somebody looks. */
  renew() {
    if (document.hidden || !this.on) return;
    for (const image of at("cameras").querySelectorAll("img")) {
      if (image.complete) image.src = `${image.dataset.picture}?${Date.now()}`;
    }
  }
}
