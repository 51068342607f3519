// What each camera sees: its picture or the night, the silhouette, the fitted body, the joints.

const NIGHT = "#1c2129";
const LIMB_WIDTH = 1.6;
const SURE = 0.5; // joints that are less sure are hollow

export class View {
  constructor(name, place) {
    this.figure = document.createElement("figure");
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    const caption = document.createElement("figcaption");
    const title = document.createElement("b");
    title.textContent = name;
    this.sees = Object.assign(document.createElement("span"), { className: "sees" });
    this.score = document.createElement("span");
    this.hint = Object.assign(document.createElement("span"), { className: "hint" });
    caption.append(title, this.sees, this.score, this.hint);
    this.figure.append(this.canvas, caption);
    place.append(this.figure);
    this.name = name;
    this.picture = null;
    this.wanted = "";
  }

  /** Draw a view of a frame, null where the camera says nothing, with the body of each person: its fit, confidence and colour. */
  show(view, people, looked, greeting) {
    this.sees.textContent = looked?.sees ? `sees ${looked.sees}` : "";
    this.score.textContent = looked?.joints.length ? `fit ${looked.score.toFixed(2)}` : "";
    const hint = view ? view.fault || advice(people) : "nothing heard from it";
    this.hint.textContent = hint;
    this.canvas.setAttribute("aria-label", `${this.name}: ${[...(view ? [seen(people)] : []), ...(hint ? [hint] : [])].join(", ")}`);
    if (view?.jpeg) this.load(view, people, greeting);
    else this.draw(view, people, greeting, null);
  }

  /** A picture is decoded by the browser; the frame is drawn when that is done. */
  load(view, people, greeting) {
    const wanted = view;
    this.wanted = wanted;
    const image = new Image();
    image.src = `data:image/jpeg;base64,${view.jpeg}`;
    image.decode().catch(() => null).then(() => {
      if (this.wanted === wanted) this.draw(view, people, greeting, image.naturalWidth ? image : null);
    });
  }

  draw(view, people, greeting, picture) {
    this.wanted = view;
    const [width, height] = view ? view.size : [320, 240];
    const times = Math.max(1, Math.min(4, Math.ceil((this.canvas.clientWidth * devicePixelRatio) / width)));
    if (this.canvas.width !== width * times || this.canvas.height !== height * times) {
      Object.assign(this.canvas, { width: width * times, height: height * times });
      this.canvas.style.aspectRatio = `${width} / ${height}`;
    }
    const pen = this.canvas.getContext("2d");
    pen.setTransform(times, 0, 0, times, 0, 0);
    pen.fillStyle = NIGHT;
    pen.fillRect(0, 0, width, height);
    if (picture) pen.drawImage(picture, 0, 0, width, height);
    if (!view) return;
    const pixel = Math.max(1, width / 320); // one as large as it is in a small picture
    silhouette(pen, view.outline, Boolean(picture), pixel);
    for (const one of people) if (one.fit?.joints.length) body(pen, one, greeting, pixel);
  }
}

/** Words for who is seen. */
function seen(people) {
  const there = people.filter(({ fit }) => fit?.joints.length);
  return there.map(({ person, fit }) => `${person ? `person ${person}` : "the person"}, ${fit.sees}`).join("; ") || "nobody";
}

/** What each person can do to be seen better or measured, several by their numbers. */
function advice(people) {
  const asked = people.filter(({ fit }) => fit?.advice);
  return asked.map(({ person, fit }) => `${person ? `person ${person}: ` : ""}${fit.advice}`).join("; ");
}

/** A person: limbs, hands and feet, joints, in their own colour, or one alone in those of the sides. */
function body(pen, { person, fit, confidence, colour }, greeting, pixel) {
  const inks = (name) => colour ?? sideColour(name, greeting.colours);
  limbs(pen, fit.limbs, greeting, inks, pixel);
  strokes(pen, fit.joints, greeting, inks, pixel);
  joints(pen, fit.joints, confidence, greeting, inks, pixel);
  if (!person) return;
  const top = fit.joints.reduce((best, y, i) => (i % 2 && y < fit.joints[best] ? i : best), 1);
  badge(pen, person, colour, [fit.joints[top - 1], fit.joints[top] - 9 * pixel], 6 * pixel);
}

/** A person's number on a disc of their colour. */
export function badge(pen, number, colour, [x, y], radius) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = colour;
  pen.fill();
  pen.font = `600 ${1.5 * radius}px system-ui, sans-serif`;
  Object.assign(pen, { textAlign: "center", textBaseline: "middle", fillStyle: "#fff", strokeStyle: "#000", lineWidth: radius / 4, lineJoin: "round" });
  pen.strokeText(number, x, y);
  pen.fillText(number, x, y);
  Object.assign(pen, { textAlign: "start", textBaseline: "alphabetic" });
}

function path(pen, points) {
  pen.moveTo(points[0], points[1]);
  for (let i = 2; i < points.length; i += 2) pen.lineTo(points[i], points[i + 1]);
  pen.closePath();
}

function silhouette(pen, outline, onPicture, pixel) {
  pen.beginPath();
  for (const points of outline) path(pen, points);
  pen.fillStyle = onPicture ? "rgba(120, 220, 200, .20)" : "#50747c";
  pen.fill("evenodd");
  pen.strokeStyle = onPicture ? "rgba(170, 245, 230, .9)" : "#8fb4ba";
  pen.lineWidth = 0.9 * pixel;
  pen.stroke();
}

export function sideColour(name, colours) {
  const side = name.startsWith("l_") ? "left" : name.startsWith("r_") ? "right" : "trunk";
  return `rgb(${colours[side].join(",")})`;
}

function limbs(pen, contours, greeting, inks, pixel) {
  pen.lineWidth = LIMB_WIDTH * pixel * 0.7;
  contours.forEach((points, i) => {
    if (points.length < 6) return;
    pen.beginPath();
    path(pen, points);
    pen.strokeStyle = inks(greeting.limbs[i]);
    pen.stroke();
  });
}

/** Hands and feet, of a body that tells them. */
function strokes(pen, places, greeting, inks, pixel) {
  pen.lineWidth = LIMB_WIDTH * pixel * 0.7;
  for (const [from, to] of greeting.strokes) {
    if (places.length <= 2 * Math.max(from, to)) continue;
    pen.beginPath();
    pen.moveTo(places[2 * from], places[2 * from + 1]);
    pen.lineTo(places[2 * to], places[2 * to + 1]);
    pen.strokeStyle = inks(greeting.joints[to]);
    pen.stroke();
  }
}

function joints(pen, places, confidence, greeting, inks, pixel) {
  greeting.joints.slice(0, places.length / 2).forEach((name, i) => {
    const sure = confidence[i] ?? 0;
    pen.beginPath();
    pen.arc(places[2 * i], places[2 * i + 1], (i < greeting.large ? 1.6 + 1.6 * sure : 1.3) * pixel, 0, 2 * Math.PI);
    pen.fillStyle = inks(name);
    pen.strokeStyle = "#fff";
    pen.lineWidth = 0.8 * pixel;
    if (sure >= SURE) pen.fill();
    pen.globalAlpha = 0.35 + 0.65 * sure;
    pen.stroke();
    pen.globalAlpha = 1;
  });
}
