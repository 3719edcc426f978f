// What keys do on the canvas.

import { DRAWS_LINES } from "./places.js";

const FAR = 0.1; // share of the view that an arrow key moves
const NUDGE = 1; // millimetres by an arrow key; with Shift a tenth
const TURN = Math.PI / 36; // by a key; with Shift a fifth
const REST = 500; // milliseconds after the last arrow key, in which several are one act

export class Keys {
  constructor(stage) {
    this.stage = stage;
    this.space = false; // whether it is down, and dragging moves the view
    stage.root.addEventListener("keydown", (event) => this.down(event));
    stage.root.addEventListener("keyup", (event) => event.key === " " && this.hold(false));
    stage.root.addEventListener("blur", () => this.leave());
    stage.beforeChoice = () => this.sendShift();
    this.heard = (event) => this.undo(event);
    document.addEventListener("keydown", this.heard); // also where a button of the page has the focus
    this.clicked = (event) => this.returnTo(event);
    document.addEventListener("click", this.clicked);
    this.hidden = () => document.hidden && this.leave();
    document.addEventListener("visibilitychange", this.hidden); // as a tab is that is closed, and keeps its focus
  }

  close() {
    document.removeEventListener("keydown", this.heard);
    document.removeEventListener("click", this.clicked);
    document.removeEventListener("visibilitychange", this.hidden);
    clearTimeout(this.resting);
  }

  leave() {
    this.hold(false);
    this.rest();
  }

  // A button beside the canvas that is clicked, and not pressed by a key, leaves the keys to the canvas.
  returnTo({ detail, target }) {
    const button = target.closest?.(".directing .side :is(button, [role=checkbox])");
    if (!button) return;
    this.stage.asked = null;
    if (detail) this.stage.root.focus({ preventScroll: true });
  }

  hold(space) {
    this.space = space;
    this.stage.root.classList.toggle("panning", space);
  }

  down(event) {
    const isTyped = event.getModifierState("AltGraph"); // as brackets are on many keyboards
    if (event.altKey && !isTyped) return;
    const act = !isTyped && (event.ctrlKey || event.metaKey) ? this.withControl(event.key) : this.plain(event);
    if (!act) return;
    event.preventDefault();
    act();
  }

  withControl(key) {
    return key.toLowerCase() === "a" ? () => this.stage.chooseAll() : null;
  }

  plain({ key, shiftKey, repeat }) {
    const { stage } = this;
    const [step, turn] = shiftKey ? [NUDGE / 10, TURN / 5] : [NUDGE, TURN];
    const some = (act) => (stage.chosen.ids.length ? act : () => {});
    const turned = (by) => some(() => this.nudge(0, 0, by));
    const [next, before] = [1, -1].map((by) => () => stage.choose({ by }, shiftKey));
    const ask = (what) => () => repeat || this.ask(what);
    const take = (tool) => () => repeat || this.takeUp(tool);
    const away = DRAWS_LINES.includes(stage.tool) ? ask("take_out") : some(ask("remove"));
    return {
      "+": () => stage.nearer(), "=": () => stage.nearer(), "-": () => stage.farther(), 0: () => stage.fit(),
      1: () => stage.showTrueSize(), m: () => stage.magnify(), " ": () => this.hold(true), n: () => stage.chooseNone(),
      ".": next, ">": next, ":": next, ",": before, "<": before, ";": before, // with Shift, as keyboards have it
      "[": turned(-turn), "]": turned(turn), "{": turned(-turn), "}": turned(turn),
      ArrowLeft: this.by(-1, 0, step), ArrowRight: this.by(1, 0, step),
      ArrowUp: this.by(0, -1, step), ArrowDown: this.by(0, 1, step),
      Delete: away, Backspace: away, l: some(ask("lock")),
      v: take("choose"), h: take("pan"), b: take("draw"),
      r: take("region"), p: take("bare"), i: take("importance"), g: take("guide"),
    }[key.length > 1 ? key : key.toLowerCase()]; // as Caps Lock has it
  }

  // What an arrow key does: it moves what is chosen, or else the view.
  by(across, down, step) {
    const { stage } = this;
    if (stage.chosen.ids.length) return () => this.nudge(across * step, down * step, 0);
    const [wide, high] = stage.middle().map((half) => 2 * FAR * half);
    return () => stage.lay(stage.view.scale, stage.view.x - across * wide, stage.view.y - down * high);
  }

  nudge(dx, dy, turn) {
    const { stage } = this;
    if (stage.shift.isSent) return; // it is not there yet
    stage.shift = { dx: stage.shift.dx + dx, dy: stage.shift.dy + dy, turn: stage.shift.turn + turn };
    stage.repaint();
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.rest(), REST);
  }

  // What arrow keys moved is sent, unless a pointer moves on with it.
  rest() {
    if (!this.stage.isMoved) this.sendShift();
  }

  // Tell the server how far what is chosen was moved, once.
  sendShift() {
    clearTimeout(this.resting);
    const { chosen, shift, emit } = this.stage;
    if (shift.isSent || !(shift.dx || shift.dy || shift.turn)) return;
    shift.isSent = true;
    emit("moved", { strokes: chosen.ids, by: [shift.dx, shift.dy], turn: shift.turn });
  }

  ask(what) {
    this.sendShift();
    this.stage.emit("ask", what);
  }

  // The pointer is that tool at once, however busy the server is.
  takeUp(tool) {
    this.stage.asked = tool;
    this.ask(tool);
  }

  undo(event) {
    const key = event.key.toLowerCase();
    if (!(event.ctrlKey || event.metaKey) || event.altKey || !"zy".includes(key)) return;
    if (document.querySelector(".q-dialog")) return;
    if (event.target.closest?.("input:not([type=range]), textarea, [contenteditable]")) return;
    event.preventDefault();
    this.ask(key === "y" || event.shiftKey ? "redo" : "undo");
  }
}
