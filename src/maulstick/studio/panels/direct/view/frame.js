// Frame of the canvas: the sheet and all that lies on it, as it is seen now.

import { drawingStroke } from "./pen_stroke.js";
import { laidOn } from "./views.js";

const ACCENT = "#2f6690";

// Paint what is seen of a stage; return whether its strokes are drawn sharply.
export function paintFrame(stage) {
  const { ink } = stage;
  const now = stage.seen();
  ink.resetTransform();
  [ink.globalAlpha, ink.fillStyle] = [1, stage.props.paper];
  ink.clearRect(0, 0, now.wide, now.high);
  const sheet = [now.x, now.y, stage.wide * now.scale, stage.high * now.scale];
  ink.fillRect(...sheet);
  ink.globalAlpha = stage.faded;
  if (stage.faded && stage.image.naturalWidth) ink.drawImage(stage.image, ...sheet);
  ink.globalAlpha = 1 - stage.faded;
  const isExact = paintStrokes(ink, stage.layers, now);
  ink.globalAlpha = 1;
  stage.places.paint(ink, now);
  if (stage.chosen.ids.length && stage.layers.chosen) paintChosen(stage, now);
  paintAct(stage, now);
  return isExact;
}

function paintStrokes(ink, layers, now) {
  const sharp = layers.view && laidOn(layers.view.view, now);
  if (layers.whole && !(sharp && sharp.isExact)) {
    const { width, height } = layers.whole.bitmap;
    ink.save();
    ink.beginPath();
    ink.rect(0, 0, now.wide, now.high);
    if (sharp) ink.rect(...sharp.box);
    ink.clip("evenodd"); // where no sharper picture is
    const factor = now.scale / layers.whole.view.scale;
    ink.drawImage(layers.whole.bitmap, now.x, now.y, width * factor, height * factor);
    ink.restore();
  }
  if (sharp) ink.drawImage(layers.view.bitmap, ...sharp.box);
  return Boolean(sharp?.isExact);
}

function paintChosen(stage, now) {
  const { ink, shift, chosen } = stage;
  const { box } = laidOn(stage.layers.chosen.view, now);
  const [x, y] = chosen.middle.map((side, i) => side * now.scale + [now.x, now.y][i]);
  ink.save();
  ink.translate(x + shift.dx * now.scale, y + shift.dy * now.scale);
  ink.rotate(shift.turn);
  ink.translate(-x, -y);
  ink.drawImage(stage.layers.chosen.bitmap, ...box);
  ink.restore();
  const [u, v] = stage.handle();
  ink.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  ink.beginPath();
  ink.arc(u, v, 9, 0, 2 * Math.PI);
  [ink.fillStyle, ink.strokeStyle, ink.lineWidth] = ["#fff", ACCENT, 3];
  ink.fill();
  ink.stroke();
}

function paintAct(stage, now) {
  const { ink, act, sent, view, props } = stage;
  ink.setTransform(devicePixelRatio, 0, 0, devicePixelRatio, 0, 0);
  if (act?.kind === "lasso") {
    ink.beginPath();
    for (const [x, y] of act.line) ink.lineTo(x * view.scale + view.x, y * view.scale + view.y);
    ink.setLineDash([6, 4]);
    outline(ink);
    ink.setLineDash([]);
  }
  for (const each of [act, ...sent]) {
    if (each?.kind === "say") stage.places.paintLine(ink, each, now, props.broad);
    if (each?.kind !== "draw") continue;
    drawingStroke(ink, each.points, view, props.colours[each.paint], props.halfWidths[each.paint]);
  }
  if (stage.tool === "importance" && stage.pointed) {
    ink.beginPath();
    ink.arc(...stage.pointed, (props.broad / 2) * view.scale, 0, 2 * Math.PI);
    outline(ink);
  }
}

function outline(ink) {
  for (const [colour, wide] of [["#fff", 4], [ACCENT, 2]]) {
    [ink.strokeStyle, ink.lineWidth] = [colour, wide];
    ink.stroke();
  }
}
