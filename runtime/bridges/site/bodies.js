// Bodies and postures of a live run, from `tritrack bridge websocket`, without a library.
// Each message: {"body": {...}} or {"posture": {...}}, as docs/messages.schema.json describes them.
// A page on another port of this machine connects to ws://127.0.0.1:8765/bodies.

// joints_m has 15 places [x, y, z] in metres, +y up, +x to the left of who faces camera 1: pelvis,
// neck, head_top, then shoulder, elbow, wrist, hip, knee, ankle of the left, and of the right.
const LIMBS = [[0, 1], [1, 2], [3, 4], [4, 5], [6, 7], [7, 8], [9, 10], [10, 11], [12, 13], [13, 14], [3, 9], [6, 12]];
const R_ELBOW_X = 15; // in `pose`, which is [x, y, z] and 26 angles in degrees: docs/messages.schema.json names them
const COLOURS = ["#2f7d6d", "#a4552a", "#3f78b5", "#8a4f9e"];
const FADES_MS = 1000; // a person of whom nothing came for so long is not drawn

const people = new Map(); // by number: {body, posture, at_ms}
const state = document.getElementById("state"), rows = document.getElementById("people");
const front = document.getElementById("front");

function connect() {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const socket = new WebSocket(`${scheme}://${location.host}/bodies`, "tritrack.json");
  socket.onopen = () => { state.textContent = "connected, waiting for bodies"; };
  socket.onmessage = ({ data }) => {
    const message = JSON.parse(data), said = message.body ?? message.posture;
    const person = people.get(said.person) ?? {};
    if (message.body) { Object.assign(person, { body: said, at_ms: performance.now() }); state.textContent = `frame ${said.frame}`; }
    if (message.posture) person.posture = said;
    people.set(said.person, person);
  };
  socket.onclose = () => { state.textContent = "no connection: the run is over, or the bridge"; setTimeout(connect, 2000); };
}

function draw() {
  for (const [number, { at_ms = 0 }] of people) if (performance.now() - at_ms > FADES_MS) people.delete(number);
  const scale = devicePixelRatio, { clientWidth: wide, clientHeight: high } = front, pen = front.getContext("2d");
  if (front.width !== wide * scale) Object.assign(front, { width: wide * scale, height: high * scale });
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.clearRect(0, 0, wide, high);
  const px_per_m = high / 2.4, floor_px = high - 0.15 * px_per_m;
  pen.lineCap = "round";
  for (const [number, { body }] of people) {
    if (!body?.joints_m.length) continue;
    pen.strokeStyle = COLOURS[number % COLOURS.length];
    for (const [from, to] of LIMBS) {
      const ends = [body.joints_m[from], body.joints_m[to]].map(([x, y]) => [wide / 2 + x * px_per_m, floor_px - y * px_per_m]);
      pen.lineWidth = from === 0 ? 10 : 6;
      pen.beginPath(); pen.moveTo(...ends[0]); pen.lineTo(...ends[1]); pen.stroke();
    }
  }
  requestAnimationFrame(draw);
}

function list() {
  rows.replaceChildren(...[...people].map(([number, { body, posture }]) => {
    const row = document.createElement("tr"), elbow_deg = body?.pose[R_ELBOW_X];
    const words = [number, body?.status ?? "", posture?.doing || "stands", elbow_deg === undefined ? "" : `${elbow_deg.toFixed(0)} deg`];
    for (const word of words) row.appendChild(document.createElement("td")).textContent = word;
    return row;
  }));
}

connect();
draw();
setInterval(list, 200);
