// The runs: what each was, and what can be done with it.

import { ask, at, button, element, fill, size } from "./parts.js";

const FORMATS = {
  bvh: "BVH: Blender and animation", gltf: "glTF: games and the web", fbx: "FBX: Unity, Unreal, Maya", usd: "USD: film and games", trc: "TRC: OpenSim markers",
  mot: "MOT: OpenSim angles", c3d: "C3D: movement laboratory", csv: "CSV: spreadsheet", angles: "Angles: a table by clinical names",
};

export function showRuns({ runs, left_out }, hello, link) {
  at("no-runs").hidden = runs.length > 0;
  const names = runs.map(({ name }) => name);
  fill(at("runs"), runs.map((run) => ({ ...run, others: names.filter((name) => name !== run.name) })), ({ name }) => name, (run, old) => row(run, old, hello, link));
  if (left_out) at("runs").append(element("li", { className: "quiet" }, `${left_out} older runs are in the folder`));
}

function row({ name, picture, when, what, frames, believed, notes, files, replay, retouch, others }, old, hello, link) {
  const open = (page, why, words) => button(`${page}-${name}`, words, () => link.say({ type: "open", run: name, page }), { disabled: why !== "", title: why, ariaLabel: `${page} ${name}` });
  const share = believed === null ? "no person believed" : `believed in ${Math.round(100 * believed)} % of the frames with a person`;
  const format = chooser(`format-${name}`, `format of ${name}`, hello.formats.map((each) => [each, FORMATS[each] ?? each.toUpperCase()]), old);
  const other = chooser(`other-${name}`, `run to compare ${name} with`, others.map((each) => [each, each]), old);
  return element("li", { className: "run" },
    picture ? element("img", { src: picture, alt: `a frame of ${name}` }) : element("div", { className: "blank" }),
    element("div", {},
      element("h3", {}, name),
      element("p", { className: "quiet" }, `${when} · ${what} · ${frames} frames · ${share}`),
      notes.length ? element("details", {}, element("summary", { className: "warn" }, `${notes.length} ${notes.length === 1 ? "remark" : "remarks"}`), element("ul", { className: "quiet" }, ...notes.map((note) => element("li", {}, note)))) : "",
      element("div", { className: "buttons" },
        open("replay", replay, "Replay"), open("retouch", retouch, "Retouch"),
        button(`report-${name}`, "Report", () => link.say({ type: "report", run: name }), { ariaLabel: `Report of ${name}`, title: "a page with its video, angles and worst frames" }),
        pair(format, button(`export-${name}`, "Export", () => link.say({ type: "export", run: name, to: format.value }), { ariaLabel: `export ${name}` })),
        ...(others.length ? [pair(other, button(`compare-${name}`, "Compare", () => link.say({ type: "compare", run: name, other: other.value }), { ariaLabel: `compare ${name}` }))] : []),
        button(`delete-${name}`, "Delete", async () => {
          if (await ask(`Delete the run ${name}, its files, and its copy of the videos? This cannot be undone.`)) link.say({ type: "delete", what: "run", name });
        }, { className: "danger", ariaLabel: `delete ${name}` })),
      element("details", { open: old?.querySelector("details:last-of-type")?.open ?? false }, element("summary", {}, `${files.length} files`),
        ...[["Replay", replay], ["Retouch", retouch]].filter(([, why]) => why).map(([page, why]) => element("p", { className: "quiet" }, `${page}: ${why}`)),
        element("div", { className: "files" }, ...files.map(([address, file, bytes]) => element("a", { href: address, ...(file.endsWith(".html") ? { target: "_blank", rel: "noopener" } : { download: `${name}_${file}` }) }, `${file} (${size(bytes)})`))))));
}

function pair(...children) {
  return element("span", { className: "pair" }, ...children);
}

function chooser(id, label, options, old) {
  const made = element("select", { id, ariaLabel: label }, ...options.map(([value, text]) => element("option", { value }, text)));
  const before = old?.querySelector(`#${CSS.escape(id)}`)?.value;
  if (before && options.some(([value]) => value === before)) made.value = before;
  return made;
}
