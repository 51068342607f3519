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

  /** Draw a view of a frame; null where the camera says nothing. */
  show(view, confidence, greeting) {
    this.sees.textContent = view?.sees ? `sees ${view.sees}` : "";
    this.score.textContent = view?.joints.length ? `fit ${view.score.toFixed(2)}` : "";
    this.hint.textContent = view ? view.hint : "nothing heard from it";
    this.canvas.setAttribute("aria-label", view
      ? `${this.name}: ${view.joints.length ? `the person, ${view.sees}` : "nobody"}${view.hint ? `, ${view.hint}` : ""}`
      : `${this.name}: nothing heard from it`);
    if (view?.jpeg) this.load(view, confidence, greeting);
    else this.draw(view, confidence, greeting, null);
  }

  /** A picture is decoded by the browser; the frame is drawn when that is done. */
  load(view, confidence, greeting) {
    const wanted = view;
    this.wanted = wanted;
    const image = new Image();
    image.src = `data:image/jpeg;base64,${view.jpeg}`;
    image.decode().catch(() => null).then(() => {
      if (this.wanted === wanted) this.draw(view, confidence, greeting, image.naturalWidth ? image : null);
    });
  }

  draw(view, confidence, greeting, picture) {
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
    if (!view.joints.length) return;
    limbs(pen, view.limbs, greeting, pixel);
    strokes(pen, view.joints, greeting, pixel);
    joints(pen, view.joints, confidence, greeting, pixel);
  }
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

function limbs(pen, contours, greeting, pixel) {
  pen.lineWidth = LIMB_WIDTH * pixel * 0.7;
  contours.forEach((points, i) => {
    if (points.length < 6) return;
    pen.beginPath();
    path(pen, points);
    pen.strokeStyle = sideColour(greeting.limbs[i], greeting.colours);
    pen.stroke();
  });
}

/** Hands and feet, of a body that tells them. */
function strokes(pen, places, greeting, pixel) {
  pen.lineWidth = LIMB_WIDTH * pixel * 0.7;
  for (const [from, to] of greeting.strokes) {
    if (places.length <= 2 * Math.max(from, to)) continue;
    pen.beginPath();
    pen.moveTo(places[2 * from], places[2 * from + 1]);
    pen.lineTo(places[2 * to], places[2 * to + 1]);
    pen.strokeStyle = sideColour(greeting.joints[to], greeting.colours);
    pen.stroke();
  }
}

function joints(pen, places, confidence, greeting, pixel) {
  greeting.joints.slice(0, places.length / 2).forEach((name, i) => {
    const sure = confidence[i] ?? 0;
    pen.beginPath();
    pen.arc(places[2 * i], places[2 * i + 1], (i < greeting.large ? 1.6 + 1.6 * sure : 1.3) * pixel, 0, 2 * Math.PI);
    pen.fillStyle = sideColour(name, greeting.colours);
    pen.strokeStyle = "#fff";
    pen.lineWidth = 0.8 * pixel;
    if (sure >= SURE) pen.fill();
    pen.globalAlpha = 0.35 + 0.65 * sure;
    pen.stroke();
    pen.globalAlpha = 1;
  });
}
