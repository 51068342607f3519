// The clips that the cameras recorded: to be worked on, or deleted.

import { ask, at, button, element, fill } from "./parts.js";

export function showRecordings({ recordings }, link) {
  at("recorded").hidden = recordings.length === 0;
  fill(at("recordings"), recordings, ({ name }) => name, (each) => row(each, link));
}

function row({ name, when, says }, link) {
  return element("li", { className: "row" },
    element("div", {}, element("h4", {}, name), element("p", { className: "quiet" }, `${when} · ${says}`)),
    element("div", { className: "buttons" },
      button(`take-${name}`, "Work on it", () => {
        link.say({ type: "take", name });
        at("files").scrollIntoView({ block: "nearest" });
      }, { ariaLabel: `Work on it: ${name}` }),
      button(`delete-recording-${name}`, "Delete", async () => {
        if (await ask(`Delete the recording ${name}? This cannot be undone.`)) link.say({ type: "delete", what: "recording", name });
      }, { className: "danger", ariaLabel: `Delete the recording ${name}` })));
}
