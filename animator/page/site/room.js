// The body in the room, drawn without a graphics card: solids as shaded outlines, the far ones first.

import { badge } from "./views.js";

const SUN = [-0.5, 1.6, 0.9];
const FLOOR = "#f6f8fa", SHADOW = "#cdd4da", LINE = "207, 214, 221", CAMERA = "#8c96a3";
const CELL_M = 0.5, CELLS = 9; // of the floor, to each side of the body
const ROUND = 20; // corners of what is round
const ANGLE_RAD = 0.52;
const CIRCLE = Array.from({ length: ROUND }, (_, i) => [Math.cos((2 * Math.PI * i) / ROUND), Math.sin((2 * Math.PI * i) / ROUND)]);
const CYLINDER = [...CIRCLE.map(([x, z]) => [x, 0, z]), ...CIRCLE.map(([x, z]) => [x, 1, z])];
const BALL = [-0.97, -0.85, -0.62, -0.25, 0.25, 0.62, 0.85, 0.97].flatMap((y) => CIRCLE.map(([x, z]) => [x, z].map((value) => value * Math.sqrt(1 - y * y))).map(([x, z]) => [x, y, z]));

export class Room {
  constructor(canvas, cylinders, names) {
    this.canvas = canvas;
    this.cylinders = cylinders; // so many solids are cylinders, the others balls
    this.names = names; // of the cameras
    this.people = [];
    this.reach_m = 0; // of the people round their middle
    this.cameras = [];
    this.eye = { yaw: 0.6, pitch: 0.2, away_m: 4.6 };
    this.middle = [0, 0.86, 0];
  }

  /** Where the cameras stand; the spectator first stands behind them. */
  setCameras(room) {
    this.middle = [room.middle[0], this.middle[1], room.middle[2]];
    this.eye.yaw = Math.atan2(room.spectator[0] - room.middle[0], room.spectator[2] - room.middle[2]);
    this.cameras = room.cameras;
  }

  /** Turn the spectator round the body, and let them come nearer. */
  move(yaw, pitch, nearer) {
    const { eye } = this;
    eye.yaw += yaw;
    eye.pitch = Math.min(1.4, Math.max(0.02, eye.pitch + pitch));
    eye.away_m = Math.min(12, Math.max(1.5, eye.away_m * nearer));
  }

  /** Who is there: solids, number and colour of each. */
  show(people) {
    this.people = people.filter(({ solids }) => solids.length);
    if (!this.people.length) return;
    const places = this.people.map(({ solids }) => solids[0]);
    const middle = [0, 1, 2].map((axis) => places.reduce((sum, place) => sum + place[axis], 0) / places.length);
    for (const axis of [0, 2]) this.middle[axis] += 0.15 * (middle[axis] - this.middle[axis]); // keep them in sight, calmly
    this.reach_m += 0.15 * (Math.max(...places.map(([x, , z]) => Math.hypot(x - middle[0], z - middle[2]))) - this.reach_m);
  }

  draw() {
    const { canvas } = this;
    const scale = Math.min(1.5, devicePixelRatio);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const size = [Math.round(width * scale), Math.round(height * scale)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    const pen = canvas.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.fillStyle = FLOOR;
    pen.fillRect(0, 0, width, height);
    const project = this.projection(width, height);
    this.floor(pen, project);
    this.rig(pen, project);
    const solids = this.people.flatMap((one) => one.solids.map((row, i) => placed(row, i < this.cylinders ? CYLINDER : BALL)));
    pen.fillStyle = SHADOW;
    for (const { points } of solids) fill(pen, hull(points.map((at) => project(cast(at)))));
    const seen = solids.map(({ points, middle, ...more }) => ({ ...more, outline: hull(points.map(project)), depth: project(middle)[2] }));
    seen.sort((a, b) => b.depth - a.depth).forEach((one) => shaded(pen, one, project));
    for (const { solids: rows, person, colour } of this.people) if (person) this.number(pen, rows[this.cylinders], person, colour, project);
  }

  /** A person's number above their head, which is the first ball. */
  number(pen, head, person, colour, project) {
    const [x, y, z] = head;
    const [u, v, depth] = project([x, y + head[8] + 0.14, z]);
    if (depth > 0.1) badge(pen, person, colour, [u, v], 9);
  }

  /** From metres to pixels and the distance; what is behind the spectator has none. */
  projection(width, height) {
    const { eye, middle } = this;
    const away_m = eye.away_m + 2 * this.reach_m;
    const [sy, cy, sp, cp] = [Math.sin(eye.yaw), Math.cos(eye.yaw), Math.sin(eye.pitch), Math.cos(eye.pitch)];
    const focal = (0.5 * Math.min(height, 1.15 * width)) / Math.tan(ANGLE_RAD / 2);
    return ([x, y, z]) => {
      const [a, b, c] = [x - middle[0], y - middle[1], z - middle[2]];
      const toward = a * sy + c * cy;
      const depth = away_m - (toward * cp + b * sp);
      const times = depth > 0.1 ? focal / depth : NaN;
      return [width / 2 + (a * cy - c * sy) * times, height / 2 - (b * cp - toward * sp) * times, depth];
    };
  }

  floor(pen, project) {
    const [x, z] = [0, 2].map((axis) => Math.round(this.middle[axis] / CELL_M) * CELL_M);
    const reach = CELLS * CELL_M;
    const [u, v] = project([this.middle[0], 0, this.middle[2]]);
    const far = project([this.middle[0] + reach, 0, this.middle[2]]);
    const side = project([this.middle[0], 0, this.middle[2] + reach]);
    const fade = pen.createRadialGradient(u, v, 0, u, v, Math.max(60, Math.hypot(far[0] - u, far[1] - v) || 0, Math.hypot(side[0] - u, side[1] - v) || 0));
    fade.addColorStop(0, `rgba(${LINE}, 1)`);
    fade.addColorStop(1, `rgba(${LINE}, 0)`);
    pen.strokeStyle = fade;
    pen.lineWidth = 1;
    pen.beginPath();
    for (let i = -CELLS; i <= CELLS; i += 1) {
      for (let k = -CELLS; k < CELLS; k += 1) {
        stroke(pen, project([x + i * CELL_M, 0, z + k * CELL_M]), project([x + i * CELL_M, 0, z + (k + 1) * CELL_M]));
        stroke(pen, project([x + k * CELL_M, 0, z + i * CELL_M]), project([x + (k + 1) * CELL_M, 0, z + i * CELL_M]));
      }
    }
    pen.stroke();
  }

  rig(pen, project) {
    pen.strokeStyle = CAMERA;
    pen.fillStyle = CAMERA;
    pen.font = "12px system-ui, sans-serif";
    pen.beginPath();
    this.cameras.forEach(([eye, ...corners], i) => {
      const near = corners.map((corner) => project(corner.map((value, axis) => eye[axis] + 0.3 * (value - eye[axis]))));
      const at = project(eye);
      near.forEach((corner, k) => { stroke(pen, at, corner); stroke(pen, corner, near[(k + 1) % near.length]); });
      if (at[2] > 0.1) pen.fillText(this.names[i], at[0] + 8, at[1] - 8);
    });
    pen.stroke();
  }
}

/** A solid's points in the room: scaled, turned, moved. */
function placed(row, shape) {
  const [px, py, pz, w, i, j, k, sx, sy, sz, ...colour] = row;
  const at = ([x, y, z]) => {
    const [a, b, c] = [x * sx, y * sy, z * sz];
    const [u, v, t] = [j * c - k * b + w * a, k * a - i * c + w * b, i * b - j * a + w * c];
    return [px + a + 2 * (j * t - k * v), py + b + 2 * (k * u - i * t), pz + c + 2 * (i * v - j * u)];
  };
  const high = shape === CYLINDER ? 1 : 0;
  return { points: shape.map(at), from: at([0, 0, 0]), to: at([0, high, 0]), middle: at([0, high / 2, 0]), colour };
}

/** Where the sun throws a point's shadow. */
function cast([x, y, z]) {
  return [x - (SUN[0] / SUN[1]) * y, 0, z - (SUN[2] / SUN[1]) * y];
}

/** One solid: light on the sunny side of its axis, darker at its edges. */
function shaded(pen, { outline, from, to, colour }, project) {
  if (outline.length < 3) return;
  const [a, b] = [project(from), project(to)];
  let along = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(...along);
  along = length > 2 ? along.map((value) => value / length) : [0.45, 0.9];
  let across = [-along[1], along[0]];
  if (across[0] + across[1] > 0) across = across.map((value) => -value); // to the upper left, where the sun is
  const [u, v] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
  const reach = Math.max(1, ...outline.map(([x, y]) => Math.abs((x - u) * across[0] + (y - v) * across[1])));
  const shade = pen.createLinearGradient(u + across[0] * reach, v + across[1] * reach, u - across[0] * reach, v - across[1] * reach);
  for (const [place, light] of [[0, 0.9], [0.28, 1.1], [0.62, 0.93], [1, 0.68]]) {
    shade.addColorStop(place, `rgb(${colour.map((value) => Math.min(255, value * light)).join(",")})`);
  }
  pen.fillStyle = shade;
  fill(pen, outline);
}

function fill(pen, outline) {
  if (outline.length < 3) return;
  pen.beginPath();
  outline.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.fill();
}

function stroke(pen, from, to) {
  if (Number.isNaN(from[0]) || Number.isNaN(to[0])) return;
  pen.moveTo(from[0], from[1]);
  pen.lineTo(to[0], to[1]);
}

/** The convex hull of points in the picture (Andrew's monotone chain). */
function hull(points) {
  if (points.some(([x]) => Number.isNaN(x))) return [];
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const chain = [];
    for (const [x, y] of list) {
      while (chain.length > 1) {
        const [[ax, ay], [bx, by]] = chain.slice(-2);
        if ((bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0) break;
        chain.pop();
      }
      chain.push([x, y]);
    }
    return chain.slice(0, -1);
  };
  return [...half(sorted), ...half(sorted.reverse())];
}
