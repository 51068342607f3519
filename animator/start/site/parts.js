// Elements of the lists, made anew when they change; what has the focus keeps it.

export const at = (id) => document.getElementById(id);

/** An element with properties and children; `data` and `aria-` names are attributes. */
export function element(name, properties = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(properties)) {
    if (key in made) made[key] = value;
    else made.setAttribute(key, value);
  }
  made.append(...children.filter((child) => child !== null && child !== ""));
  return made;
}

export function button(id, text, act, properties = {}) {
  const made = element("button", { id, type: "button", ...properties }, text);
  made.addEventListener("click", act);
  return made;
}

/** Fill a list; an item that is as before stays, so that a picture does not flicker nor a list jump. */
export function fill(list, items, keyOf, make) {
  const before = new Map([...list.children].map((child) => [child.dataset.key, child]));
  const focused = document.activeElement?.id;
  const now = items.map((item, n) => {
    const said = JSON.stringify(item);
    const old = before.get(String(keyOf(item, n)));
    if (old?.said === said) return old;
    const made = make(item, old);
    made.dataset.key = keyOf(item, n);
    made.said = said;
    return made;
  });
  if (now.length !== list.children.length || now.some((child, n) => child !== list.children[n])) list.replaceChildren(...now);
  if (focused && document.activeElement?.id !== focused) at(focused)?.focus();
}

export function size(bytes) {
  if (bytes < 1e6) return `${Math.max(1, Math.round(bytes / 1e3))} kB`;
  return bytes < 1e9 ? `${(bytes / 1e6).toFixed(1)} MB` : `${(bytes / 1e9).toFixed(2)} GB`;
}

/** Fill a choice of calibrations, without losing what is chosen. */
export function offer(select, names) {
  const chosen = select.value;
  select.replaceChildren(select.options[0], ...names.map((name) => element("option", { value: name }, name)));
  select.value = names.includes(chosen) ? chosen : "";
}

/** Ask before something is deleted. */
export function ask(question) {
  const dialog = at("asking");
  at("question").textContent = question;
  dialog.returnValue = "no";
  dialog.showModal();
  return new Promise((answer) => dialog.addEventListener("close", () => answer(dialog.returnValue === "yes"), { once: true }));
}
