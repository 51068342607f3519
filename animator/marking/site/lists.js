// What stands beside the picture: points, numbers, the result.

export const READ_PX = 0.5; // by so much a point that was read to the pixel may be off
const at = (id) => document.getElementById(id);

export function element(kind, text, given = {}) {
  const made = document.createElement(kind);
  made.textContent = text;
  return Object.assign(made, given);
}

export const label = (board, names, mark) => {
  const { kind } = board.sheet.marks[mark];
  if (kind === "pole") return names[mark]?.split(" ")[1] ?? `${mark + 1}`;
  return `${kind[0]}${board.sheet.marks.slice(0, mark + 1).filter((each) => each.kind === kind).length}`;
};

/** Draw the list anew only when its rows change: what is typed into must stay. */
export class Points {
  constructor(board, act) { [this.board, this.act, this.rows] = [board, act, []]; }

  show(solved) {
    const { marks } = this.board.sheet;
    const kinds = marks.map((mark) => mark.kind).join();
    if (this.kinds !== kinds) {
      this.kinds = kinds;
      this.rows = marks.map((mark, i) => this.row(mark, i));
      at("points").replaceChildren(this.head(), ...this.rows.map((row) => row.item));
    }
    this.rows.forEach((row, i) => this.fill(row, i, solved));
  }

  head() {
    const { pictures, method } = this.board.hello;
    const head = element("li", "", { className: pictures.length < 2 ? "head two" : "head", ariaHidden: "true" });
    head.append(element("span", method === "poles" ? "x and z, m" : ""), ...pictures.map(({ number }) => element("span", `camera ${number}, off by`)));
    return head;
  }

  row(mark, i) {
    const { pictures } = this.board.hello;
    const item = element("li", "", { className: pictures.length < 2 ? "two" : "" });
    const name = element("span", "", { className: "name" });
    const title = element("b", "");
    name.append(title);
    const places = mark.kind !== "pole" ? [] : ["x", "z"].map((axis, n) => {
      const input = Object.assign(document.createElement("input"), { type: "number", step: "any", min: -1000, max: 1000, required: true });
      input.addEventListener("change", () => {
        const at_m = [...this.board.sheet.marks[i].at_m];
        at_m[n] = Number(input.value);
        if (input.value !== "" && input.checkValidity()) this.act(() => this.board.move(i, at_m));
      });
      return input;
    });
    name.append(...places);
    const cells = pictures.map((_, camera) => {
      const cell = element("button", "", { className: "px" });
      cell.addEventListener("click", () => this.act(() => this.board.pick(camera, i), true));
      return cell;
    });
    const gone = element("button", "×", { className: "gone" });
    gone.addEventListener("click", () => this.act(() => this.board.remove(i)));
    item.append(name, ...cells, gone);
    return { item, title, places, cells, gone };
  }

  fill({ title, places, cells, gone }, i, solved) {
    const { board } = this;
    const name = solved.names[i] ?? `point ${i + 1}`;
    title.textContent = places.length ? label(board, solved.names, i) : name.replace(" marker, point", "");
    places.forEach((input, n) => {
      input.ariaLabel = `${"xz"[n]} of ${name}, metres`;
      if (document.activeElement !== input) input.value = board.sheet.marks[i].at_m[n];
    });
    gone.ariaLabel = `no ${name}`;
    cells.forEach((cell, camera) => {
      const { number } = board.hello.pictures[camera];
      const px = board.at(i, number - 1);
      const off_px = px ? solved.cameras[camera]?.off_px[i] : null;
      const worst = solved.worst_at?.[0] === camera && solved.worst_at[1] === i && off_px > READ_PX;
      const own = camera === board.camera;
      cell.className = `px${px ? "" : " empty"}${own && board.next === i && board.picked === null ? " next" : ""}${own && board.picked === i ? " picked" : ""}${worst ? " worst" : ""}`;
      cell.replaceChildren(px ? `${px[0].toFixed(1)}, ${px[1].toFixed(1)}` : "–");
      if (typeof off_px === "number") cell.append(element("em", ` ${off_px.toFixed(1)}`));
      const off = typeof off_px === "number" ? `, ${off_px.toFixed(2)} pixels off` : "";
      cell.ariaLabel = `${name} in camera ${number}: ${px ? `${px.join(", ")}${off}` : "not clicked"}`;
    });
  }
}

/** The numbers beside the points; the width of view that a focal length means is told. */
export class Numbers {
  constructor(board, act) {
    this.board = board;
    this.inputs = board.hello.numbers.map(({ key, label: words, unit, needed }) => {
      const input = Object.assign(document.createElement("input"), { type: "number", step: "any", min: 0, required: needed, id: key });
      const unitShown = element("small", unit);
      const row = element("label", "");
      row.append(element("span", needed ? words : `${words} (if known)`), input, unitShown);
      at("numbers").append(row);
      input.addEventListener("change", () => {
        if (input.value === "" || Number(input.value) > 0) act(() => board.say(key, input.value === "" ? null : Number(input.value)));
      });
      return { key, input, unit, unitShown };
    });
  }

  show() {
    for (const { key, input, unit, unitShown } of this.inputs) {
      const value = this.board.sheet.numbers[key] ?? null;
      if (document.activeElement !== input) input.value = value ?? "";
      const wide_deg = (360 / Math.PI) * Math.atan(this.board.hello.size[0] / 2 / value);
      unitShown.textContent = unit === "px" && value ? `px, ${wide_deg.toFixed(0)}° wide` : unit;
    }
  }
}

export function showResult(board, solved) {
  at("result").replaceChildren(...solved.cameras.map((seen, i) => {
    const part = element("div", "");
    part.append(element("h3", `camera ${board.hello.pictures[i].number}`));
    if (!seen.known) part.append(element("p", seen.text));
    const facts = element("dl", "");
    for (const [name, value] of seen.facts) facts.append(element("dt", name), element("dd", value));
    part.append(facts);
    return part;
  }));
  const off_px = solved.worst_at ? solved.cameras[solved.worst_at[0]].off_px[solved.worst_at[1]] : null;
  const told = off_px > READ_PX ? "look first at" : "all points agree; farthest off is";
  at("worst").textContent = off_px === null ? "" : `${told} ${solved.worst}: ${off_px.toFixed(2)} px`;
  at("worst").className = off_px > READ_PX ? "bad" : "";
}
