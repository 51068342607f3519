// A picture that is zoomed and panned, with what was clicked in it and what that gives.

const MOST_ZOOM = 24;
const NIGHT = "#1c2129";
export const INKS = { pole: "#ffb454", floor: "#7fd4c1", wall: "#8ab8ff" };

/** How pixels of a picture lie on a canvas: pixel (u, v) at ((u - left) * scale, (v - top) * scale). */
export class Lens {
  constructor(canvas, size) {
    [this.canvas, this.size] = [canvas, size];
    this.zoom = 1;
    this.middle = [size[0] / 2, size[1] / 2];
  }

  get scale() {
    return this.zoom * Math.min(this.canvas.clientWidth / this.size[0], this.canvas.clientHeight / this.size[1]);
  }

  get corner() {
    return [this.middle[0] - this.canvas.clientWidth / 2 / this.scale, this.middle[1] - this.canvas.clientHeight / 2 / this.scale];
  }

  toPixel(x, y) {
    const [left, top] = this.corner;
    return [left + x / this.scale, top + y / this.scale];
  }

  toCanvas([u, v]) {
    const [left, top] = this.corner;
    return [(u - left) * this.scale, (v - top) * this.scale];
  }

  /** Come nearer or go farther, while the pixel at a place of the canvas stays there. */
  zoomBy(times, x = this.canvas.clientWidth / 2, y = this.canvas.clientHeight / 2) {
    const before = this.toPixel(x, y);
    this.zoom = Math.max(1, Math.min(MOST_ZOOM, this.zoom * times));
    const after = this.toPixel(x, y);
    this.panBy(before[0] - after[0], before[1] - after[1]);
  }

  /** Never past the picture's border. */
  panBy(u, v) {
    const seen = [this.canvas.clientWidth / this.scale, this.canvas.clientHeight / this.scale];
    this.middle = [u, v].map((by, i) => {
      const most = Math.max(0, (this.size[i] - seen[i]) / 2);
      return this.size[i] / 2 + Math.max(-most, Math.min(most, this.middle[i] + by - this.size[i] / 2));
    });
  }

  show(at) { this.panBy(at[0] - this.middle[0], at[1] - this.middle[1]); }
}

/** A pen over the canvas at the screen's own resolution, in CSS pixels. */
export function penOf(canvas) {
  const [width, height] = [canvas.clientWidth * devicePixelRatio, canvas.clientHeight * devicePixelRatio].map(Math.round);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const pen = canvas.getContext("2d");
  pen.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  pen.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
  return pen;
}

export function drawPicture(pen, lens, image) {
  pen.fillStyle = NIGHT;
  pen.fillRect(0, 0, lens.canvas.clientWidth, lens.canvas.clientHeight);
  if (!image) return;
  const [x, y] = lens.toCanvas([0, 0]);
  pen.imageSmoothingEnabled = lens.scale < 3;
  pen.drawImage(image, x, y, lens.size[0] * lens.scale, lens.size[1] * lens.scale);
}

/** The middle of the picture, what the result draws, and every point that was clicked. */
export function drawMarks(pen, lens, marks, seen) {
  const [width, height] = lens.size;
  line(pen, lens, [[width / 2, 0], [width / 2, height]], "rgba(255, 255, 255, .45)", [4, 6]);
  line(pen, lens, [[0, height / 2], [width, height / 2]], "rgba(255, 255, 255, .45)", [4, 6]);
  for (const ends of seen?.lines_px ?? []) line(pen, lens, ends, "rgba(90, 230, 190, .95)", []);
  for (const place of seen?.expected_px ?? []) if (place) ring(pen, lens.toCanvas(place));
  for (const mark of marks) if (mark.at) cross(pen, lens.toCanvas(mark.at), mark);
}

function line(pen, lens, ends, ink, dashes) {
  pen.beginPath();
  for (const end of ends) pen.lineTo(...lens.toCanvas(end));
  pen.setLineDash(dashes);
  pen.strokeStyle = ink;
  pen.lineWidth = 1.5;
  pen.stroke();
  pen.setLineDash([]);
}

function ring(pen, [x, y]) {
  pen.beginPath();
  pen.arc(x, y, 5, 0, 2 * Math.PI);
  pen.strokeStyle = "rgba(90, 230, 190, .95)";
  pen.lineWidth = 1.5;
  pen.stroke();
}

function cross(pen, [x, y], mark) {
  const far = mark.picked ? 14 : 9;
  for (const [ink, width] of [["rgba(0, 0, 0, .7)", 3.5], [mark.worst ? "#ff6b5e" : mark.ink, 1.5]]) {
    pen.beginPath();
    for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      pen.moveTo(x + 3 * dx, y + 3 * dy);
      pen.lineTo(x + far * dx, y + far * dy);
    }
    pen.strokeStyle = ink;
    pen.lineWidth = width;
    pen.stroke();
  }
  pen.font = "600 13px system-ui, sans-serif";
  pen.lineWidth = 3;
  pen.strokeStyle = "rgba(0, 0, 0, .75)";
  pen.strokeText(mark.label, x + 8, Math.max(12, y - 8));
  pen.fillStyle = mark.worst ? "#ff6b5e" : mark.ink;
  pen.fillText(mark.label, x + 8, Math.max(12, y - 8));
}
