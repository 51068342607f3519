// The words beside the body: posture, rivals, what was performed, health, the end.

const at = (id) => document.getElementById(id);
export const spoken = (name) => name.replaceAll("_", " ");

export function element(tag, text, more = {}) {
  return Object.assign(document.createElement(tag), { textContent: text, ...more });
}

function set(id, text) {
  if (at(id).textContent !== text) at(id).textContent = text;
}

export function showStatus(status, words) {
  at("status").dataset.status = status;
  set("words", words);
}

export function showPosture({ person, posture }, colour) {
  const doing = posture?.doing ?? "";
  at("posture").classList.toggle("idle", !doing);
  set("who", person || "");
  at("who").style.background = colour;
  set("name", spoken(posture?.name ?? "") || "no posture yet");
  set("times", doing && posture.times > 1 ? `× ${posture.times}` : "");
  const rows = [...at("rivals").children];
  const rivals = posture?.rivals ?? [];
  while (rows.length < rivals.length) {
    rows.push(document.createElement("div"));
    rows.at(-1).append(document.createElement("b"), document.createElement("output"), document.createElement("i"));
    at("rivals").append(rows.at(-1));
  }
  rows.forEach((row, i) => {
    row.hidden = i >= rivals.length;
    if (row.hidden) return;
    const [name, share] = rivals[i];
    const [label, number, bar] = row.children;
    label.textContent = spoken(name);
    number.textContent = percent(share);
    bar.style.backgroundSize = `${(100 * share).toFixed(1)}% 100%`;
  });
}

function percent(share) {
  if (share > 0.995 && share < 1) return "> 99 %";
  return share < 0.005 ? "< 1 %" : `${Math.round(100 * share)} %`;
}

/** What was performed so far: each once, the newest first, and how often each. */
export class Events {
  constructor(seek) {
    this.seek = seek;
    this.last = new Map(); // by person
    this.times = new Map();
  }

  add(event) {
    const last = this.last.get(event.person);
    const goesOn = last?.event.name === event.name && last.event.onset_s === event.onset_s;
    const counted = goesOn ? Math.max(1, last.event.times) : 0;
    if (goesOn) last.item.remove();
    const name = (event.person ? `${event.person}: ` : "") + spoken(event.name);
    this.times.set(name, (this.times.get(name) ?? 0) + Math.max(1, event.times) - counted);
    set("counts", [...this.times].map(([each, times]) => `${each} ${times}`).join(" · "));
    const button = element("button", name + (event.times > 1 ? ` × ${event.times}` : ""), { type: "button" });
    button.append(element("span", `${event.onset_s.toFixed(1)}–${event.end_s.toFixed(1)} s`));
    button.setAttribute("aria-label", `show ${name} at ${event.onset_s.toFixed(1)} seconds`);
    button.addEventListener("click", () => this.seek(event.onset_s));
    const item = document.createElement("li");
    item.append(button);
    at("events").prepend(item);
    this.last.set(event.person, { event, item });
  }
}

export function showHealth(pulses) {
  const running = pulses.filter((pulse) => pulse.state === "running" && pulse.process !== "animator");
  const sum = (name) => pulses.reduce((all, pulse) => all + (pulse.process === "animator" ? 0 : pulse[name]), 0);
  const [missed, lost] = [sum("deadline_misses"), sum("dropped") + sum("late")];
  const waits = pulses.find((pulse) => pulse.state === "restarting" || pulse.state === "given up");
  const odd = pulses.filter((pulse) => pulse.process !== "animator").flatMap((pulse) => pulse.detail.split("\n").filter(Boolean).map((line) => `${pulse.process}: ${line}`));
  const words = running.length
    ? [`${Math.min(...running.map((pulse) => pulse.fps)).toFixed(1)} frames a second`,
      `${Math.max(...running.map((pulse) => pulse.latency_p50_ms)).toFixed(0)} ms from camera to pose`,
      missed ? `${missed} deadlines missed` : "no deadline missed",
      ...(lost ? [`${lost} messages lost`] : [])]
    : pulses.every((pulse) => pulse.state === "ended" || pulse.process === "animator")
      ? ["all processes have ended", missed ? `${missed} deadlines missed` : "no deadline missed"]
      : [`${pulses.length} processes, ${pulses.filter((pulse) => pulse.state === "ready").length} ready`];
  if (waits) words.unshift(`${waits.process} is ${waits.state}`);
  set("pulse", words.join(" · "));
  at("processes").replaceChildren(...pulses.map((pulse) => {
    const row = document.createElement("tr");
    row.append(...[pulse.process, pulse.state, pulse.fps.toFixed(1), pulse.latency_p50_ms.toFixed(0), pulse.latency_p99_ms.toFixed(0),
      pulse.deadline_misses, pulse.dropped + pulse.late, pulse.memory_mb.toFixed(0)].map((text) => element("td", text)));
    return row;
  }));
  at("notes").replaceChildren(...odd.map((line) => element("li", line)));
}

export function showTold(well, text) {
  at("told").classList.toggle("bad", !well);
  at("told").textContent = text;
}

export function showTrust(text) {
  at("trust").hidden = !text;
  set("trust", text);
}

/** What came of a run, as its summary tells it. */
export function showEnding(facts, frames) {
  const posed = frames.filter((frame) => frame.angles.length).length;
  const rows = {
    clip: facts.clip, person: facts.performer, posture: spoken(facts.posture ?? ""),
    frames: `${facts.frames ?? frames.length}, ${facts.frames_with_pose ?? posed} with a pose`,
    "written to": facts.out, scale: facts.scale_source,
    "deadlines missed": Object.entries(facts.processes ?? {}).filter(([name, each]) => name !== "animator" && each.deadline_misses)
      .map(([name, each]) => `${name}: ${each.deadline_misses}`).join(", ") || "none",
  };
  at("summary").replaceChildren(...Object.entries(rows).filter(([, value]) => value)
    .flatMap(([name, value]) => [element("dt", name), element("dd", value)]));
  at("warnings").replaceChildren(...(facts.warnings ?? []).map((line) => element("li", line)));
  at("ending").hidden = false;
}
