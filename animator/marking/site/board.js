// What was clicked: the sheet, what was before it, which point comes next, which is picked.

const MOST_UNDONE = 300;
const FINE = 100; // of a pixel

export class Board {
  constructor(hello, sheet) {
    this.hello = hello;
    this.sheet = sheet;
    this.before = [];
    this.camera = 0; // place in hello.pictures
    this.picked = null; // a mark that has a point in this camera
    this.wanted = 0; // where the search for the next one begins
  }

  /** Of this camera in a mark's pair of points. */
  get side() { return this.hello.pictures[this.camera].number - 1; }

  at(mark, side = this.side) { return this.sheet.marks[mark]?.px[side] ?? null; }

  /** The mark that a click places: the first without a point from `wanted` on; -1: none is left. */
  get next() {
    const order = this.sheet.marks.map((_, i) => (i + this.wanted) % this.sheet.marks.length);
    return order.find((i) => !this.at(i)) ?? -1;
  }

  change(sheet) {
    this.before.push(this.sheet);
    if (this.before.length > MOST_UNDONE) this.before.shift();
    this.sheet = sheet;
    if (this.picked !== null && !this.at(this.picked)) this.picked = null;
  }

  undo() {
    if (!this.before.length) return false;
    this.sheet = this.before.pop();
    if (this.picked !== null && !this.at(this.picked)) this.picked = null;
    return true;
  }

  /** Put a mark's point somewhere in this camera's picture; null takes it away. */
  put(mark, at, side = this.side) {
    const place = at?.map((value, i) => Math.max(0, Math.min(this.hello.size[i], Math.round(value * FINE) / FINE))) ?? null;
    const marks = this.sheet.marks.map((each, i) => (i === mark ? { ...each, px: each.px.map((px, n) => (n === side ? place : px)) } : each));
    this.change({ ...this.sheet, marks });
  }

  /** Click: the next point is there now; false where all have one. */
  place(at) {
    const mark = this.next;
    if (mark < 0) return false;
    this.put(mark, at);
    this.picked = mark;
    this.wanted = mark;
    return true;
  }

  nudge(by) {
    const at = this.picked === null ? null : this.at(this.picked);
    if (at) this.put(this.picked, [at[0] + by[0], at[1] + by[1]]);
  }

  add(mark) {
    const last = this.sheet.marks.findLastIndex((each) => each.kind === mark.kind);
    const place = last < 0 ? this.sheet.marks.length : last + 1;
    this.picked = null;
    this.wanted = place;
    this.change({ ...this.sheet, marks: this.sheet.marks.toSpliced(place, 0, mark) });
    return place;
  }

  remove(mark) {
    this.picked = null;
    this.wanted = 0;
    this.change({ ...this.sheet, marks: this.sheet.marks.toSpliced(mark, 1) });
  }

  move(mark, at_m) { this.change({ ...this.sheet, marks: this.sheet.marks.map((each, i) => (i === mark ? { ...each, at_m } : each)) }); }

  say(key, value) { this.change({ ...this.sheet, numbers: { ...this.sheet.numbers, [key]: value } }); }

  pick(camera, mark) {
    this.camera = camera;
    this.picked = this.at(mark) ? mark : null;
    if (this.picked === null) this.wanted = mark;
  }

  /** The mark whose point is nearest, within some pixels; -1: none. */
  near([u, v], within) {
    const far = this.sheet.marks.map((_, i) => (this.at(i) ? Math.hypot(this.at(i)[0] - u, this.at(i)[1] - v) : Infinity));
    const least = Math.min(...far);
    return least <= within ? far.indexOf(least) : -1;
  }
}
