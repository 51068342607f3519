// The commands that run, wait or are over.

import { at, button, element, fill } from "./parts.js";

const STATES = { waiting: "waits for its turn", running: "", done: "done", failed: "failed", cancelled: "cancelled" };

let newest = 0;

export function showJobs({ jobs }, link) {
  at("no-jobs").hidden = jobs.length > 0;
  const last = jobs.at(-1)?.job ?? 0;
  if (last > newest && link.wished) setTimeout(() => at("jobs").firstElementChild?.scrollIntoView({ block: "nearest" }));
  if (last > newest) link.wished = false;
  newest = last;
  fill(at("jobs"), [...jobs].reverse(), ({ job }) => job, (job, old) => row(job, old, link));
}

function row({ job, title, command, state, share, doing, lines, told, address, bus, made, again }, old, link) {
  const over = state !== "running" && state !== "waiting";
  const isOpen = old?.querySelector("details")?.open ?? false;
  const words = [STATES[state], doing, told].filter(Boolean).join(": ");
  const bar = address || over ? "" : element("progress", { max: 1, value: share, "aria-label": `${title}: share done` });
  return element("li", { className: "row", "data-state": state },
    element("div", {}, element("h3", {}, title), element("code", {}, command)),
    element("div", { className: "buttons" },
      address ? element("a", { id: `page-${job}`, className: "button", href: address, target: "_blank", rel: "noopener" }, "Open its page") : "",
      made ? element("a", { className: "button", href: made, ...(made.endsWith(".html") ? { target: "_blank", rel: "noopener" } : { download: title.split(":")[0] + "_" + made.split("/").pop() }) }, `${made.endsWith(".html") ? "Open" : "Download"} ${made.split("/").pop()}`) : "",
      again ? button(`again-${job}`, "Put its videos back", () => link.say({ type: "again", job }), { ariaLabel: `Put the videos of ${title} back` }) : "",
      over ? "" : button(`cancel-${job}`, address ? "End" : "Cancel", () => link.say({ type: "cancel", job }), { ariaLabel: `${address ? "End" : "Cancel"}: ${title}` })),
    element("div", { style: "grid-column: 1 / -1" }, bar,
      element("p", { className: state === "failed" ? "bad" : state === "done" && told && told !== "closed" ? "warn" : "quiet", role: state === "failed" ? "alert" : "status" }, words),
      bus ? element("p", { className: "quiet" }, "Poses for your program: in Python ", element("code", {}, `tritrack.subscribe("${bus}")`), ", elsewhere by WebSocket, OSC, VMC or LSL: ", element("code", {}, `tritrack bridge websocket --endpoint ${bus}`)) : "",
      lines.length ? element("details", { open: isOpen }, element("summary", {}, "what it printed"), element("pre", { tabIndex: 0, ariaLabel: `${title}: what it printed` }, lines.join("\n"))) : ""));
}
