// What the person may ask of the run, and whether anybody heard it.

import { showTold } from "./panel.js";

const LEAVE_S = 5; // to step out of the picture before the background is taken
const PATIENCE_MS = 4000;
const at = (id) => document.getElementById(id);

export class Actions {
  constructor(possible, ask) {
    this.ask = ask;
    this.waiting = null;
    at("actions").hidden = !possible;
    for (const what of ["save", "measure", "front", "back"]) at(what).addEventListener("click", () => this.say(what));
    at("record").addEventListener("click", () => this.say(this.recording ? "end_record" : "record"));
    at("stop").addEventListener("click", () => this.say("stop"));
    at("background").addEventListener("click", () => this.leave(LEAVE_S));
  }

  get recording() { return at("record").getAttribute("aria-pressed") === "true"; }

  say(what) {
    this.ask(what);
    clearTimeout(this.waiting);
    this.waiting = setTimeout(() => showTold(false, "nobody answered"), PATIENCE_MS);
  }

  /** Front and back are a question where one camera alone sees the person. */
  alone(isAlone) { for (const what of ["front", "back"]) at(what).hidden = !isAlone; }

  /** Count down while the person leaves the picture. */
  leave(seconds) {
    at("background").disabled = seconds > 0;
    if (seconds === 0) return this.say("background");
    showTold(true, `leave the picture: ${seconds} …`);
    setTimeout(() => this.leave(seconds - 1), 1000);
  }

  told({ what, well }) {
    clearTimeout(this.waiting);
    if (well && (what === "record" || what === "end_record")) {
      at("record").setAttribute("aria-pressed", what === "record");
      at("record").lastElementChild.textContent = what === "record" ? "End recording" : "Record";
    }
  }

  /** The run is over: nobody can do anything for it. */
  end() {
    clearTimeout(this.waiting);
    at("actions").hidden = true;
  }
}
