// The room from above: x to the right, z down the page, towards camera 1.

import { penOf } from "./picture.js";

const MARGIN_PX = 22;

export function drawPlan(canvas, plan, labels) {
  const pen = penOf(canvas);
  if (!plan?.cameras.length) return;
  const places = [[0, 0], ...plan.cameras, ...plan.marks];
  const [xs, zs] = [places.map((each) => each[0]), places.map((each) => each[1])];
  const [low, high] = [[Math.min(...xs), Math.min(...zs)], [Math.max(...xs), Math.max(...zs)]];
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  const scale = Math.min((width - 2 * MARGIN_PX) / Math.max(0.5, high[0] - low[0]), (height - 2 * MARGIN_PX) / Math.max(0.5, high[1] - low[1]));
  const at = (x, z) => [width / 2 + (x - (low[0] + high[0]) / 2) * scale, height / 2 + (z - (low[1] + high[1]) / 2) * scale];
  axis(pen, at, [low[0], 0], [high[0], 0]);
  axis(pen, at, [0, low[1]], [0, high[1]]);
  plan.cameras.forEach(([x, z, bearing_deg, wide_deg], i) => {
    const far = Math.hypot(x, z) || 1;
    pen.beginPath();
    pen.moveTo(...at(x, z));
    for (const turn of [-wide_deg / 2, wide_deg / 2]) {
      const angle = ((bearing_deg + turn) * Math.PI) / 180;
      pen.lineTo(...at(x + far * Math.cos(angle), z + far * Math.sin(angle)));
    }
    pen.closePath();
    pen.fillStyle = "rgba(63, 120, 181, .13)";
    pen.fill();
    const angle = (bearing_deg * Math.PI) / 180;
    pen.beginPath();
    pen.moveTo(...at(x, z));
    pen.lineTo(...at(x + far * Math.cos(angle), z + far * Math.sin(angle)));
    pen.strokeStyle = "#3f78b5";
    pen.lineWidth = 1.2;
    pen.stroke();
    dot(pen, at(x, z), 5, "#3f78b5", `camera ${i + 1}`);
  });
  for (const [x, z, mark] of plan.marks) dot(pen, at(x, z), 3, "#c77f2c", labels[mark] ?? "");
}

function axis(pen, at, from, to) {
  pen.beginPath();
  pen.moveTo(...at(...from));
  pen.lineTo(...at(...to));
  pen.strokeStyle = "#dfe4e9";
  pen.lineWidth = 1;
  pen.stroke();
}

function dot(pen, [x, y], radius, ink, label) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = ink;
  pen.fill();
  pen.font = "12px system-ui, sans-serif";
  pen.fillText(label, x + radius + 3, y - 3);
}
