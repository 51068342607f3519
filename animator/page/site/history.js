// The frames of the run that this page holds, and which of them is shown: live, still or played.

const MOST_FRAMES = 9000; // ten minutes at 15 frames a second
const MOST_PICTURES = 4500; // older frames keep their outlines

export class History {
  constructor() {
    this.frames = [];
    this.at = -1; // the one that is shown
    this.following = true; // the newest is shown
    this.playing = false;
    this.over = false; // nothing more will come
    this.speed = 1;
    this.newest = -1; // number of the newest
    this.clock_s = 0; // time of the run that the player has reached
  }

  get shown() { return this.frames[this.at]; }

  get span() {
    const { frames } = this;
    return frames.length ? [frames[0].time_s, frames[frames.length - 1].time_s] : [0, 0];
  }

  /** Take in a frame; one that was told before is left out. */
  add(frame) {
    if (frame.number <= this.newest) return false;
    this.newest = frame.number;
    this.frames.push(frame);
    const old = this.frames[this.frames.length - 1 - MOST_PICTURES];
    if (old) for (const view of old.views) if (view) view.jpeg = "";
    if (this.frames.length > MOST_FRAMES) {
      this.frames.shift();
      this.at = Math.max(0, this.at - 1);
    }
    if (this.following) this.at = this.frames.length - 1;
    return true;
  }

  follow() {
    this.following = !this.over;
    this.playing = false;
    this.at = this.frames.length - 1;
  }

  seek(index) {
    this.following = false;
    this.at = Math.min(Math.max(0, index), this.frames.length - 1);
    this.clock_s = this.shown ? this.shown.time_s : 0;
  }

  seekTime(seconds) { this.seek(this.indexAt(seconds)); }

  /** Pause what moves; play what stands, from the start again where it stood at the end. */
  toggle() {
    if (this.following || this.playing) {
      this.following = this.playing = false;
      return;
    }
    if (this.at >= this.frames.length - 1) this.at = 0;
    this.playing = true;
    this.clock_s = this.shown ? this.shown.time_s : 0;
  }

  /** Let the player go on by so many seconds; whether another frame is shown now. */
  advance(seconds) {
    if (!this.playing) return false;
    const before = this.at;
    this.clock_s += seconds * this.speed;
    while (this.at < this.frames.length - 1 && this.frames[this.at + 1].time_s <= this.clock_s) this.at += 1;
    if (this.at >= this.frames.length - 1) {
      if (this.over) this.playing = false;
      else this.follow();
      return true;
    }
    return this.at !== before;
  }

  indexAt(seconds) {
    let [low, high] = [0, this.frames.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.frames[middle].time_s <= seconds + 1e-6) low = middle;
      else high = middle - 1;
    }
    return low;
  }
}
