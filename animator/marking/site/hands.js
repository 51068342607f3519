// Pointer, finger and keys: what they do to the board.

import { LOUPE } from "./stage.js";

const NEAR_PX = 12; // of the screen: so near a point is meant, not another place
const DRAG_PX = 4;
const FINE_PX = 0.25;
const FAR_PX = 8;
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const at = (id) => document.getElementById(id);

/** From now on what the person does is done to the board, through `act`, or seen on the stage. */
export function listen(stage, act, save) {
  const { board, loupe } = stage;
  pointer(stage, act);
  loupe.addEventListener("click", (event) => {
    const [x, y] = within(loupe, event);
    act(() => board.nudge([(x - loupe.clientWidth / 2) / LOUPE, (y - loupe.clientHeight / 2) / LOUPE]));
  });
  keys(stage, act, save);
}

/** Where on a canvas, as it is drawn: offsetX and offsetY are rounded, and so is its clientWidth. */
function within(canvas, { clientX, clientY }) {
  const box = canvas.getBoundingClientRect();
  return [((clientX - box.x) * canvas.clientWidth) / box.width, ((clientY - box.y) * canvas.clientHeight) / box.height];
}

/** A click places or picks, a drag of a point moves it, a drag of the picture pans it. */
function pointer(stage, act) {
  const { board, view } = stage;
  const meant = (x, y) => board.near(stage.lens.toPixel(x, y), NEAR_PX / stage.lens.scale);
  let held = null;
  view.addEventListener("pointerdown", (event) => {
    if (event.button) return;
    const [x, y] = within(view, event);
    held = { x, y, mark: meant(x, y), moved: false };
    view.setPointerCapture(event.pointerId);
  });
  view.addEventListener("pointermove", (event) => {
    const { lens } = stage;
    const [x, y] = within(view, event);
    stage.pointed = event.pointerType === "mouse" ? lens.toPixel(x, y) : null;
    if (held && (held.moved ||= Math.hypot(x - held.x, y - held.y) > DRAG_PX)) {
      const by = [(x - held.x) / lens.scale, (y - held.y) / lens.scale];
      [held.x, held.y] = [x, y];
      if (held.mark < 0) lens.panBy(-by[0], -by[1]);
      else act(() => { board.picked = held.mark; board.nudge(by); });
    }
    stage.refresh();
  });
  view.addEventListener("pointerup", (event) => {
    const was = held;
    held = null;
    if (!was || was.moved) return;
    const where = stage.lens.toPixel(...within(view, event));
    const inside = where.every((value, i) => value >= 0 && value <= board.hello.size[i]);
    if (was.mark >= 0) act(() => { board.picked = was.mark; });
    else if (inside) act(() => board.place(where));
  });
  view.addEventListener("touchstart", (event) => { // a finger on a point drags it, not the page
    if (meant(...within(view, event.touches[0])) >= 0) event.preventDefault();
  }, { passive: false });
  view.addEventListener("pointercancel", () => { held = null; });
  view.addEventListener("pointerleave", () => { stage.pointed = null; stage.refresh(); });
  view.addEventListener("wheel", (event) => {
    event.preventDefault();
    stage.lens.zoomBy(Math.exp(-event.deltaY / 300), ...within(view, event));
    stage.refresh();
  }, { passive: false });
}

function keys(stage, act, save) {
  const { board } = stage;
  const unpointed = (change, follow = false) => { stage.pointed = null; act(change, follow); };
  const nudge = (by) => unpointed(() => board.nudge(by), true);
  const another = (by) => {
    const { length } = board.sheet.marks;
    if (length) act(() => board.pick(board.camera, ((board.picked ?? board.next) + by + length) % length), true);
  };
  const does = {
    in: () => stage.zoom(1.5),
    out: () => stage.zoom(1 / 1.5),
    whole: () => stage.zoom(0),
    undo: () => act(() => board.undo()),
    clear: () => { if (board.picked !== null) act(() => { board.wanted = board.picked; board.put(board.picked, null); }); },
    hold: () => { at("hold").ariaPressed = at("hold").ariaPressed === "false"; },
    save,
  };
  for (const [id, action] of Object.entries(does)) at(id).addEventListener("click", action);
  for (const button of document.querySelectorAll("[data-by]")) {
    button.addEventListener("click", () => nudge(button.dataset.by.split(",").map(Number)));
  }
  at("scrub").addEventListener("input", (event) => stage.scrub(Number(event.target.value)));
  const pressed = {
    Enter: () => unpointed(() => board.place(stage.lens.middle)),
    "+": does.in, "=": does.in, "-": does.out, 0: does.whole, n: () => another(1), N: () => another(-1),
    Delete: does.clear, Backspace: does.clear, u: does.undo, s: save, h: () => stage.runs && does.hold(),
    1: () => stage.look(0), 2: () => stage.look(1),
    ",": () => stage.scrub(stage.still.place - 1), ".": () => stage.scrub(stage.still.place + 1),
    Escape: () => { board.picked = null; stage.refresh(); },
  };
  addEventListener("keydown", (event) => {
    const own = event.target.tagName === "INPUT" || (event.target.tagName === "BUTTON" && event.key === "Enter");
    if (own || event.altKey || event.metaKey || (event.ctrlKey && event.key !== "z")) return;
    const far = event.shiftKey ? FAR_PX : FINE_PX;
    const action = event.key in ARROWS ? () => nudge(ARROWS[event.key].map((by) => by * far)) : event.ctrlKey ? does.undo : pressed[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}
