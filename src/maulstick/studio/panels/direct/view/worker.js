// Worker of the canvas: it draws strokes beside the page, so that the page moves at once, and finds them by places.

import { Strokes, centreLine, meet, outline, unionOf } from "./strokes.js";

const SLICE = 12; // milliseconds of drawing after which messages are heard
const WHOLE = 1400; // pixels of the longer side of the picture of the whole sheet
const MANY = 1500; // chosen strokes above which their edges are drawn simply
const SOLID = 0.98; // opacity above which nothing is seen through, and drawing is quicker
const EDGE = "#2f6690"; // of what is chosen

const strokes = new Strokes();
let colours = []; // of paints
let size = [1, 1]; // of the sheet, millimetres
let showsLocks = true;
let chosen = new Set();
let awake = false;

// Picture of strokes as seen from one view. name: of it on the page.
class Surface {
  constructor(name, { onlyChosen = false } = {}) {
    [this.name, this.onlyChosen] = [name, onlyChosen];
    this.paper = new OffscreenCanvas(1, 1);
    this.ink = this.paper.getContext("2d");
    this.view = null; // { scale, x, y, wide, high }, pixels
    this.stale = null; // box to be drawn again, millimetres
    this.job = null;
  }

  see(view) {
    this.view = view;
    this.spoil([-Infinity, -Infinity, Infinity, Infinity]);
  }

  spoil(box) {
    if (!this.view || !box) return;
    const old = this.stale;
    const [a, b, c, d] = old ?? box;
    this.stale = [Math.min(a, box[0]), Math.min(b, box[1]), Math.max(c, box[2]), Math.max(d, box[3])];
    this.job = null;
    wake();
  }

  // Draw for a slice of time; return whether nothing is left to do.
  work(until) {
    this.job ??= this.draw();
    while (performance.now() < until) {
      if (!this.job.next().done) continue;
      this.job = this.stale = null;
      const view = this.view;
      const kept = this.name;
      createImageBitmap(this.paper).then((bitmap) => postMessage({ layer: kept, bitmap, view }, [bitmap]));
      return true;
    }
    return false;
  }

  *draw() {
    const { paper, ink, view } = this;
    const { scale, x, y, wide, high } = view;
    if (paper.width !== wide || paper.height !== high) [paper.width, paper.height] = [wide, high];
    const seen = [-x / scale, -y / scale, (wide - x) / scale, (high - y) / scale];
    const box = this.stale.map((side, i) => (i < 2 ? Math.max(side, seen[i]) : Math.min(side, seen[i])));
    const [left, upper] = [Math.floor(box[0] * scale + x) - 2, Math.floor(box[1] * scale + y) - 2];
    const [right, lower] = [Math.ceil(box[2] * scale + x) + 2, Math.ceil(box[3] * scale + y) + 2];
    if (left <= 0 && upper <= 0 && right >= wide && lower >= high) {
      ink.reset(); // which also forgets what was drawn and never shown
    } else {
      ink.restore(); // of a drawing that was given up
      ink.save();
      ink.beginPath();
      ink.rect(left, upper, right - left, lower - upper);
      ink.clip();
      ink.clearRect(left, upper, right - left, lower - upper);
    }
    const around = [(left - x) / scale, (upper - y) / scale, (right - x) / scale, (lower - y) / scale];
    const wanted = this.onlyChosen ? strokes.order.filter((id) => chosen.has(id)) : strokes.order;
    for (const id of wanted) {
      const stroke = strokes.byId.get(id);
      if (!meet(stroke.box, around)) continue;
      this.one(stroke);
      yield;
    }
    if (!showsLocks || this.onlyChosen) return;
    for (const id of strokes.order) {
      const stroke = strokes.byId.get(id);
      if (!stroke.locked || !meet(stroke.box, around)) continue;
      dash(ink, stroke, view);
      yield;
    }
  }

  one(stroke) {
    const { ink, view } = this;
    outline(ink, stroke, view);
    ink.globalAlpha = stroke.opacity > SOLID ? 1 : stroke.opacity;
    ink.fillStyle = colours[stroke.paint];
    if (this.onlyChosen) {
      ink.globalAlpha = 1;
      ink.lineJoin = "round";
      if (chosen.size < MANY) line(ink, "#fff", 7);
      line(ink, EDGE, 4);
    }
    ink.fill();
  }
}

const surfaces = {
  view: new Surface("view"),
  chosen: new Surface("chosen", { onlyChosen: true }),
  loupe: new Surface("loupe"),
  whole: new Surface("whole"),
};

function line(ink, colour, wide) {
  [ink.strokeStyle, ink.lineWidth] = [colour, wide];
  ink.stroke();
}

function dash(ink, stroke, view) {
  centreLine(ink, stroke, view);
  ink.globalAlpha = 1;
  ink.setLineDash([]);
  line(ink, "#000", 2.5);
  ink.setLineDash([4, 4]);
  line(ink, "#fff", 1.5);
}

// Work in slices, the nearest first, so that a newer view ends the drawing of an older one.
const gap = new MessageChannel();
gap.port1.onmessage = () => {
  awake = false;
  const until = performance.now() + SLICE;
  for (const surface of Object.values(surfaces)) {
    if (surface.stale && !surface.work(until)) {
      wake();
      return;
    }
  }
};

function wake() {
  if (awake) return;
  awake = true;
  gap.port2.postMessage(null);
}

const told = {
  begin(message) {
    [colours, size] = [message.colours, message.size];
    const scale = WHOLE / Math.max(...size);
    surfaces.whole.see({ scale, x: 0, y: 0, wide: Math.ceil(size[0] * scale), high: Math.ceil(size[1] * scale) });
  },
  take({ bytes, acts }) {
    const box = strokes.take(bytes);
    for (const surface of Object.values(surfaces)) surface.spoil(box);
    postMessage({ taken: { strokes: strokes.order.length, acts, areOthers: Boolean(box) }, chosen: known() });
  },
  see({ layer, view }) {
    surfaces[layer].see(view);
  },
  locks({ shows }) {
    showsLocks = shows;
    for (const surface of Object.values(surfaces)) surface.spoil([-Infinity, -Infinity, Infinity, Infinity]);
  },
  // Choose strokes by ids, by a place, within a line, all, or the next one. adds: to those that are chosen, or off them.
  choose({ ids, place, line: around, all, by, adds, view }) {
    let found = ids ?? [];
    if (place) found = strokes.at(...place);
    if (around) found = strokes.within(around);
    if (all) found = strokes.order;
    if (by) found = strokes.beside([...chosen].at(-1), by);
    const isLess = adds && place && found.every((id) => chosen.has(id));
    if (!adds) chosen = new Set();
    for (const id of found) chosen.delete(id);
    if (!isLess) for (const id of found) chosen.add(id); // last: the next one is beside it
    surfaces.chosen.see(view);
    postMessage({ chosen: known() });
  },
};

// What is chosen, as the page says it: ids, and of each its paint and whether it is locked.
function known() {
  chosen = new Set([...chosen].filter((id) => strokes.byId.has(id)));
  const found = [...chosen].map((id) => strokes.byId.get(id));
  const middle = found.length ? middleOf(found) : null;
  return { ids: [...chosen], paints: [...new Set(found.map((each) => each.paint))], locked: count(found), middle };
}

function count(found) {
  return found.filter((each) => each.locked).length;
}

function middleOf(found) {
  const [left, upper, right, lower] = unionOf(found.map((each) => each.box));
  return [(left + right) / 2, (upper + lower) / 2];
}

onmessage = ({ data }) => told[data.act](data);
