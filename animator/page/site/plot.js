// Chosen angles over time: the last seconds of a run that goes on, all of one that is looked back on.

const LIVE_S = 15;
export const INKS = ["#2f7d6d", "#c7702c", "#3f78b5", "#8a4f9e"];
const DASHES = [[], [6, 3], [2, 2], [8, 2, 2, 2]]; // told apart without colours too
const LEFT_PX = 34, BOTTOM_PX = 16;

export class Plot {
  constructor(canvas, history) {
    this.canvas = canvas;
    this.history = history;
    this.chosen = []; // places in the angles of a person
    this.of = (frame) => frame; // the person of a frame
  }

  get range() {
    const [first, last] = this.history.span;
    return this.history.following ? [Math.max(first, last - LIVE_S), Math.max(last, first + LIVE_S)] : [first, Math.max(last, first + 1)];
  }

  timeAt(x) {
    const [from, to] = this.range;
    return from + ((x - LEFT_PX) / (this.canvas.clientWidth - LEFT_PX)) * (to - from);
  }

  draw() {
    const { canvas, history } = this;
    const scale = Math.min(2, devicePixelRatio);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(width * scale)) Object.assign(canvas, { width: Math.round(width * scale), height: Math.round(height * scale) });
    const pen = canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.clearRect(0, 0, width, height);
    const [from, to] = this.range;
    const first = history.indexAt(from);
    const frames = history.frames.slice(Math.max(0, first - 1)).map((frame) => ({ time_s: frame.time_s, angles: this.of(frame).angles }));
    const [low, high] = this.extent(frames);
    const x = (seconds) => LEFT_PX + ((seconds - from) / (to - from)) * (width - LEFT_PX);
    const y = (degrees) => 4 + (1 - (degrees - low) / (high - low)) * (height - BOTTOM_PX - 8);
    this.axes(pen, [from, to], [low, high], x, y, [width, height]);
    pen.save();
    pen.beginPath();
    pen.rect(LEFT_PX, 0, width - LEFT_PX, height);
    pen.clip();
    this.chosen.forEach((angle, i) => this.line(pen, frames, angle, i, x, y, width));
    pen.restore();
    const now = history.shown;
    if (now && !history.following) {
      pen.strokeStyle = "#1d242c";
      pen.lineWidth = 1;
      pen.beginPath();
      pen.moveTo(x(now.time_s), 0);
      pen.lineTo(x(now.time_s), height - BOTTOM_PX);
      pen.stroke();
    }
  }

  extent(frames) {
    let [low, high] = [Infinity, -Infinity];
    for (const { angles } of frames) {
      if (!angles.length) continue;
      for (const i of this.chosen) {
        low = Math.min(low, angles[i]);
        high = Math.max(high, angles[i]);
      }
    }
    if (low > high) return [-90, 90];
    const room = Math.max(5, 0.08 * (high - low), (30 - (high - low)) / 2);
    return [low - room, high + room];
  }

  axes(pen, [from, to], [low, high], x, y, [width, height]) {
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = "#66717d";
    pen.strokeStyle = "#e3e8ec";
    pen.lineWidth = 1;
    pen.setLineDash([]);
    pen.beginPath();
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    const step = [10, 15, 30, 45, 90, 180].find((each) => (high - low) / each <= 5) ?? 360;
    for (let at = Math.ceil(low / step) * step; at <= high; at += step) {
      pen.moveTo(LEFT_PX, y(at));
      pen.lineTo(width, y(at));
      pen.fillText(`${at}°`, LEFT_PX - 5, y(at));
    }
    pen.textAlign = "center";
    pen.textBaseline = "bottom";
    const apart = [1, 2, 5, 10, 15, 30, 60, 120].find((each) => (to - from) / each <= Math.max(3, width / 80)) ?? 300;
    for (let at = Math.ceil(from / apart) * apart; at <= to; at += apart) {
      pen.moveTo(x(at), 0);
      pen.lineTo(x(at), height - BOTTOM_PX);
      if (x(at) > LEFT_PX + 8 && x(at) < width - 12) pen.fillText(`${at} s`, x(at), height);
    }
    pen.stroke();
  }

  line(pen, frames, angle, i, x, y, width) {
    pen.beginPath();
    pen.strokeStyle = INKS[i];
    pen.setLineDash(DASHES[i]);
    pen.lineWidth = 1.7;
    let down = false;
    const skip = Math.max(1, Math.floor(frames.length / (2 * width)));
    for (let at = 0; at < frames.length; at += skip) {
      const value = frames[at].angles[angle];
      if (value === undefined) { down = false; continue; }
      if (down) pen.lineTo(x(frames[at].time_s), y(value));
      else pen.moveTo(x(frames[at].time_s), y(value));
      down = true;
    }
    pen.stroke();
    pen.setLineDash([]);
  }
}
