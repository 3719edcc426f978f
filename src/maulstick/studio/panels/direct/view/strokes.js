// Strokes of a painting as a page has them, in millimetres: read from bytes, drawn as outlines, and found by places.

const HEAD = 6; // numbers before the strokes
const COLUMNS = 3; // x, y, half-width
const NEAR = 2; // pixels between two corners of an outline at least
const FAR = 24; // and at most, where the mark is straight and even
const BENT = 2; // pixels times the sine of a turn: an eighth of it is how far a corner that is left out lay beside
const UNEVEN = 0.4; // pixels by which a half-width may change between two corners
const THIN = 0.35; // pixels of the least half-width that is drawn: thinner marks would pale
const CORNER = 1; // turn over a half-width, in radians, above which an outline would fold

export class Strokes {
  constructor() {
    this.order = []; // ids, the first painted first
    this.byId = new Map(); // { id, paint, opacity, locked, points: [x, y, half-width, x, …], box, folds }
  }

  // Take what the server sends after a change (see stroke_marks.as_bytes), and return the box that it touches, or null.
  take(bytes) {
    const before = this.byId;
    const [order, changed] = read(bytes);
    this.order = order;
    const touched = [];
    for (const stroke of changed) {
      touched.push(stroke.box);
      if (before.has(stroke.id)) touched.push(before.get(stroke.id).box);
    }
    this.byId = new Map(before);
    for (const stroke of changed) this.byId.set(stroke.id, stroke);
    const stays = new Set(order);
    for (const [id, stroke] of before) {
      if (stays.has(id)) continue;
      touched.push(stroke.box);
      this.byId.delete(id);
    }
    return touched.length ? unionOf(touched) : null;
  }

  // Ids of the topmost stroke at a place, [] where the paper is bare. slack: millimetres beside it that count.
  at(x, y, slack) {
    for (let i = this.order.length - 1; i >= 0; i--) {
      const stroke = this.byId.get(this.order[i]);
      const [left, upper, right, lower] = stroke.box;
      if (x < left - slack || x > right + slack || y < upper - slack || y > lower + slack) continue;
      if (isAt(stroke.points, x, y, slack)) return [stroke.id];
    }
    return [];
  }

  // Ids of the strokes that lie within a line by more than half. line: [[x, y], …]
  within(line) {
    const around = boxOf(line.flatMap(([x, y]) => [x, y, 0]));
    return this.order.filter((id) => {
      const { points, box } = this.byId.get(id);
      if (!meet(box, around)) return false;
      let inside = 0;
      for (let i = 0; i < points.length; i += COLUMNS) inside += isInside(line, points[i], points[i + 1]);
      return 2 * inside * COLUMNS > points.length;
    });
  }

  // Id of the stroke that is painted after one, or before it; the first or the last where there is none.
  beside(id, by) {
    const found = this.order.indexOf(id);
    const next = found < 0 ? (by > 0 ? 0 : this.order.length - 1) : found + by;
    return this.order.length ? [this.order[Math.min(Math.max(next, 0), this.order.length - 1)]] : [];
  }
}

// Draw the outline of a stroke's mark as a path. view: { scale, x, y }, pixels per millimetre and of the sheet's corner.
export function outline(ink, stroke, view) {
  ink.beginPath();
  if (stroke.folds) chain(ink, stroke.points, view);
  else ribbon(ink, stroke.points, view);
}

// Along one side and back along the other, which is quick, where no turn is tighter than the mark is wide.
function ribbon(ink, points, { scale, x, y }) {
  const last = points.length - COLUMNS;
  const back = [];
  let [u, v, nx, ny, wide] = [Infinity, Infinity, 0, 0, 0];
  for (let i = 0; i <= last; i += COLUMNS) {
    const [px, py] = [points[i] * scale + x, points[i + 1] * scale + y];
    const [a, b] = [Math.max(i - COLUMNS, 0), Math.min(i + COLUMNS, last)];
    const [dx, dy] = [points[b] - points[a], points[b + 1] - points[a + 1]];
    const long = Math.sqrt(dx * dx + dy * dy) || 1;
    const half = Math.max(points[i + 2] * scale, THIN);
    if (i && i < last) {
      const way = Math.abs(px - u) + Math.abs(py - v);
      const bent = (way * Math.abs(dx * nx + dy * ny)) / (long * wide); // the normal of before along the way of now
      if (way < NEAR || (way < FAR && bent < BENT && Math.abs(half - wide) < UNEVEN)) continue;
    }
    [u, v, wide] = [px, py, half];
    [nx, ny] = [(-dy / long) * wide, (dx / long) * wide];
    if (!back.length) cap(ink, px, py, wide, Math.atan2(-ny, -nx));
    ink.lineTo(px + nx, py + ny);
    back.push(px - nx, py - ny);
  }
  cap(ink, u, v, wide, Math.atan2(ny, nx));
  for (let i = back.length - 2; i >= 0; i -= 2) ink.lineTo(back[i], back[i + 1]);
  ink.closePath();
}

// Half a circle around an end, from an angle on; nothing where it is too small to be seen.
function cap(ink, x, y, wide, from) {
  if (wide > 1) ink.arc(x, y, wide, from, from + Math.PI, true);
}

// A disc at each point and a band between two, all turned alike, so that they add up wherever they lie over each other.
function chain(ink, points, { scale, x, y }) {
  const last = points.length - COLUMNS;
  let [u, v, before] = [Infinity, Infinity, 0];
  for (let i = 0; i <= last; i += COLUMNS) {
    const [px, py] = [points[i] * scale + x, points[i + 1] * scale + y];
    const wide = Math.max(points[i + 2] * scale, THIN);
    const [dx, dy] = [px - u, py - v];
    if (i && i < last && Math.abs(dx) + Math.abs(dy) < NEAR) continue;
    ink.moveTo(px + wide, py);
    ink.arc(px, py, wide, 0, 2 * Math.PI, true);
    const long = i ? Math.sqrt(dx * dx + dy * dy) : 0;
    if (long) {
      const [nx, ny] = [-dy / long, dx / long];
      ink.moveTo(u + nx * before, v + ny * before);
      ink.lineTo(px + nx * wide, py + ny * wide);
      ink.lineTo(px - nx * wide, py - ny * wide);
      ink.lineTo(u - nx * before, v - ny * before);
      ink.closePath();
    }
    [u, v, before] = [px, py, wide];
  }
}

// Draw the centre line of a stroke as a path.
export function centreLine(ink, { points }, { scale, x, y }) {
  ink.beginPath();
  for (let i = 0; i < points.length; i += COLUMNS) ink.lineTo(points[i] * scale + x, points[i + 1] * scale + y);
}

export function meet(one, other) {
  return one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3];
}

export function unionOf(boxes) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [left, upper, right, lower] of boxes) {
    box[0] = Math.min(box[0], left);
    box[1] = Math.min(box[1], upper);
    box[2] = Math.max(box[2], right);
    box[3] = Math.max(box[3], lower);
  }
  return box;
}

function read(bytes) {
  const [all, some, many, left, upper, step] = new Float64Array(bytes, 0, HEAD);
  let at = 8 * HEAD;
  const next = (Kind, count) => {
    const array = new Kind(bytes, at, count);
    at += array.byteLength;
    return array;
  };
  const order = [...next(Float64Array, all)];
  const ids = next(Float64Array, some);
  const counts = next(Uint32Array, some);
  const [paints, opacities, locks] = [next(Uint16Array, some), next(Uint16Array, some), next(Uint16Array, some)];
  const steps = next(Uint16Array, COLUMNS * many);
  const points = Float32Array.from(steps, (each) => each * step);
  for (let i = 0; i < points.length; i += COLUMNS) [points[i], points[i + 1]] = [points[i] + left, points[i + 1] + upper];
  let from = 0;
  const strokes = Array.from(ids, (id, i) => {
    const own = points.subarray(from, (from += COLUMNS * counts[i]));
    const opacity = opacities[i] / 255;
    return { id, paint: paints[i], opacity, locked: locks[i] > 0, points: own, box: boxOf(own), folds: folds(own) };
  });
  return [order, strokes];
}

function boxOf(points) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i += COLUMNS) {
    const wide = points[i + 2];
    box[0] = Math.min(box[0], points[i] - wide);
    box[1] = Math.min(box[1], points[i + 1] - wide);
    box[2] = Math.max(box[2], points[i] + wide);
    box[3] = Math.max(box[3], points[i + 1] + wide);
  }
  return box;
}

// Whether a side of the mark would turn back on itself, or it has no direction at all.
function folds(points) {
  let turned = null;
  for (let i = COLUMNS; i < points.length; i += COLUMNS) {
    const [dx, dy] = [points[i] - points[i - COLUMNS], points[i + 1] - points[i + 1 - COLUMNS]];
    const long = Math.hypot(dx, dy);
    if (!long) continue;
    const angle = Math.atan2(dy, dx);
    if (turned !== null) {
      const turn = Math.abs(Math.atan2(Math.sin(angle - turned), Math.cos(angle - turned)));
      if (turn * points[i - 1] > CORNER * long || turn > CORNER) return true;
    }
    turned = angle;
  }
  return turned === null;
}

function isAt(points, x, y, slack) {
  for (let i = 0; i < points.length; i += COLUMNS) {
    const j = Math.max(i - COLUMNS, 0);
    const [u, v] = [points[i] - points[j], points[i + 1] - points[j + 1]];
    const long = u * u + v * v;
    const part = long ? Math.min(1, Math.max(0, ((x - points[j]) * u + (y - points[j + 1]) * v) / long)) : 0;
    const wide = points[j + 2] + part * (points[i + 2] - points[j + 2]);
    if (Math.hypot(x - points[j] - part * u, y - points[j + 1] - part * v) <= wide + slack) return true;
  }
  return false;
}

function isInside(line, x, y) {
  let inside = false;
  for (let i = 0, j = line.length - 1; i < line.length; j = i++) {
    const [[a, b], [c, d]] = [line[i], line[j]];
    if (b > y !== d > y && x < ((c - a) * (y - b)) / (d - b) + a) inside = !inside;
  }
  return inside;
}
