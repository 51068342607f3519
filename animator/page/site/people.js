// The people of a run that follows several: who is there, who has just left, whose numbers are looked at.

import { element, spoken } from "./panel.js";

const GONE_S = 1; // so long is a person who left still in the list

/** The people of a frame by number; without any, or in a run that follows one person, whose number is 0, there is one. */
export const everyone = (frame) => [frame, ...frame.others];

export class People {
  constructor(list, palette, changed) {
    this.list = list;
    this.palette = palette;
    this.changed = changed;
    this.chosen = 0; // 0: the first there is
    this.several = false;
  }

  /** A person's colour; one alone has those of the sides of a body. */
  colour(number) {
    return number ? `rgb(${this.palette[(number - 1) % this.palette.length].join(",")})` : null;
  }

  /** The person of a frame whose posture and angles are looked at. */
  of(frame) { return everyone(frame).find(({ person }) => person === this.chosen) ?? frame; }

  /** Draw the list, once a person has a number; those who left within the last second are grey. */
  show(history) {
    const frame = history.shown;
    this.several ||= everyone(frame).some(({ person }) => person);
    if (!this.several) return;
    document.body.classList.add("several");
    const rows = new Map();
    for (let at = history.at; at >= 0 && history.frames[at].time_s > frame.time_s - GONE_S; at -= 1) {
      for (const one of everyone(history.frames[at])) {
        if (one.person && !rows.has(one.person)) rows.set(one.person, at === history.at ? one : null);
      }
    }
    const numbers = [...rows.keys()].sort((a, b) => a - b);
    while (this.list.children.length > numbers.length) this.list.lastChild.remove();
    while (this.list.children.length < numbers.length) this.list.append(this.row());
    const looked = this.of(frame).person;
    numbers.forEach((number, i) => this.fill(this.list.children[i].firstChild, number, rows.get(number), looked));
  }

  row() {
    const button = element("button", "", { type: "button" });
    button.append(element("span", "", { className: "badge" }), element("b", ""), element("span", "", { className: "how" }));
    button.addEventListener("click", () => { this.chosen = Number(button.dataset.person); this.changed(); });
    const item = document.createElement("li");
    item.append(button);
    return item;
  }

  fill(button, number, one, looked) {
    const [badge, name, how] = button.children;
    button.dataset.person = number;
    button.classList.toggle("away", !one || one.status === "lost");
    button.setAttribute("aria-pressed", number === looked);
    badge.textContent = number;
    badge.style.background = this.colour(number);
    name.textContent = spoken(one?.posture?.name ?? "") || "no posture yet";
    name.classList.toggle("idle", !one?.posture?.doing);
    how.textContent = one ? one.words : "gone";
  }
}
