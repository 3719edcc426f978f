// What mouse, fingers and pen do on the canvas.

import { felt } from "./pen_stroke.js";
import { DRAWS_LINES } from "./places.js";
import { laidOn, spread } from "./views.js";

const PER_PIXEL = 0.0015; // of a wheel, as a logarithm
const PER_PINCH = 0.01; // of a touchpad, which browsers report as a wheel with Ctrl
const LINE = 20; // CSS pixels of a wheel that counts lines
const CLICK = 4; // CSS pixels that a pointer may move in a click
const REACH = 3; // CSS pixels beside a stroke in which a click finds it
const GRIP = 14; // CSS pixels from the middle of the handle that turns, in which it is taken

export class Pointers {
  constructor(stage, keys) {
    Object.assign(this, { stage, keys });
    this.places = new Map(); // by pointer
    this.pen = null; // the pointer that it was last
    const act = { pointerdown: "begin", pointermove: "move", pointerup: "end", pointercancel: "cancel" };
    for (const [event, name] of Object.entries(act)) stage.root.addEventListener(event, (each) => this[name](each));
    stage.root.addEventListener("contextmenu", (event) => event.preventDefault());
    stage.root.addEventListener("wheel", (event) => this.roll(event), { passive: false });
  }

  place(event) {
    const box = this.stage.root.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  begin(event) {
    if (event.button > 1) return;
    const { stage } = this;
    const { tool, props: { paint } } = stage;
    const isTouch = event.pointerType === "touch";
    if (isTouch && this.places.has(this.pen)) return; // a palm
    if (event.pointerType === "pen") {
      if (this.places.size) this.leave(); // the palm came first
      this.pen = event.pointerId;
    }
    this.keys.rest();
    stage.root.setPointerCapture(event.pointerId);
    const at = this.place(event);
    this.places.set(event.pointerId, at);
    const pans = isTouch && this.pen !== null && tool !== "choose";
    if (this.places.size > 1 || this.keys.space || event.button === 1 || tool === "pan" || pans) {
      stage.leave(); // what one finger had begun
      this.pan(true);
    } else if (tool === "draw") {
      stage.act = { kind: "draw", paint, points: [] };
      this.record(event);
    } else if (DRAWS_LINES.includes(tool)) {
      stage.act = { kind: "say", tool, began: at, line: [stage.onSheet(at)] };
    } else {
      stage.act = { began: at, adds: event.shiftKey, kind: this.kindAt(at), line: [stage.onSheet(at)] };
    }
    stage.repaint();
  }

  pan(pans) {
    this.stage.act = pans ? { kind: "pan" } : null;
    this.stage.root.classList.toggle("panning", pans);
  }

  kindAt(at) {
    if (!this.stage.chosen.ids.length || this.stage.shift.isSent) return "lasso";
    const [u, v] = this.stage.handle();
    if (Math.hypot(at[0] - u, at[1] - v) <= GRIP) return "turn";
    return this.isOnChosen(at) ? "move" : "lasso";
  }

  // Whether what is chosen is drawn at a place: its picture on the page is there at once.
  isOnChosen([u, v]) {
    const { layers, shift, view } = this.stage;
    if (!layers.chosen) return false;
    const probe = new OffscreenCanvas(1, 1).getContext("2d");
    const [left, upper, wide, high] = laidOn(layers.chosen.view, this.stage.seen()).box;
    const [x, y] = [u - shift.dx * view.scale, v - shift.dy * view.scale];
    probe.drawImage(layers.chosen.bitmap, left - x * devicePixelRatio, upper - y * devicePixelRatio, wide, high);
    return probe.getImageData(0, 0, 1, 1).data[3] > 0;
  }

  move(event) {
    const { stage } = this;
    const at = this.place(event);
    stage.point(at);
    if (!this.places.has(event.pointerId)) return;
    const before = spread([...this.places.values()]);
    this.places.set(event.pointerId, at);
    const { act, view } = stage;
    if (act?.began) act.far ||= Math.hypot(at[0] - act.began[0], at[1] - act.began[1]) >= CLICK;
    if (act?.kind === "pan") {
      const after = spread([...this.places.values()]);
      const [[x, y], [u, v]] = [before.middle, after.middle];
      stage.lay(view.scale, view.x + u - x, view.y + v - y);
      if (before.wide) stage.zoom(after.wide / before.wide, after.middle);
    } else if (act?.kind === "draw") {
      const all = event.getCoalescedEvents?.() ?? [];
      for (const each of all.length ? all : [event]) if (stage.act) this.record(each);
    } else if (act?.kind === "lasso" || act?.kind === "say") {
      act.line.push(stage.onSheet(at));
    } else if (act?.kind === "turn") {
      const [x, y] = stage.chosen.middle.map((side, i) => side * view.scale + [view.x, view.y][i]);
      stage.shift.turn = Math.atan2(at[1] - y, at[0] - x) + Math.PI / 2;
    } else if (act) {
      [stage.shift.dx, stage.shift.dy] = [0, 1].map((i) => (at[i] - act.began[i]) / view.scale);
    }
    stage.repaint();
  }

  end(event) {
    const { stage } = this;
    const { act } = stage;
    if (!this.places.delete(event.pointerId) || !act) return;
    if (act.kind === "pan") {
      if (!this.places.size) this.pan(false);
      return;
    }
    stage.act = null;
    stage.repaint();
    if (act.kind === "draw") {
      this.finish(act);
      return;
    }
    if (act.kind === "say") {
      this.say(act);
      return;
    }
    const at = this.place(event);
    if (!act.far) {
      stage.settle();
      stage.choose({ place: [...stage.onSheet(at), REACH / stage.view.scale] }, act.adds);
    } else if (act.kind === "lasso") {
      stage.choose({ line: act.line }, act.adds);
    } else {
      this.keys.sendShift();
    }
  }

  cancel(event) {
    if (this.places.has(event.pointerId)) this.leave();
  }

  // What was begun is given up, and who had begun it is ignored from now on.
  leave() {
    this.places.clear();
    this.stage.leave();
    this.pan(false);
  }

  record(event) {
    const [x, y] = this.stage.onSheet(this.place(event));
    const { wide, high, act } = this.stage;
    if (x >= 0 && y >= 0 && x <= wide && y <= high) {
      act.points.push(x, y, felt(event));
    } else if (act.points.length) { // or a chord would lead to where it comes back
      this.stage.act = null;
      this.finish(act);
    }
  }

  finish(act) {
    if (!act.points.length) return;
    this.stage.sent.push(act);
    this.stage.emit("drawn", { paint: act.paint, points: act.points });
  }

  // A line says something of a place; a click chooses the region there, but the brush of importance leaves a dab.
  say(act) {
    const { stage } = this;
    if (!act.far && act.tool !== "importance") {
      stage.emit("region", stage.places.at(act.line[0]));
      return;
    }
    stage.sent.push(act);
    stage.emit("said", { tool: act.tool, points: act.line.flat() });
  }

  roll(event) {
    event.preventDefault();
    const down = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE);
    this.stage.zoom(Math.exp(-down * (event.ctrlKey ? PER_PINCH : PER_PIXEL)), this.place(event));
  }
}
