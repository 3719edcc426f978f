// Regions and guides over the strokes: tinted, with their names, as cheap to paint as the view moves.

const TINT = 0.16; // opacity of a region
const WIDE = 2.5; // CSS pixels of an outline; of the chosen one twice as wide
const TAG = "600 13px system-ui, sans-serif";
const GUIDE = "#5b2a86";
const PEN = "#2f6690"; // of a line while it is drawn

export const DRAWS_LINES = ["region", "bare", "importance", "guide"];

export class Places {
  constructor() {
    this.areas = []; // { id, name, colour, bare, path: millimetres, top: its highest corner }
    this.guides = []; // { id, path }
    this.shows = true;
    this.chosen = null; // id
    this.probe = new OffscreenCanvas(1, 1).getContext("2d");
  }

  // said: { regions: [{ id, name, colour, bare, rings: [[x, y, x, …], …] }], guides: [{ id, line: [x, y, …] }] }
  take({ regions, guides }) {
    this.areas = regions.map(({ rings, ...region }) => ({ ...region, path: pathOf(rings, true), top: topOf(rings) }));
    this.guides = guides.map(({ id, line }) => ({ id, path: pathOf([line], false) }));
  }

  // Id of the topmost region at a place of the sheet, or null.
  at([x, y]) {
    const found = this.areas.findLast(({ path }) => this.probe.isPointInPath(path, x, y, "evenodd"));
    return found?.id ?? null;
  }

  // view: { scale, x, y } in device pixels.
  paint(ink, { scale, x, y }) {
    if (!this.shows) return;
    ink.save();
    ink.setTransform(scale, 0, 0, scale, x, y);
    [ink.lineJoin, ink.lineCap] = ["round", "round"];
    const pixel = devicePixelRatio / scale;
    for (const { id, path, colour, bare } of this.areas) {
      [ink.globalAlpha, ink.fillStyle] = [TINT, bare ? "#fff" : colour];
      ink.fill(path, "evenodd");
      ink.globalAlpha = 1;
      const wide = WIDE * pixel * (id === this.chosen ? 2 : 1);
      trace(ink, path, "#fff", wide + 2.5 * pixel);
      ink.setLineDash(bare ? [6 * pixel, 5 * pixel] : []);
      trace(ink, path, colour, wide);
      ink.setLineDash([]);
    }
    for (const { id, path } of this.guides) {
      const wide = WIDE * pixel * (id === this.chosen ? 2 : 1);
      trace(ink, path, "#fff", wide + 2.5 * pixel);
      trace(ink, path, GUIDE, wide);
    }
    ink.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
    for (const area of this.areas) tag(ink, area, { scale, x, y });
    ink.restore();
  }

  // What is drawn now, or until the server has it. act: { tool, line: [[x, y], …] }; broad: of the brush, millimetres
  paintLine(ink, { tool, line }, { scale, x, y }, broad) {
    ink.save();
    ink.setTransform(scale, 0, 0, scale, x, y);
    [ink.lineJoin, ink.lineCap] = ["round", "round"];
    const path = pathOf([line.flat()], tool === "region" || tool === "bare");
    const pixel = devicePixelRatio / scale;
    if (tool === "importance") {
      ink.globalAlpha = 0.45;
      trace(ink, path, PEN, broad);
    } else {
      trace(ink, path, "#fff", 5 * pixel);
      trace(ink, path, tool === "guide" ? GUIDE : PEN, 2.5 * pixel);
    }
    ink.restore();
  }
}

function trace(ink, path, colour, wide) {
  [ink.strokeStyle, ink.lineWidth] = [colour, wide];
  ink.stroke(path);
}

// The name of a region, on its colour, at its highest corner, within the view.
function tag(ink, { name, colour, bare, top }, { scale, x, y }) {
  ink.font = TAG;
  const text = name.length > 28 ? `${name.slice(0, 27)}…` : name;
  const wide = ink.measureText(text).width + 26;
  const { width, height } = ink.canvas;
  const [u, v] = [(top[0] * scale + x) / devicePixelRatio, (top[1] * scale + y) / devicePixelRatio];
  const left = Math.min(Math.max(u - wide / 2, 2), width / devicePixelRatio - wide - 2);
  const upper = Math.min(Math.max(v - 11, 2), height / devicePixelRatio - 24);
  ink.fillStyle = "rgba(255, 255, 255, .92)";
  ink.beginPath();
  ink.roundRect(left, upper, wide, 22, 6);
  ink.fill();
  [ink.fillStyle, ink.strokeStyle, ink.lineWidth] = [bare ? "#fff" : colour, bare ? colour : "#444", bare ? 2 : 1];
  ink.beginPath();
  ink.arc(left + 11, upper + 11, 5, 0, 2 * Math.PI);
  ink.fill();
  ink.stroke();
  ink.fillStyle = "#222";
  ink.textBaseline = "middle";
  ink.fillText(text, left + 20, upper + 12);
}

function pathOf(lines, closes) {
  const path = new Path2D();
  for (const line of lines) {
    path.moveTo(line[0], line[1]);
    for (let i = line.length === 2 ? 0 : 2; i < line.length; i += 2) path.lineTo(line[i], line[i + 1]);
    if (closes) path.closePath();
  }
  return path;
}

function topOf(rings) {
  let top = [0, Infinity];
  for (const ring of rings) for (let i = 0; i < ring.length; i += 2) if (ring[i + 1] < top[1]) top = [ring[i], ring[i + 1]];
  return top;
}
