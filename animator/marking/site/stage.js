// What is seen of the board: the picture and the loupe, which still is shown, the lists beside.

import { element, label, Numbers, Points, READ_PX, showResult } from "./lists.js";
import { drawMarks, drawPicture, INKS, Lens, penOf } from "./picture.js";
import { drawPlan } from "./plan.js";

const NEW_MS = 250; // between two pictures of a camera that runs
export const LOUPE = 8;
const at = (id) => document.getElementById(id);

export class Stage {
  /** `act` does something to the board, and says what it changed. */
  constructor(board, act) {
    const { hello } = board;
    this.board = board;
    [this.view, this.loupe] = [at("view"), at("loupe")];
    this.lenses = hello.pictures.map(() => new Lens(this.view, hello.size));
    this.stills = hello.pictures.map(() => ({ place: 0, image: null }));
    this.solved = { cameras: [], names: [], plan: null, worst: "", worst_at: null, whole: false };
    [this.points, this.numbers] = [new Points(this.board, act), new Numbers(this.board, act)];
    this.pointed = null; // the pixel under the pointer
    this.savable = false;
    this.view.style.aspectRatio = `${hello.size[0]} / ${hello.size[1]}`;
    at("cameras").replaceChildren(...hello.pictures.map(({ number }, i) => {
      const tab = element("button", `camera ${number}`);
      tab.addEventListener("click", () => this.look(i));
      return tab;
    }));
    hello.pictures.forEach((_, i) => this.load(i));
    setInterval(() => { if (this.runs && at("hold").ariaPressed === "false") this.load(this.board.camera); }, NEW_MS);
    this.refresh();
  }

  get runs() { return this.board.hello.pictures[this.board.camera].runs; }

  get lens() { return this.lenses[this.board.camera]; }

  get still() { return this.stills[this.board.camera]; }

  refresh() {
    if (!this.dirty) requestAnimationFrame(() => this.draw());
    this.dirty = true;
  }

  load(camera) {
    const { stills: addresses, runs } = this.board.hello.pictures[camera];
    const still = this.stills[camera];
    if (still.loading || !addresses.length) return;
    const image = new Image();
    const wanted = still.place;
    still.loading = true;
    image.src = runs ? `${addresses[0]}?${Date.now()}` : addresses[wanted];
    image.decode().then(() => { still.image = image; }, () => {}).finally(() => {
      still.loading = false;
      if (still.place !== wanted) this.load(camera);
      document.body.dataset.loaded = this.stills.filter((each) => each.image).length;
      this.refresh();
    });
  }

  look(camera) {
    const { board } = this;
    if (!board.hello.pictures[camera]) return;
    if (board.camera !== camera) [board.picked, board.wanted] = [null, 0];
    board.camera = camera;
    this.pointed = null;
    this.refresh();
  }

  scrub(place) {
    const { stills: addresses } = this.board.hello.pictures[this.board.camera];
    this.still.place = Math.max(0, Math.min(addresses.length - 1, place));
    this.load(this.board.camera);
    this.refresh();
  }

  zoom(times) {
    if (this.board.picked !== null) this.lens.show(this.board.at(this.board.picked));
    this.lens.zoomBy(times);
    this.refresh();
  }

  draw() {
    this.dirty = false;
    const { board, solved, lens, still } = this;
    const seen = solved.cameras[board.camera];
    lens.panBy(0, 0);
    const marks = board.sheet.marks.map((mark, i) => ({
      at: board.at(i), ink: INKS[mark.kind], label: label(board, solved.names, i), picked: board.picked === i,
      worst: solved.worst_at?.[0] === board.camera && solved.worst_at[1] === i && seen?.off_px[i] > READ_PX,
    }));
    const pen = penOf(this.view);
    drawPicture(pen, lens, still.image);
    drawMarks(pen, lens, marks, seen);
    this.view.style.touchAction = lens.zoom > 1 ? "none" : "pan-y";
    this.drawLoupe(marks, seen);
    this.tools();
    this.prompt();
    this.points.show(solved);
    this.numbers.show();
    showResult(board, solved);
    drawPlan(at("plan"), solved.plan, marks.map((mark) => mark.label));
    document.body.dataset.picked = board.picked ?? "";
  }

  tools() {
    const { board, lens, still } = this;
    const { stills: addresses, frames } = board.hello.pictures[board.camera];
    [...at("cameras").children].forEach((tab, i) => { tab.ariaPressed = i === board.camera; });
    at("whole").textContent = `${lens.zoom < 10 && lens.zoom % 1 ? lens.zoom.toFixed(1) : lens.zoom.toFixed(0)}×`;
    at("undo").disabled = !board.before.length;
    at("clear").disabled = board.picked === null;
    at("hold").hidden = !this.runs;
    at("scrub").hidden = this.runs || addresses.length < 2;
    at("scrub").max = addresses.length - 1;
    at("scrub").value = still.place;
    at("clock").textContent = this.runs ? "" : `frame ${frames[still.place] ?? 0}`;
    at("still").hidden = at("scrub").hidden && at("hold").hidden;
    at("save").disabled = !this.savable;
    for (const add of at("adding").children) add.disabled = board.sheet.marks.length >= board.hello.most_marks;
  }

  prompt() {
    const { board: { next, hello, sheet, camera }, solved } = this;
    const { number } = hello.pictures[camera];
    const other = hello.pictures.findIndex(({ number: n }) => sheet.marks.some((_, i) => !this.board.at(i, n - 1)));
    const words = element("span", "");
    if (next >= 0) {
      words.append("next: ", element("b", solved.names[next] ?? `point ${next + 1}`), ` · ${hello.hints[sheet.marks[next].kind][number - 1]}`);
    } else if (other >= 0) {
      words.append(`all points of camera ${number} are there; go on in `, element("b", `camera ${hello.pictures[other].number}`));
    } else if (!sheet.marks.length) words.append("no points are asked for: add one");
    else words.append("all points are there: drag what is off, or move it by the arrow keys");
    if (at("next").textContent !== words.textContent) at("next").replaceChildren(words);
  }

  drawLoupe(marks, seen) {
    const { board, loupe } = this;
    const middle = this.pointed ?? (board.picked === null ? null : board.at(board.picked));
    at("chosen").textContent = board.picked === null ? "no point is picked: click one to move it" : `${this.solved.names[board.picked] ?? ""}: ${board.at(board.picked).join(", ")}`;
    const pen = penOf(loupe);
    if (!middle) return;
    const near = new Lens(loupe, board.hello.size);
    near.zoom = LOUPE / near.scale;
    near.middle = middle;
    drawPicture(pen, near, this.still.image);
    drawMarks(pen, near, marks, seen);
    pen.strokeStyle = "rgba(255, 255, 255, .8)";
    pen.lineWidth = 1;
    pen.strokeRect(loupe.clientWidth / 2 - LOUPE / 2, loupe.clientHeight / 2 - LOUPE / 2, LOUPE, LOUPE);
  }
}
