// The kept calibrations: what is good of each, and what is not.

import { ask, at, button, element, fill, offer } from "./parts.js";

export function showCalibrations({ calibrations, board }, link) {
  fill(at("calibrations"), calibrations, ({ name }) => name, (each) => row(each, link));
  const names = calibrations.map(({ name }) => name);
  for (const id of ["calibration", "live-calibration"]) offer(at(id), names);
  at("board-file").hidden = board === "";
  if (board) at("board-file").href = board;
}

function row({ name, when, cameras, told, address }, link) {
  return element("li", { className: "row" },
    element("div", {}, element("h3", {}, name), element("p", { className: "quiet" }, `${when} · ${cameras} cameras`)),
    element("div", { className: "buttons" },
      element("a", { href: address, download: `${name}.json` }, "Download"),
      button(`delete-calibration-${name}`, "Delete", async () => {
        if (await ask(`Delete the calibration ${name}? This cannot be undone.`)) link.say({ type: "delete", what: "calibration", name });
      }, { className: "danger", ariaLabel: `delete the calibration ${name}` })),
    told ? element("details", { open: true, style: "grid-column: 1 / -1" }, element("summary", {}, "how good it is"), element("pre", { tabIndex: 0, ariaLabel: `how good ${name} is` }, told)) : "");
}
